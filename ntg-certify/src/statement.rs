//! What a certificate is about: a trajectory and the formulas over it, as plain data (docs/certificate-format.md).
//!
//! Everything is spelled out: families are expanded, index forms are resolved, and every number is a double that
//! stands for itself. A [`Statement`] is what `ntg-check` reads back from the file.

use std::ops::Range;

use ntg_compiler::expr::{Binary, Unary};
use ntg_splines::AxisParts;
use ntg_structure::Unit;

/// One operation of a [`Graph`] on nodes before it.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A number.
    Const(f64),
    /// An input of the function.
    Input(usize),
    /// An operation on one node.
    Unary(Unary, usize),
    /// An operation on two nodes.
    Binary(Binary, usize, usize),
    /// An integer power.
    Powi(usize, i32),
    /// The second where the first is not 0, else the third.
    Select(usize, usize, usize),
    /// A derivative of a table, with its orders and arguments.
    Table(usize, Vec<u8>, Vec<usize>),
}

/// A compiled formula with one or several results.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Its operations, operands first.
    pub nodes: Vec<Node>,
    /// The node that is each result.
    pub rows: Vec<usize>,
}

/// How members of a family are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Join {
    /// Their sum.
    Sum,
    /// Their product.
    Product,
    /// The smallest.
    Min,
    /// The largest.
    Max,
}

/// What an input of a function is.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A [`Flat`] at the time of evaluation.
    Flat(usize),
    /// A [`Flat`] at the start of its phase.
    Start(usize),
    /// A [`Flat`] at the end of its phase.
    End(usize),
    /// A [`Flat`] where a cell of its phase begins, from the right.
    Inside(usize, usize),
    /// One of the [`Statement::numbers`].
    Number(usize),
    /// An index.
    Value(f64),
    /// The scaled time of the phase.
    Tau,
    /// Functions of the same time, joined.
    Join(Join, Vec<usize>),
    /// One of the [`Statement::integrals`].
    Integral(usize),
}

/// A result of a graph for given inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Which graph.
    pub graph: usize,
    /// Which of its results.
    pub row: usize,
    /// Its inputs, in order.
    pub inputs: Vec<Input>,
}

/// A derivative of an output by scaled time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flat {
    /// Which spline.
    pub spline: usize,
    /// Which derivative.
    pub derivative: usize,
}

/// An output in a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Its path.
    pub name: String,
    /// Which phase.
    pub phase: usize,
    /// One more than the degree.
    pub order: usize,
    /// Knots in scaled time.
    pub knots: Vec<f64>,
    /// Coefficients, SI.
    pub coefficients: Vec<f64>,
}

/// A stretch of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its path; empty where it has no name.
    pub name: String,
    /// Its start in seconds, as one of the numbers.
    pub start: usize,
    /// Its duration in seconds, as one of the numbers.
    pub duration: usize,
    /// Scaled times between which every spline of the phase is one polynomial, from 0 to 1; places that functions are
    /// taken at, or between, are among them. What lies between two is a cell.
    pub cuts: Vec<f64>,
}

impl Phase {
    /// All of its cells.
    pub fn cells(&self) -> Range<usize> {
        0..self.cuts.len().saturating_sub(1)
    }
}

/// A number with its name: a parameter, a duration, a start, a variable. SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// What it is.
    pub name: String,
    /// Its value.
    pub value: f64,
}

/// An interpolation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its name.
    pub name: String,
    /// Its arguments.
    pub axes: Vec<AxisParts>,
    /// Whether it goes on with its end slope outside its nodes; else with its end value.
    pub linear_outside: bool,
    /// Its coefficients, row-major.
    pub coefficients: Vec<f64>,
}

/// Where a summand is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// It is added up over the scaled time of a phase.
    Phase(usize),
    /// It is taken at the start of a phase.
    Start(usize),
    /// It is taken at the end of a phase.
    End(usize),
    /// It belongs to no time.
    Nowhere,
}

/// A summand: a function, and where it is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summand {
    /// Which function.
    pub function: usize,
    /// Where.
    pub over: Over,
}

/// What is bounded.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// A function at every time of some cells of a phase.
    Path(usize, usize, Range<usize>),
    /// A sum of integrals and numbers.
    Sum(Vec<Summand>),
}

/// What kind of thing of the spec a quantity is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A constraint; the number is its index in the structure.
    Constraint(usize),
    /// A term of the objective, as it is minimised.
    Term(usize),
    /// A named expression.
    Named(usize),
}

/// Something to be bounded.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// What of the spec it is.
    pub kind: Kind,
    /// Its name with its members' indices.
    pub name: String,
    /// The indices of the loops in which it stands; of terms none.
    pub indices: Vec<i64>,
    /// What is bounded.
    pub quantity: Quantity,
    /// The unit in which a person sees it; the file has SI units alone.
    pub unit: Unit,
    /// The functions that are its required bounds, below and above; the same one twice for an equality.
    pub bounds: (Option<usize>, Option<usize>),
}

/// A trajectory, the formulas over it, and what is to be bounded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statement {
    /// The problem's name.
    pub problem: String,
    /// The text of the spec; it is not what is proved about, the graphs are.
    pub spec: String,
    /// All numbers.
    pub numbers: Vec<Number>,
    /// All phases.
    pub phases: Vec<Phase>,
    /// All splines.
    pub splines: Vec<Spline>,
    /// All derivatives of splines that functions use.
    pub flats: Vec<Flat>,
    /// All tables.
    pub tables: Vec<Table>,
    /// All graphs.
    pub graphs: Vec<Graph>,
    /// All functions.
    pub functions: Vec<Function>,
    /// Integrals that functions use.
    pub integrals: Vec<Vec<Summand>>,
    /// What is bounded.
    pub subjects: Vec<Subject>,
}
