//! Expressions, units, names and paths, as they were written; the lower half of `ast`.
//!
//! See `ast` for what holds of these types.

use super::{Let, Relation};
use crate::source::Span;

/// A name, in Unicode form NFC.
#[derive(Clone, Debug, PartialEq)]
pub struct Ident {
    /// The name.
    pub text: String,
    /// Where.
    pub span: Span,
}

/// `strike` or `uav[2]`: one step of a path. Most have no index, a few one; more parse, so that the next
/// stage can say what is wrong with them.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The name.
    pub name: Ident,
    /// What stands in the brackets; empty without brackets.
    pub indices: Vec<Index>,
    /// All of it.
    pub span: Span,
}

/// `i` or `2 .. 4` in the brackets behind a name: one member, or those from one to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Index {
    /// The member, or the first of several.
    pub first: Expr,
    /// The last of several, included.
    pub last: Option<Expr>,
    /// All of it.
    pub span: Span,
}

/// `x`, `x[i]`, `uav[2].strike`: a name, perhaps indexed, perhaps inside others.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// From the outside to the inside, one at least.
    pub segments: Vec<Segment>,
    /// All of it.
    pub span: Span,
}

/// `i in first .. last`: an index with the range that it runs over, both ends included.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexRange {
    /// The index.
    pub index: Ident,
    /// Its first value.
    pub first: Expr,
    /// Its last value.
    pub last: Expr,
    /// All of it.
    pub span: Span,
}

/// `[km/s^2]`: a unit, as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The factors, in the user's order; the first is always multiplied.
    pub factors: Vec<UnitFactor>,
    /// From bracket to bracket.
    pub span: Span,
}

/// One factor of a unit: `s^2` and the sign before it.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFactor {
    /// `*` or `/`.
    pub op: MulOp,
    /// What is raised.
    pub base: UnitBase,
    /// The exponent; 1 where none is written.
    pub power: i32,
    /// The factor without the sign.
    pub span: Span,
}

/// What a factor of a unit is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitBase {
    /// `1`
    One,
    /// `km`; unit symbols are a name space of their own, in which no word is reserved.
    Symbol(Ident),
    /// `(kg * m)`
    Group(Vec<UnitFactor>),
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// All of it, the parentheses around it included.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `0.25 [km/s]`
    Number(Number),
    /// `pi`
    Pi,
    /// `t`, mission time.
    Time,
    /// `tau`, scaled time of the phase.
    ScaledTime,
    /// A name, perhaps indexed.
    Path(Path),
    /// `(1, 0, 0)`, `(a,)`: the elements of a vector, or the rows of a matrix.
    Tuple(Vec<Expr>),
    /// `-a`
    Neg(Box<Expr>),
    /// `a + b - c`, two terms at least; the first one's sign is always plus (`-a + b` begins with a `Neg`).
    Sum(Vec<(Sign, Expr)>),
    /// `a * b / c`, two factors at least; the first one's operator is always `Multiply`.
    Product(Vec<(MulOp, Expr)>),
    /// `base ^ exponent`
    Power(Box<Expr>, Box<Expr>),
    /// `sin(x)`, `pd(range, sig)`: a built-in function, a `fn` or a table, applied.
    Call(Call),
    /// `der(e)`, `der(e, 2)`: derivative in real time.
    Der {
        /// What is differentiated.
        of: Box<Expr>,
        /// How often; once where it is not said.
        order: Option<Box<Expr>>,
    },
    /// `partial(f(s, w), s)`
    Partial {
        /// The application of a function or table.
        of: Call,
        /// With respect to which of its arguments.
        argument: Box<Expr>,
    },
    /// `integral(e)`, `integral(path, e)`: over real time.
    Integral {
        /// Of which phase or agent; else of the scope that it stands in.
        path: Option<Path>,
        /// What is integrated.
        of: Box<Expr>,
    },
    /// `initial(e)`, `final(path, e)`: value at an end.
    Boundary {
        /// Which end.
        boundary: Boundary,
        /// Of which phase or agent; else of the scope that it stands in.
        path: Option<Path>,
        /// What is evaluated there.
        of: Box<Expr>,
    },
    /// `start(path)`, `end(path)`, `duration(path)`
    Event {
        /// Which of its times.
        event: Event,
        /// Of which phase or agent.
        path: Path,
    },
    /// `sum(i in 1 .. N, e)` and its sisters.
    Reduce(Box<Reduction>),
    /// `if a <= b smooth w { ... } else { ... }`
    If(Box<Conditional>),
    /// `from "gates.csv" columns 1 .. 3`: the numbers of a file, as the value of a `const` or `param`.
    File(Box<File>),
    /// `rows("gates.csv")`: how many rows a file has.
    Rows(FileName),
    /// `{ let a = ...; value }`: a value with names for its steps, as the body of a function or a branch.
    Steps(Box<Steps>),
}

/// `from "gates.csv" columns 1 .. 3`
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// The file.
    pub name: FileName,
    /// The unit of its numbers, which stands behind the size.
    pub unit: Option<Unit>,
    /// Which columns; all where none are written.
    pub columns: Option<Columns>,
}

/// A path as written between quotes.
#[derive(Clone, Debug, PartialEq)]
pub struct FileName {
    /// The path.
    pub path: String,
    /// The string with its quotes.
    pub span: Span,
}

/// `column 1`, `columns 1 .. 3`: which columns of a file, counted from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// The first one.
    pub first: Expr,
    /// The last one, included; none where one column is meant.
    pub last: Option<Expr>,
    /// All of it.
    pub span: Span,
}

/// `if a <= b smooth w { ... } else if c <= d { ... } else { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct Conditional {
    /// What is tried in turn, one at least.
    pub branches: Vec<Branch>,
    /// The value where none of their conditions holds.
    pub otherwise: Expr,
}

/// `if condition smooth width { value }`
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// What decides; never a `Between`.
    pub condition: Relation,
    /// Over how much of what is compared the branch blends into the next one.
    pub smooth: Option<Expr>,
    /// The value where the condition holds.
    pub value: Expr,
    /// From `if` to the end of the condition.
    pub span: Span,
}

/// `{ let a = ...;  let b = ...;  value }`
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// The names, each known in those behind it; one at least.
    pub lets: Vec<Let>,
    /// The value.
    pub value: Expr,
}

/// A number with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Finite, not negative.
    pub value: f64,
    /// Its unit: written after it, or given to it by the list or range that it stands in.
    pub unit: Option<Unit>,
}

/// A function or table with its arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    /// What is applied.
    pub function: Ident,
    /// To what; one at least.
    pub arguments: Vec<Expr>,
    /// All of it.
    pub span: Span,
}

/// The sign of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// `+`
    Plus,
    /// `-`
    Minus,
}

/// How a factor enters a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MulOp {
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

/// An end of a phase or agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// `initial`
    Initial,
    /// `final`
    Final,
}

/// A time of a phase or agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// `start`
    Start,
    /// `end`
    End,
    /// `duration`
    Duration,
}

/// `sum(i in 1 .. N, body)`, `smooth_max(i in 1 .. N, body, width)`
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// What is done with the bodies.
    pub op: ReduceOp,
    /// The index and its range.
    pub over: IndexRange,
    /// What is taken for each index.
    pub body: Expr,
    /// The width of `smooth_max`, which it always has and the others never.
    pub width: Option<Expr>,
}

/// What a reduction does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReduceOp {
    /// Adds.
    Sum,
    /// Multiplies.
    Product,
    /// Takes the least.
    Min,
    /// Takes the greatest.
    Max,
    /// Takes the greatest, smoothly.
    SmoothMax,
}

impl Expr {
    /// The number, if this is one with at most a sign before it (what a unit after a list applies to).
    pub fn signed_literal(&self) -> Option<&Number> {
        match &self.kind {
            ExprKind::Number(number) => Some(number),
            ExprKind::Neg(inner) => match &inner.kind {
                ExprKind::Number(number) => Some(number),
                _ => None,
            },
            _ => None,
        }
    }
}
