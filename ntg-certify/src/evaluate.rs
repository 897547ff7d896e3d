//! Evaluates functions of a statement on boxes of time.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use ntg_compiler::expr::{Binary, Unary};

use crate::interval::Interval;
use crate::jet::{COUNT, Jet};
use crate::spline::{BSpline, Piece};
use crate::statement::{Flat, Graph, Input, Join, Node, Statement};
use crate::table::look_up;

/// A statement, ready to be evaluated.
pub(crate) struct Machine<'a> {
    pub(crate) statement: &'a Statement,
    /// For each graph and row the nodes that it needs, with operands by their place in this list; made when it is asked
    /// for.
    lines: Vec<Vec<OnceCell<Vec<Node>>>>,
    /// Both ends of every flat.
    ends: Vec<(Interval, Interval)>,
    /// What is known of the integrals.
    pub(crate) integrals: Vec<Interval>,
}

/// The jets at one box or one point: of every flat that is needed, by number, and of scaled time.
pub(crate) struct Here<const N: usize = COUNT> {
    pub(crate) flats: Vec<Option<Jet<N>>>,
    pub(crate) tau: Jet<N>,
}

impl<'a> Machine<'a> {
    pub(crate) fn new(statement: &'a Statement) -> Self {
        let lines = statement.graphs.iter().map(|graph| vec![OnceCell::new(); graph.rows.len()]);
        let ends = statement.flats.iter().map(|flat| {
            let cuts = &statement.phases[statement.splines[flat.spline].phase].cuts;
            let cells = cuts.len() - 1;
            (cell(statement, *flat, 0).first(), cell(statement, *flat, cells - 1).last())
        });
        let integrals = vec![Interval::ENTIRE; statement.integrals.len()];
        Self { statement, lines: lines.collect(), ends: ends.collect(), integrals }
    }

    /// The inputs that a function uses: those of its graph belong to all of its rows.
    pub(crate) fn inputs(&self, function: usize) -> impl Iterator<Item = &Input> {
        let own = &self.statement.functions[function];
        self.line(function).iter().filter_map(|node| match node {
            Node::Input(input) => own.inputs.get(*input),
            _ => None,
        })
    }

    fn line(&self, function: usize) -> &[Node] {
        let own = &self.statement.functions[function];
        self.lines[own.graph][own.row].get_or_init(|| line(&self.statement.graphs[own.graph], own.row))
    }

    /// The flats that a function needs at the time of evaluation.
    pub(crate) fn needs(&self, function: usize) -> Vec<usize> {
        let mut found = BTreeSet::new();
        let mut open = vec![function];
        while let Some(function) = open.pop() {
            for input in self.inputs(function) {
                match input {
                    Input::Flat(flat) => drop(found.insert(*flat)),
                    Input::Join(_, members) => open.extend(members),
                    _ => {}
                }
            }
        }
        found.into_iter().collect()
    }

    /// The value of a function that depends on no time, or at one end of a phase.
    pub(crate) fn number(&self, function: usize, end: Option<(usize, bool)>) -> Jet<1> {
        let mut flats = vec![None; self.statement.flats.len()];
        if let Some((_, last)) = end {
            for flat in self.needs(function) {
                let (first, end) = self.ends[flat];
                flats[flat] = Some(Jet::constant(if last { end } else { first }));
            }
        }
        let tau = Jet::constant(end.map_or(Interval::ENTIRE, |(_, last)| Interval::point(f64::from(u8::from(last)))));
        self.evaluate(function, &Here { flats, tau })
    }

    /// A function at a box or a point.
    pub(crate) fn evaluate<const N: usize>(&self, function: usize, here: &Here<N>) -> Jet<N> {
        let line = self.line(function);
        let function = &self.statement.functions[function];
        let mut values: Vec<Jet<N>> = Vec::with_capacity(line.len());
        for node in line {
            let value = match node {
                Node::Const(value) => Jet::constant(Interval::point(*value)),
                Node::Input(input) => self.input(&function.inputs[*input], here),
                Node::Unary(op, x) => unary(*op, &values[*x]),
                Node::Binary(op, a, b) => binary(*op, &values[*a], &values[*b], a == b),
                Node::Powi(x, n) => values[*x].integer_power(*n),
                Node::Select(condition, then, otherwise) => {
                    values[*condition].select(&values[*then], &values[*otherwise])
                }
                Node::Table(table, derivative, args) => {
                    let args: Vec<Jet<N>> = args.iter().map(|arg| values[*arg]).collect();
                    look_up(&self.statement.tables[*table], derivative, &args)
                }
            };
            values.push(value);
        }
        values.last().copied().unwrap_or(Jet::rough(Interval::ENTIRE, false))
    }

    fn input<const N: usize>(&self, input: &Input, here: &Here<N>) -> Jet<N> {
        match input {
            Input::Flat(flat) => here.flats[*flat].unwrap_or(Jet::rough(Interval::ENTIRE, false)),
            Input::Start(flat) => Jet::constant(self.ends[*flat].0),
            Input::End(flat) => Jet::constant(self.ends[*flat].1),
            Input::Inside(flat, number) => {
                Jet::constant(cell(self.statement, self.statement.flats[*flat], *number).first())
            }
            Input::Number(number) => Jet::constant(Interval::point(self.statement.numbers[*number].value)),
            Input::Value(value) => Jet::constant(Interval::point(*value)),
            Input::Tau => here.tau,
            Input::Integral(integral) => Jet::constant(self.integrals[*integral]),
            Input::Join(join, members) => {
                let values = members.iter().map(|member| self.evaluate(*member, here));
                let joined = values.reduce(|a, b| match join {
                    Join::Sum => a + b,
                    Join::Product => a * b,
                    Join::Min => a.min(&b),
                    Join::Max => a.max(&b),
                });
                joined.unwrap_or_else(|| match join {
                    Join::Sum => Jet::constant(Interval::ZERO),
                    Join::Product => Jet::constant(Interval::ONE),
                    // An infinite value is no real number.
                    Join::Min | Join::Max => Jet::rough(Interval::ENTIRE, false),
                })
            }
        }
    }
}

/// The polynomial of a flat on a cell of its phase.
pub(crate) fn cell(statement: &Statement, flat: Flat, cell: usize) -> Piece {
    let spline = &statement.splines[flat.spline];
    let cuts = &statement.phases[spline.phase].cuts;
    let of = BSpline { order: spline.order, knots: &spline.knots, coefficients: &spline.coefficients };
    of.piece(flat.derivative, cuts[cell], cuts[cell + 1])
}

/// The nodes that one result needs, with operands renumbered; the result is the last.
pub(crate) fn line(graph: &Graph, row: usize) -> Vec<Node> {
    let root = graph.rows[row];
    let mut needed = vec![false; root + 1];
    needed[root] = true;
    for k in (0..=root).rev().filter(|k| *k <= root) {
        if needed[k] {
            for_each_operand(&graph.nodes[k], |x| needed[x] = true);
        }
    }
    let mut place = vec![usize::MAX; root + 1];
    let mut line = vec![];
    for (k, node) in graph.nodes[..=root].iter().enumerate().filter(|(k, _)| needed[*k]) {
        place[k] = line.len();
        let p = |x: &usize| place[*x];
        line.push(match node {
            Node::Const(_) | Node::Input(_) => node.clone(),
            Node::Unary(op, x) => Node::Unary(*op, p(x)),
            Node::Binary(op, a, b) => Node::Binary(*op, p(a), p(b)),
            Node::Powi(x, n) => Node::Powi(p(x), *n),
            Node::Select(c, a, b) => Node::Select(p(c), p(a), p(b)),
            Node::Table(table, derivative, args) => {
                Node::Table(*table, derivative.clone(), args.iter().map(p).collect())
            }
        });
    }
    line
}

fn for_each_operand(node: &Node, mut visit: impl FnMut(usize)) {
    match node {
        Node::Const(_) | Node::Input(_) => {}
        Node::Unary(_, x) | Node::Powi(x, _) => visit(*x),
        Node::Binary(_, a, b) => [*a, *b].into_iter().for_each(visit),
        Node::Select(c, a, b) => [*c, *a, *b].into_iter().for_each(visit),
        Node::Table(_, _, args) => args.iter().copied().for_each(visit),
    }
}

fn unary<const N: usize>(op: Unary, x: &Jet<N>) -> Jet<N> {
    match op {
        Unary::Neg => -*x,
        Unary::Sqrt => x.sqrt(),
        Unary::Exp => x.exp(),
        Unary::Log => x.log(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => x.tan(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
        Unary::Sinh => x.sinh(),
        Unary::Cosh => x.cosh(),
        Unary::Tanh => x.tanh(),
        Unary::Abs => x.abs(),
        Unary::Sign => x.sign(),
        Unary::Logistic => x.logistic(),
        Unary::Softplus => x.softplus(),
    }
}

fn binary<const N: usize>(op: Binary, a: &Jet<N>, b: &Jet<N>, same: bool) -> Jet<N> {
    match op {
        Binary::Mul if same => a.square(),
        Binary::Add => *a + *b,
        Binary::Sub => *a - *b,
        Binary::Mul => *a * *b,
        Binary::Div => a.over(b),
        Binary::Pow => a.pow(b),
        Binary::Atan2 => a.atan2(b),
        Binary::Hypot => a.hypot(b),
        Binary::Min => a.min(b),
        Binary::Max => a.max(b),
        Binary::LessEq => a.less_eq(b),
    }
}
