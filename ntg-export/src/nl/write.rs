//! Writes .nl, .row and .col.
//!
//! ```text
//! header, V (shared expressions), C (rows), O (objective), x (start), r (bounds of rows), b (bounds), k, J, G
//! ```
//!
//! Segments have no comments: not every reader skips them.

use super::Order;
use crate::expressions::{Expressions, Row};
use crate::graph::{Binary, Compare, Graph, Id, Node, Unary};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The text of three files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Files {
    /// The program.
    pub nl: String,
    /// The names of the rows and, last, of the objective: one a line.
    pub row: String,
    /// The names of the variables, one a line.
    pub col: String,
}

/// Writes a program with a start, in the order of the transcription.
pub fn write(program: &Expressions, order: &Order, start: &[f64]) -> Files {
    let mut place = vec![0; order.variables.len()];
    order.variables.iter().enumerate().for_each(|(at, variable)| place[*variable] = at);
    let mut reference = vec![None; program.graph.ids().count()];
    for (i, id) in order.shared.iter().flatten().enumerate() {
        reference[id.index()] = Some(place.len() + i);
    }
    let mut text = Text { program, order, place, reference, out: String::new() };
    text.header();
    text.shared();
    text.rows();
    text.bounds(start);
    text.linear_parts();
    let lines = |names: &mut dyn Iterator<Item = &String>| names.fold(String::new(), |all, name| all + name + "\n");
    Files {
        nl: text.out,
        row: lines(&mut order.rows.iter().map(|row| &program.row_names[*row])) + OBJECTIVE_NAME + "\n",
        col: lines(&mut order.variables.iter().map(|variable| &program.variable_names[*variable])),
    }
}

/// What the objective is called in the file of names.
const OBJECTIVE_NAME: &str = "objective";

struct Text<'a> {
    program: &'a Expressions,
    order: &'a Order,
    /// The place of each variable in the file.
    place: Vec<usize>,
    /// The number of each shared expression.
    reference: Vec<Option<usize>>,
    out: String,
}

/// What is still to be written of an expression.
enum Pending {
    Expression(Id),
    Word(&'static str),
    Count(usize),
}

impl Text<'_> {
    fn line(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.out, "{text}");
    }

    fn header(&mut self) {
        let (program, order) = (self.program, self.order);
        let (n, m) = (program.bounds.len(), program.rows.len());
        let equal = program.row_bounds.iter().filter(|(lower, upper)| lower == upper).count();
        let is_range = |(lower, upper): &&(f64, f64)| lower != upper && lower.is_finite() && upper.is_finite();
        let ranges = program.row_bounds.iter().filter(is_range).count();
        let [both, rows, objective] = order.nonlinear;
        // Where variables are nonlinear in the objective only, those of the rows count as its own: Gay's order needs it.
        let in_objective = if objective > 0 { both + rows + objective } else { both };
        let entries: usize = program.rows.iter().map(|row| self.entries(row).len()).sum();
        let slopes = self.entries(&program.objective).len();
        let longest = |names: &[String]| names.iter().map(String::len).max().unwrap_or(0);
        let widest = [longest(&program.row_names).max(OBJECTIVE_NAME.len()), longest(&program.variable_names)];
        let shared = order.shared.each_ref().map(Vec::len);
        self.line(format_args!("g3 1 1 0\t# problem {}", program.name));
        self.line(format_args!(" {n} {m} 1 {ranges} {equal}\t# vars, constraints, objectives, ranges, eqns"));
        let nonlinear = usize::from(!program.objective.rest.is_empty());
        self.line(format_args!(" {} {nonlinear}\t# nonlinear constraints, objectives", order.nonlinear_rows));
        self.line(format_args!(" 0 0\t# network constraints: nonlinear, linear"));
        self.line(format_args!(
            " {} {in_objective} {both}\t# nonlinear vars in constraints, objectives, both",
            both + rows
        ));
        self.line(format_args!(" 0 0 0 1\t# linear network variables; functions; arith, flags"));
        self.line(format_args!(" 0 0 0 0 0\t# discrete variables: binary, integer, nonlinear (b,c,o)"));
        self.line(format_args!(" {entries} {slopes}\t# nonzeros in Jacobian, gradients"));
        self.line(format_args!(" {} {}\t# max name lengths: constraints, variables", widest[0], widest[1]));
        self.line(format_args!(" {} {} {} 0 0\t# common exprs: b,c,o,c1,o1", shared[0], shared[1], shared[2]));
    }

    /// Every variable of a row, by its place, with its linear coefficient.
    fn entries(&self, row: &Row) -> BTreeMap<usize, f64> {
        let mut entries: BTreeMap<usize, f64> = BTreeMap::new();
        let mut seen = std::collections::HashSet::new(); // Asked, never iterated.
        let mut open = row.rest.clone();
        while let Some(id) = open.pop() {
            if !seen.insert(id) {
                continue;
            }
            match self.program.graph.node(id) {
                Node::Variable(variable) => _ = entries.insert(self.place[*variable as usize], 0.0),
                Node::Linear(_, terms) => {
                    entries.extend(terms.iter().map(|(variable, _)| (self.place[*variable as usize], 0.0)));
                }
                node => node.each_operand(|operand| open.push(operand)),
            }
        }
        for (variable, c) in &row.affine.terms {
            *entries.entry(self.place[*variable as usize]).or_insert(0.0) += c;
        }
        entries
    }

    fn shared(&mut self) {
        let program = self.program;
        for id in self.order.shared.iter().flatten() {
            let number = self.reference[id.index()].unwrap_or(0);
            match program.graph.node(*id) {
                Node::Linear(constant, terms) => {
                    self.line(format_args!("V{number} {} 0", terms.len()));
                    for (variable, c) in terms {
                        let place = self.place[*variable as usize];
                        self.line(format_args!("{place} {:?}", c.value()));
                    }
                    self.line(format_args!("n{:?}", constant.value()));
                }
                _ => {
                    self.line(format_args!("V{number} 0 0"));
                    self.definition(*id);
                }
            }
        }
    }

    fn rows(&mut self) {
        let (program, order) = (self.program, self.order);
        for (at, row) in order.rows.iter().enumerate() {
            self.line(format_args!("C{at}"));
            self.nonlinear(&program.rows[*row]);
        }
        self.line(format_args!("O0 {}", u8::from(program.maximize)));
        self.nonlinear(&program.objective);
    }

    /// The nonlinear part of a row, and its constant.
    fn nonlinear(&mut self, row: &Row) {
        let constant = row.affine.constant;
        let count = row.rest.len() + usize::from(constant != 0.0);
        match count {
            0 => self.line(format_args!("n0")),
            1 => {}
            2 => self.line(format_args!("o0")),
            _ => self.line(format_args!("o54\n{count}")),
        }
        if constant != 0.0 {
            self.line(format_args!("n{constant:?}"));
        }
        row.rest.iter().for_each(|id| self.expression(*id));
    }

    /// An expression, by reference where it is a shared one.
    fn expression(&mut self, id: Id) {
        self.prefix(vec![Pending::Expression(id)]);
    }

    /// A shared expression itself.
    fn definition(&mut self, id: Id) {
        let mut pending = vec![];
        operation(&self.program.graph, id, &mut pending);
        pending.reverse();
        self.prefix(pending);
    }

    /// Polish prefix form, without recursion; the last of `pending` comes first.
    fn prefix(&mut self, mut pending: Vec<Pending>) {
        let program = self.program;
        while let Some(next) = pending.pop() {
            let id = match next {
                Pending::Word(word) => {
                    self.line(format_args!("{word}"));
                    continue;
                }
                Pending::Count(count) => {
                    self.line(format_args!("{count}"));
                    continue;
                }
                Pending::Expression(id) => id,
            };
            match (self.reference[id.index()], program.graph.node(id)) {
                (Some(number), _) => self.line(format_args!("v{number}")),
                (None, Node::Variable(variable)) => {
                    let place = self.place[*variable as usize];
                    self.line(format_args!("v{place}"));
                }
                (None, Node::Constant(value)) => self.line(format_args!("n{:?}", value.value())),
                _ => {
                    let first = pending.len();
                    operation(&program.graph, id, &mut pending);
                    pending[first..].reverse();
                }
            }
        }
    }

    fn bounds(&mut self, start: &[f64]) {
        let (program, order) = (self.program, self.order);
        self.line(format_args!("x{}", start.len()));
        for (at, variable) in order.variables.iter().enumerate() {
            self.line(format_args!("{at} {:?}", start[*variable]));
        }
        self.line(format_args!("r"));
        order.rows.iter().for_each(|row| self.range(program.row_bounds[*row]));
        self.line(format_args!("b"));
        order.variables.iter().for_each(|variable| self.range(program.bounds[*variable]));
    }

    fn range(&mut self, (lower, upper): (f64, f64)) {
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) if lower == upper => self.line(format_args!("4 {lower:?}")),
            (true, true) => self.line(format_args!("0 {lower:?} {upper:?}")),
            (false, true) => self.line(format_args!("1 {upper:?}")),
            (true, false) => self.line(format_args!("2 {lower:?}")),
            (false, false) => self.line(format_args!("3")),
        }
    }

    /// Counts of the Jacobian's columns, added up; then the linear coefficients of rows and objective.
    fn linear_parts(&mut self) {
        let (program, order) = (self.program, self.order);
        let rows: Vec<_> = order.rows.iter().map(|row| self.entries(&program.rows[*row])).collect();
        let mut counts = vec![0; program.bounds.len()];
        rows.iter().flat_map(BTreeMap::keys).for_each(|place| counts[*place] += 1);
        self.line(format_args!("k{}", counts.len().saturating_sub(1)));
        let mut total = 0;
        for count in counts.iter().take(counts.len().saturating_sub(1)) {
            total += count;
            self.line(format_args!("{total}"));
        }
        for (at, entries) in rows.iter().enumerate().filter(|(_, entries)| !entries.is_empty()) {
            self.line(format_args!("J{at} {}", entries.len()));
            entries.iter().for_each(|(place, c)| self.line(format_args!("{place} {c:?}")));
        }
        let entries = self.entries(&program.objective);
        if !entries.is_empty() {
            self.line(format_args!("G0 {}", entries.len()));
            entries.iter().for_each(|(place, c)| self.line(format_args!("{place} {c:?}")));
        }
    }
}

/// The code of an operation and its operands, in order.
fn operation(graph: &Graph, id: Id, out: &mut Vec<Pending>) {
    match graph.node(id) {
        Node::Unary(function, a) => {
            out.push(Pending::Word(unary(*function)));
            out.push(Pending::Expression(*a));
        }
        Node::Binary(function, a, b) => {
            out.push(Pending::Word(binary(*function)));
            out.extend([*a, *b].map(Pending::Expression));
        }
        Node::If { compare: (compare, a, b), then, otherwise } => {
            let compare = match compare {
                Compare::Less => "o22",
                Compare::LessEqual => "o23",
                Compare::NotEqual => "o30",
            };
            out.extend([Pending::Word("o35"), Pending::Word(compare)]);
            out.extend([*a, *b, *then, *otherwise].map(Pending::Expression));
        }
        Node::Least(all) | Node::Greatest(all) => {
            let code = if matches!(graph.node(id), Node::Least(_)) { "o11" } else { "o12" };
            out.extend([Pending::Word(code), Pending::Count(all.len())]);
            out.extend(all.iter().copied().map(Pending::Expression));
        }
        // The others are written where they stand.
        Node::Constant(_) | Node::Variable(_) | Node::Linear(..) => {
            out.push(Pending::Expression(id));
        }
    }
}

/// Operation codes of Gay's table 6.
fn unary(function: Unary) -> &'static str {
    match function {
        Unary::Floor => "o13",
        Unary::Abs => "o15",
        Unary::Tanh => "o37",
        Unary::Tan => "o38",
        Unary::Sqrt => "o39",
        Unary::Sinh => "o40",
        Unary::Sin => "o41",
        Unary::Log => "o43",
        Unary::Exp => "o44",
        Unary::Cosh => "o45",
        Unary::Cos => "o46",
        Unary::Atan => "o49",
        Unary::Asin => "o51",
        Unary::Acos => "o53",
    }
}

fn binary(function: Binary) -> &'static str {
    match function {
        Binary::Add => "o0",
        Binary::Sub => "o1",
        Binary::Mul => "o2",
        Binary::Div => "o3",
        Binary::Pow => "o5",
        Binary::Atan2 => "o48",
    }
}
