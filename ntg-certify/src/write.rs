//! The file of a certificate (docs/certificate-format.md): lines of words, exact numbers, a digest at the end.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;

use ntg_compiler::expr::Binary;
use ntg_splines::Symmetry;
use sha2::{Digest, Sha256};

use crate::certify::{Certificate, Verdict};
use crate::interval::Interval;
use crate::prove::Leaf;
use crate::statement::{Function, Input, Join, Kind, Node, Over, Quantity, Statement, Summand, Table};
use crate::tube::Evidence;

/// The text of a certificate.
pub fn text(certificate: &Certificate) -> String {
    let mut out = body(certificate);
    let digest: String = Sha256::digest(&out).iter().map(|byte| format!("{byte:02x}")).collect();
    line(&mut out, format_args!("digest {digest}"));
    out
}

fn line(out: &mut String, words: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{words}");
}

/// Everything but the digest.
pub fn body(certificate: &Certificate) -> String {
    let statement = &certificate.statement;
    let mut out = String::from("ntg-certificate 2\n");
    line(&mut out, format_args!("| {}", one_line(&statement.problem)));
    statement.spec.lines().for_each(|text| line(&mut out, format_args!("| {text}")));
    data(&mut out, statement);
    let mut functions = Functions { all: statement.functions.clone(), at_ends: BTreeMap::new() };
    let sums: Vec<String> = statement.integrals.iter().map(|summands| sum(&mut functions, summands)).collect();
    let quantities: Vec<String> =
        statement.subjects.iter().map(|own| quantity(&mut functions, &own.quantity)).collect();
    formulas(&mut out, statement, &functions.all);
    for (number, (summands, (value, covers))) in statement.integrals.iter().zip(&certificate.integrals).enumerate() {
        let values = interval(*value);
        line(&mut out, format_args!("claim bounded {values} - - sum {} # integral {number}", sums[number]));
        cover_lines(&mut out, statement, &Quantity::Sum(summands.clone()), covers);
    }
    for ((subject, finding), quantity) in certificate.each().zip(&quantities) {
        let kind = match subject.kind {
            Kind::Constraint(_) => "constraint",
            Kind::Term(_) => "term",
            Kind::Named(_) => "named",
        };
        let (verdict, values) = (verdict(&finding.verdict), interval(finding.values));
        let [below, above] = [subject.bounds.0, subject.bounds.1].map(or_none);
        let name = one_line(&subject.name);
        line(&mut out, format_args!("claim {verdict} {values} {below} {above} {quantity} # {kind} {name}"));
        if let (Verdict::Refuted(..), Some(w)) = (finding.verdict, finding.witness) {
            line(&mut out, format_args!("witness {} {} {}", w.cell, w.halvings, w.part));
        }
        cover_lines(&mut out, statement, &subject.quantity, &finding.covers);
    }
    certificate.tubes.iter().for_each(|own| tube(&mut out, statement, own));
    out
}

/// A number, or `-` for none.
fn or_none(number: Option<usize>) -> String {
    number.map_or("-".to_owned(), |number| number.to_string())
}

fn quantity(functions: &mut Functions, quantity: &Quantity) -> String {
    match quantity {
        Quantity::Path(function, phase, cells) => format!("path {function} {phase} {} {}", cells.start, cells.end),
        Quantity::Sum(summands) => format!("sum {}", sum(functions, summands)),
    }
}

/// What proves the tube of a phase.
fn tube(out: &mut String, statement: &Statement, of: &Evidence) {
    let equations: Vec<usize> = of.equations.iter().map(|subject| statement.integrals.len() + subject).collect();
    let halvings: Vec<(usize, u32)> = of.boxes.iter().map(|(cell, halvings, _)| (*cell, *halvings)).collect();
    let trees = trees(statement.phases[of.phase].cells(), &halvings);
    line(out, format_args!("tube {} {} {trees}", of.phase, counted(&equations)));
    let mut components = of.components.iter();
    for unknown in &of.unknowns {
        line(out, format_args!("unknown {}", unknown.spline));
        for own in components.by_ref().take(unknown.order) {
            let [all, end] = own.bounds.map(interval);
            line(out, format_args!("component {} {all} {end} # {}", or_none(own.begin), one_line(&own.name)));
        }
    }
    for (_, _, proof) in &of.boxes {
        let lists = [&proof.start, &proof.highest, &proof.inside, &proof.slack, &proof.directions];
        line(out, format_args!("box {}", lists.map(|own| list(own)).join(" ")));
    }
}

/// A name on one line.
fn one_line(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn verdict(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Bounded => "bounded",
        Verdict::Proved => "proved",
        Verdict::Within(residual) if residual.is_finite() => "within",
        Verdict::Within(_) | Verdict::Undecided(_) => "undecided",
        Verdict::Refuted(..) => "refuted",
    }
}

fn data(out: &mut String, statement: &Statement) {
    for number in &statement.numbers {
        line(out, format_args!("number {} # {}", exact(number.value), one_line(&number.name)));
    }
    for phase in &statement.phases {
        let cuts = list(&phase.cuts);
        line(out, format_args!("phase {} {} {cuts} # {}", phase.start, phase.duration, one_line(&phase.name)));
    }
    for spline in &statement.splines {
        let (knots, coefficients) = (list(&spline.knots), list(&spline.coefficients));
        let name = one_line(&spline.name);
        line(out, format_args!("spline {} {} {knots} {coefficients} # {name}", spline.phase, spline.order));
    }
    for flat in &statement.flats {
        line(out, format_args!("flat {} {}", flat.spline, flat.derivative));
    }
    statement.tables.iter().for_each(|one| table(out, one));
}

fn table(out: &mut String, table: &Table) {
    let outside = if table.linear_outside { "linear" } else { "clamp" };
    line(out, format_args!("table {outside} # {}", one_line(&table.name)));
    for axis in &table.axes {
        let symmetry = match axis.symmetry {
            Symmetry::Plain => "plain",
            Symmetry::Even => "even",
            Symmetry::Periodic => "periodic",
        };
        let cells: Vec<f64> = axis.cells.iter().flat_map(|(begin, width)| [*begin, *width]).collect();
        let ends = format!("{} {}", exact(axis.ends.0), exact(axis.ends.1));
        let counts = format!("{} {} {}", axis.order, axis.step, axis.coefficients);
        line(out, format_args!("axis {symmetry} {ends} {counts} {} {}", list(&cells), list(&axis.weights)));
    }
    line(out, format_args!("coefficients {}", list(&table.coefficients)));
}

fn formulas(out: &mut String, statement: &Statement, functions: &[Function]) {
    // A graph of the file has one result: every operation in it is needed.
    let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for function in functions {
        let place = (function.graph, function.row);
        if !known.contains_key(&place) {
            known.insert(place, known.len());
            line(out, format_args!("graph"));
            crate::evaluate::line(&statement.graphs[place.0], place.1).iter().for_each(|own| node(out, own));
        }
        let inputs: Vec<String> = function.inputs.iter().map(|own| input(statement, own)).collect();
        line(out, format_args!("function {} {} {}", known[&place], inputs.len(), inputs.join(" ")));
    }
}

fn node(out: &mut String, node: &Node) {
    match node {
        Node::Const(value) => line(out, format_args!("const {}", exact(*value))),
        Node::Input(input) => line(out, format_args!("input {input}")),
        Node::Unary(op, x) => line(out, format_args!("{} {x}", op.name())),
        Node::Binary(Binary::Mul, a, b) if a == b => line(out, format_args!("square {a}")),
        Node::Binary(op, a, b) => line(out, format_args!("{} {a} {b}", op.name())),
        Node::Powi(x, n) => line(out, format_args!("powi {x} {n}")),
        Node::Select(c, a, b) => line(out, format_args!("select {c} {a} {b}")),
        Node::Table(table, orders, args) => {
            let words = orders.iter().map(ToString::to_string).chain(args.iter().map(ToString::to_string));
            line(out, format_args!("lookup {table} {}", words.collect::<Vec<_>>().join(" ")));
        }
    }
}

/// All functions of the file: those of the statement, and what some of them are at an end of their phase.
struct Functions {
    all: Vec<Function>,
    at_ends: BTreeMap<(usize, bool), usize>,
}

impl Functions {
    /// A function at the start or at the end of its phase, as one that depends on no time.
    fn at_end(&mut self, function: usize, last: bool) -> usize {
        if let Some(known) = self.at_ends.get(&(function, last)) {
            return *known;
        }
        let mut own = self.all[function].clone();
        for input in &mut own.inputs {
            match input {
                Input::Flat(flat) => *input = if last { Input::End(*flat) } else { Input::Start(*flat) },
                Input::Tau => *input = Input::Value(f64::from(u8::from(last))),
                Input::Join(_, members) => members.iter_mut().for_each(|member| *member = self.at_end(*member, last)),
                _ => {}
            }
        }
        self.all.push(own);
        self.at_ends.insert((function, last), self.all.len() - 1);
        self.all.len() - 1
    }
}

fn input(statement: &Statement, input: &Input) -> String {
    match input {
        Input::Flat(flat) => format!("flat {flat}"),
        Input::Start(flat) => format!("first {flat} 0"),
        Input::End(flat) => {
            let phase = statement.splines[statement.flats[*flat].spline].phase;
            format!("last {flat} {}", statement.phases[phase].cells().end.saturating_sub(1))
        }
        Input::Inside(flat, cell) => format!("first {flat} {cell}"),
        Input::Number(number) => format!("number {number}"),
        Input::Value(value) => format!("value {}", exact(*value)),
        Input::Tau => "tau".to_owned(),
        Input::Integral(integral) => format!("integral {integral}"),
        Input::Join(Join::Sum, members) if members.is_empty() => format!("value {}", exact(0.0)),
        Input::Join(Join::Product, members) if members.is_empty() => format!("value {}", exact(1.0)),
        Input::Join(join, members) => {
            let how = match join {
                Join::Sum => "add",
                Join::Product => "mul",
                Join::Min => "min",
                Join::Max => "max",
            };
            format!("{how} {}", counted(members))
        }
    }
}

/// How many, and which.
fn counted(list: &[usize]) -> String {
    std::iter::once(&list.len()).chain(list).map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

fn sum(functions: &mut Functions, summands: &[Summand]) -> String {
    let mut words = vec![summands.len().to_string()];
    for summand in summands {
        words.push(match summand.over {
            Over::Phase(phase) => format!("{} {phase}", summand.function),
            Over::Start(_) => format!("{} -", functions.at_end(summand.function, false)),
            Over::End(_) => format!("{} -", functions.at_end(summand.function, true)),
            Over::Nowhere => format!("{} -", summand.function),
        });
    }
    words.join(" ")
}

fn cover_lines(out: &mut String, statement: &Statement, quantity: &Quantity, covers: &[Vec<Leaf>]) {
    let all = |phase: usize| statement.phases[phase].cells();
    let stretches: Vec<Range<usize>> = match quantity {
        Quantity::Path(_, _, cells) => vec![cells.clone()],
        Quantity::Sum(summands) => summands
            .iter()
            .filter_map(|summand| if let Over::Phase(phase) = summand.over { Some(all(phase)) } else { None })
            .collect(),
    };
    for (cells, leaves) in stretches.into_iter().zip(covers) {
        let halvings: Vec<(usize, u32)> = leaves.iter().map(|leaf| (leaf.cell, leaf.halvings)).collect();
        line(out, format_args!("cover {}", trees(cells, &halvings)));
    }
}

/// The trees of some cells, by the cells of all boxes and how often these are halved.
fn trees(cells: Range<usize>, boxes: &[(usize, u32)]) -> String {
    let mut rest = boxes;
    let mut words = vec![];
    for cell in cells {
        let (own, others) = rest.split_at(rest.partition_point(|own| own.0 <= cell));
        words.push(tree(own.iter().map(|own| own.1)));
        rest = others;
    }
    words.join(" ")
}

/// Boxes of a cell in order of time, by how often they are halved, as a tree: `/` before the two halves of a box, `.` for
/// a box that is not halved.
fn tree(boxes: impl Iterator<Item = u32>) -> String {
    let mut signs = String::new();
    let mut depth = 0;
    // Halvings whose second half is still to come, innermost last.
    let mut waiting: Vec<u32> = vec![];
    for halvings in boxes {
        while depth < halvings {
            depth += 1;
            signs.push('/');
            waiting.push(depth);
        }
        signs.push('.');
        depth = waiting.pop().unwrap_or(0);
    }
    signs
}

fn list(numbers: &[f64]) -> String {
    let mut words = vec![numbers.len().to_string()];
    words.extend(numbers.iter().map(|number| exact(*number)));
    words.join(" ")
}

fn interval(x: Interval) -> String {
    if x.is_bounded() { format!("{} {}", exact(x.low()), exact(x.high())) } else { "-inf inf".to_owned() }
}

/// A number, exactly: `-3p-1` is -1.5. NaN and infinities become what no reader accepts.
pub fn exact(value: f64) -> String {
    if !value.is_finite() {
        return format!("{value}");
    }
    let (bits, sign) = (value.to_bits(), if value.is_sign_negative() { "-" } else { "" });
    let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    if mantissa == 0 {
        return "0p0".to_owned();
    }
    let zeros = mantissa.trailing_zeros();
    format!("{sign}{}p{}", mantissa >> zeros, exponent + zeros as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_exact() {
        for (value, expected) in [(-1.5, "-3p-1"), (0.0, "0p0"), (-0.0, "0p0"), (1.0, "1p0"), (5e-324, "1p-1074")] {
            assert_eq!(exact(value), expected);
        }
        let mut random = fastrand::Rng::with_seed(7);
        for value in (0..1000).map(|_| f64::from_bits(random.u64(..))).filter(|value| value.is_finite()) {
            let text = exact(value);
            let (m, e) = text.split_once('p').expect("two parts");
            let (m, e): (i64, i32) = (m.parse().expect("a whole number"), e.parse().expect("an exponent"));
            // In two steps, so that no power of two is beyond the doubles.
            assert_eq!(m as f64 * 2_f64.powi(e / 2) * 2_f64.powi(e - e / 2), value, "{text}");
        }
    }

    #[test]
    fn trees_say_how_boxes_were_halved() {
        let of = |halvings: &[u32]| tree(halvings.iter().copied());
        assert_eq!(of(&[0]), ".");
        assert_eq!(of(&[1, 2, 2]), "/./..");
        assert_eq!(of(&[2, 2, 1]), "//...");
    }
}
