//! Tables, as they were written; a part of `ast`.
//!
//! See `ast` for what holds of these types.

use super::{Expr, Ident, Unit, Values};
use crate::source::Span;

/// `table name(axes) [unit] = method { rows }` or `... = method from "file";`
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Whether `param` stood before it: nodes and values may be replaced at run time.
    pub is_param: bool,
    /// Its name.
    pub name: Ident,
    /// Its arguments, one at least.
    pub axes: Vec<Axis>,
    /// The unit of its values.
    pub unit: Option<Unit>,
    /// How it is interpolated.
    pub method: Method,
    /// Where its numbers are.
    pub data: TableData,
}

/// `elevation even [deg]`: an argument of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name.
    pub name: Ident,
    /// `even` or `periodic`.
    pub symmetry: Option<Symmetry>,
    /// The unit of its nodes.
    pub unit: Option<Unit>,
    /// All of it.
    pub span: Span,
}

/// How a table's axis goes on beyond its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Mirrored at 0.
    Even,
    /// Closed.
    Periodic,
}

/// `fit bspline(order = 4, intervals = (16, 6), extrapolate = linear)`: how a table is interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Which method.
    pub kind: MethodKind,
    /// Order of the splines; `bspline` and `fit bspline` only.
    pub order: Option<Expr>,
    /// Intervals along each axis; `fit bspline` only.
    pub intervals: Option<Values>,
    /// What the table does outside its nodes; `clamp` where it is not said.
    pub extrapolate: Option<Extrapolate>,
    /// All of it.
    pub span: Span,
}

/// The methods of interpolation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodKind {
    /// Shape-preserving cubic.
    Monotone,
    /// Interpolation by B-splines.
    Bspline,
    /// Least squares by B-splines.
    FitBspline,
    /// Straight between nodes.
    Linear,
}

/// What a table does outside its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolate {
    /// Keeps its end value.
    Clamp,
    /// Goes on with its end slope.
    Linear,
}

/// Where a table's numbers are.
#[derive(Clone, Debug, PartialEq)]
pub enum TableData {
    /// In the spec.
    Inline(Rows),
    /// In a file; the path as written between the quotes.
    File {
        /// The path.
        path: String,
        /// The string with its quotes.
        span: Span,
    },
}

/// The rows of an inline table. Whether they are ragged is the next stage's affair.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// `0, 30, 31;`: the nodes of the second argument, if there is such a row.
    pub header: Option<Vec<Expr>>,
    /// `20: 2.5, 2.5, 5.5;`, one row for each node of the first argument.
    pub rows: Vec<Row>,
    /// From brace to brace.
    pub span: Span,
}

/// `node: values;`
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The node of the first argument.
    pub node: Expr,
    /// The values there, one at least.
    pub values: Vec<Expr>,
    /// All of it.
    pub span: Span,
}
