//! The file of a certificate (docs/certificate-format.md): lines of words, numbers in hexadecimal, a digest at the end.

use std::fmt::Write;
use std::ops::Range;

use ntg_splines::Symmetry;
use sha2::{Digest, Sha256};

use crate::certify::{Certificate, Finding, Verdict};
use crate::interval::Interval;
use crate::prove::Leaf;
use crate::statement::{Input, Join, Kind, Node, Over, Quantity, Statement, Summand, Table};

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
    let mut out = String::from("ntg-certificate 1\n");
    line(&mut out, format_args!("problem {}", one_line(&statement.problem)));
    statement.spec.lines().for_each(|text| line(&mut out, format_args!("| {text}")));
    data(&mut out, statement);
    formulas(&mut out, statement);
    for (summands, (value, covers)) in statement.integrals.iter().zip(&certificate.integrals) {
        line(&mut out, format_args!("integral {}", sum(summands)));
        line(&mut out, format_args!("claim bounded {}", interval(*value)));
        cover_lines(&mut out, statement, &Quantity::Sum(summands.clone()), covers);
    }
    for (subject, finding) in certificate.each() {
        let kind = match subject.kind {
            Kind::Constraint(_) => "constraint",
            Kind::Term(_) => "term",
            Kind::Named(_) => "named",
        };
        let [below, above] =
            [subject.bounds.0, subject.bounds.1].map(|bound| bound.map_or("-".to_owned(), |f| f.to_string()));
        let quantity = match &subject.quantity {
            Quantity::Path(function, phase, cells) if *cells == statement.phases[*phase].cells() => {
                format!("path {function} {phase}")
            }
            Quantity::Path(function, phase, cells) => format!("part {function} {phase} {} {}", cells.start, cells.end),
            Quantity::Sum(summands) => format!("sum {}", sum(summands)),
        };
        line(&mut out, format_args!("subject {kind} {below} {above} {quantity} {}", one_line(&subject.name)));
        claim(&mut out, finding);
        cover_lines(&mut out, statement, &subject.quantity, &finding.covers);
    }
    out
}

/// A name on one line.
fn one_line(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn claim(out: &mut String, finding: &Finding) {
    let values = interval(finding.values);
    match finding.verdict {
        Verdict::Bounded => line(out, format_args!("claim bounded {values}")),
        Verdict::Proved => line(out, format_args!("claim proved {values}")),
        Verdict::Within(residual) if residual.is_finite() => {
            line(out, format_args!("claim within {} {values}", hex(residual)));
        }
        Verdict::Within(_) | Verdict::Undecided(_) => line(out, format_args!("claim undecided {values}")),
        Verdict::Refuted(..) => line(out, format_args!("claim refuted {values}")),
    }
    if let (Verdict::Refuted(..), Some(w)) = (finding.verdict, finding.witness) {
        let value = interval(w.value);
        line(out, format_args!("witness {} {} {} {value}", w.cell, w.halvings, w.part));
    }
}

fn data(out: &mut String, statement: &Statement) {
    for number in &statement.numbers {
        line(out, format_args!("number {} {}", hex(number.value), one_line(&number.name)));
    }
    for phase in &statement.phases {
        let cuts = hexes(&phase.cuts);
        line(out, format_args!("phase {} {} {cuts} {}", phase.start, phase.duration, one_line(&phase.name)));
    }
    for spline in &statement.splines {
        let (knots, coefficients) = (hexes(&spline.knots), hexes(&spline.coefficients));
        let name = one_line(&spline.name);
        line(out, format_args!("spline {} {} {knots} {coefficients} {name}", spline.phase, spline.order));
    }
    for flat in &statement.flats {
        line(out, format_args!("flat {} {}", flat.spline, flat.derivative));
    }
    statement.tables.iter().for_each(|one| table(out, one));
}

fn table(out: &mut String, table: &Table) {
    let outside = if table.linear_outside { "linear" } else { "clamp" };
    line(out, format_args!("table {outside} {}", one_line(&table.name)));
    for axis in &table.axes {
        let symmetry = match axis.symmetry {
            Symmetry::Plain => "plain",
            Symmetry::Even => "even",
            Symmetry::Periodic => "periodic",
        };
        let cells: Vec<f64> = axis.cells.iter().flat_map(|(begin, width)| [*begin, *width]).collect();
        let ends = format!("{} {}", hex(axis.ends.0), hex(axis.ends.1));
        let counts = format!("{} {} {}", axis.order, axis.step, axis.coefficients);
        line(out, format_args!("axis {symmetry} {ends} {counts} {} {}", hexes(&cells), hexes(&axis.weights)));
    }
    line(out, format_args!("coefficients {}", hexes(&table.coefficients)));
}

fn formulas(out: &mut String, statement: &Statement) {
    for graph in &statement.graphs {
        line(out, format_args!("graph"));
        for node in &graph.nodes {
            match node {
                Node::Const(value) => line(out, format_args!("const {}", hex(*value))),
                Node::Input(input) => line(out, format_args!("input {input}")),
                Node::Unary(op, x) => line(out, format_args!("{} {x}", op.name())),
                Node::Binary(op, a, b) => line(out, format_args!("{} {a} {b}", op.name())),
                Node::Powi(x, n) => line(out, format_args!("powi {x} {n}")),
                Node::Select(c, a, b) => line(out, format_args!("select {c} {a} {b}")),
                Node::Table(table, orders, args) => {
                    let words = orders.iter().map(ToString::to_string).chain(args.iter().map(ToString::to_string));
                    line(out, format_args!("lookup {table} {}", words.collect::<Vec<_>>().join(" ")));
                }
            }
        }
        line(out, format_args!("rows {}", counted(&graph.rows)));
    }
    for function in &statement.functions {
        let inputs: Vec<String> = function.inputs.iter().map(input).collect();
        let (graph, row) = (function.graph, function.row);
        line(out, format_args!("function {graph} {row} {} {}", inputs.len(), inputs.join(" ")));
    }
}

fn input(input: &Input) -> String {
    match input {
        Input::Flat(flat) => format!("flat {flat}"),
        Input::Start(flat) => format!("start {flat}"),
        Input::End(flat) => format!("end {flat}"),
        Input::Inside(flat, cell) => format!("inside {flat} {cell}"),
        Input::Number(number) => format!("number {number}"),
        Input::Value(value) => format!("value {}", hex(*value)),
        Input::Tau => "tau".to_owned(),
        Input::Integral(integral) => format!("integral {integral}"),
        Input::Join(join, members) => {
            let how = match join {
                Join::Sum => "sum",
                Join::Product => "product",
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

fn sum(summands: &[Summand]) -> String {
    let mut words = vec![summands.len().to_string()];
    for summand in summands {
        words.push(summand.function.to_string());
        words.push(match summand.over {
            Over::Phase(phase) => format!("over {phase}"),
            Over::Start(phase) => format!("start {phase}"),
            Over::End(phase) => format!("end {phase}"),
            Over::Nowhere => "nowhere".to_owned(),
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
        let mut words = vec!["cover".to_owned()];
        let mut rest = &leaves[..];
        for cell in cells {
            let count = rest.iter().take_while(|leaf| leaf.cell == cell).count();
            let (own, others) = rest.split_at(count);
            words.push(tree(own));
            rest = others;
        }
        line(out, format_args!("{}", words.join(" ")));
    }
}

/// Boxes of a cell in order of time as a tree: `/` before the two halves of a box, `.` for a box that is not halved.
fn tree(leaves: &[Leaf]) -> String {
    let mut signs = String::new();
    let mut depth = 0;
    // Halvings whose second half is still to come, innermost last.
    let mut waiting: Vec<u32> = vec![];
    for leaf in leaves {
        while depth < leaf.halvings {
            depth += 1;
            signs.push('/');
            waiting.push(depth);
        }
        signs.push('.');
        depth = waiting.pop().unwrap_or(0);
    }
    signs
}

fn hexes(numbers: &[f64]) -> String {
    let mut words = vec![numbers.len().to_string()];
    words.extend(numbers.iter().map(|number| hex(*number)));
    words.join(" ")
}

fn interval(x: Interval) -> String {
    if x.is_bounded() { format!("{} {}", hex(x.low()), hex(x.high())) } else { "-inf inf".to_owned() }
}

/// A number in hexadecimal, exactly: `-0x1.8p+1` is -3. NaN and infinities become what no reader accepts.
pub fn hex(value: f64) -> String {
    if !value.is_finite() {
        return format!("{value}");
    }
    let (bits, sign) = (value.to_bits(), if value.is_sign_negative() { "-" } else { "" });
    let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (lead, exponent) = match (biased, fraction) {
        (0, 0) => (0, 0),
        (0, _) => (0, -1022),
        _ => (1, biased - 1023),
    };
    let digits = format!("{fraction:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    format!("{sign}0x{lead}{point}{digits}p{exponent:+}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_exact_in_hexadecimal() {
        let cases = [(-3.0, "-0x1.8p+1"), (0.0, "0x0p+0"), (0.1, "0x1.999999999999ap-4"), (1.0, "0x1p+0")];
        for (value, expected) in cases {
            assert_eq!(hex(value), expected);
        }
        assert_eq!(hex(5e-324), "0x0.0000000000001p-1022");
    }

    #[test]
    fn trees_say_how_boxes_were_halved() {
        let leaf = |halvings, part| Leaf {
            cell: 0,
            halvings,
            part,
            values: Interval::ZERO,
            mean: Interval::ZERO,
            total: true,
            open: false,
        };
        assert_eq!(tree(&[leaf(0, 0)]), ".");
        assert_eq!(tree(&[leaf(1, 0), leaf(2, 2), leaf(2, 3)]), "/./..");
        assert_eq!(tree(&[leaf(2, 0), leaf(2, 1), leaf(1, 1)]), "//...");
    }
}
