//! Parameters, tables, variables, agents, phases, outputs.

use crate::{Call, Family, Grid, Instant, Place, Unit};

/// A value that a program may change without recompiling.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is set and shown.
    pub unit: Unit,
    /// `true` for an array (indexed from 1), even of one member.
    pub array: bool,
    /// The indices of a matrix, whose elements are the members row by row.
    pub grid: Option<Grid>,
    /// Its value in SI units, one number or the members of the array: the spec's default, or
    /// what the program has set.
    pub value: Vec<f64>,
}

impl Parameter {
    /// The members of an array as a family, counted from 1.
    pub fn family(&self) -> Option<Family> {
        let last = i64::try_from(self.value.len()).unwrap_or(i64::MAX);
        self.array.then(|| Family { grid: self.grid, ..Family::of(1, last) })
    }

    /// How many members there are by each index: none for a number, rows and columns of a matrix.
    pub fn shape(&self) -> Vec<usize> {
        let columns = self.grid.and_then(|grid| usize::try_from(grid.columns).ok()).filter(|columns| *columns > 0);
        match (self.array, columns) {
            (false, _) => vec![],
            (true, None) => vec![self.value.len()],
            (true, Some(columns)) => vec![self.value.len() / columns, columns],
        }
    }

    /// What one of its numbers, counted from 0, is called: `v_max`, `start[2]`, of a matrix `A[2, 1]`.
    pub fn element(&self, member: usize) -> String {
        let index =
            self.family().map(|family| family.index(i64::try_from(member).unwrap_or(i64::MAX).saturating_add(1)));
        format!("{}{}", self.name, index.unwrap_or_default())
    }
}

/// How an axis of a table goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TableSymmetry {
    /// It ends at its first and last nodes.
    Plain,
    /// It is mirrored at 0.
    Even,
    /// It is closed: the last node is the first again.
    Periodic,
}

/// One argument of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableAxis {
    /// Its name.
    pub name: String,
    /// The unit in which its nodes are shown.
    pub unit: Unit,
    /// Nodes in SI units, increasing.
    pub nodes: Vec<f64>,
    /// How it goes on.
    pub symmetry: TableSymmetry,
}

/// How a table is interpolated (docs/maths.md, section 7).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum TableMethod {
    /// Shape-preserving cubic.
    Monotone,
    /// Tensor-product spline through the nodes.
    Bspline {
        /// Order of the spline.
        order: usize,
    },
    /// Tensor-product spline by least squares.
    Fit {
        /// Order of the spline.
        order: usize,
        /// Knot intervals of each argument.
        intervals: Vec<usize>,
    },
    /// Piecewise (multi)linear.
    Linear,
}

/// What a table is outside its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TableExtrapolation {
    /// It keeps its end value.
    Clamp,
    /// It goes on with its end slope.
    Linear,
}

/// Data that is interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// Its arguments.
    pub axes: Vec<TableAxis>,
    /// The unit in which its values are shown.
    pub unit: Unit,
    /// Values at the nodes in SI units; the last axis runs fastest.
    pub values: Vec<f64>,
    /// How it is interpolated.
    pub method: TableMethod,
    /// What it is outside its nodes.
    pub extrapolation: TableExtrapolation,
    /// `true` for `param table`: a program may replace nodes and values.
    pub replaceable: bool,
}

/// Bounds that depend on parameters and indices alone.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Bounds {
    /// Computes them; none when there are none.
    pub call: Option<Call>,
    /// Row of the lower bound; none: minus infinity.
    pub lower: Option<usize>,
    /// Row of the upper bound; none: infinity.
    pub upper: Option<usize>,
}

/// A free number, constant in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its members, when it is an array.
    pub family: Option<Family>,
    /// Its bounds; the family's index is index 0 of the call.
    pub bounds: Bounds,
    /// Where it stands.
    pub place: Place,
}

impl Variable {
    /// Whether the compiler made it, to stand for a corner of the objective (docs/maths.md, section 18).
    pub fn is_helper(&self) -> bool {
        crate::is_helper(&self.name)
    }
}

/// When an agent starts.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// At a fixed time; the call has one row, in seconds. None: 0.
    Fixed(Option<Call>),
    /// At a free time within bounds.
    Free(Bounds),
}

/// An independent timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Agent {
    /// Its name; none for the one agent of a problem that declares none.
    pub name: Option<String>,
    /// Its members, when it is a family; their index is index 0 of its calls.
    pub family: Option<Family>,
    /// When it starts.
    pub start: Start,
    /// The name of its whole duration, if it has one.
    pub duration_name: Option<String>,
    /// Where it stands.
    pub place: Place,
}

/// How long a phase lasts.
#[derive(Clone, Debug, PartialEq)]
pub enum Duration {
    /// A fixed time; the call has one row, in seconds.
    Fixed(Call),
    /// A free time within bounds, in seconds.
    Free(Bounds),
}

/// An array of outputs whose members are the same up to some time: scenarios that share an input.
///
/// The array has `until.len()` elements for each scenario, those of one scenario side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// Index into `Structure::phases`.
    pub phase: usize,
    /// Index into `Phase::outputs`.
    pub output: usize,
    /// For each element of a scenario the scaled time up to which it is that of the first scenario: a breakpoint of
    /// its spline; 0 for an element that is not shared, 1 for one that is all the way.
    pub until: Vec<f64>,
}

/// A spline's order and knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Order: the polynomial degree and one more.
    pub order: usize,
    /// Continuity conditions at each interior breakpoint.
    pub smoothness: usize,
    /// Breakpoints in scaled time, from 0 to 1.
    pub breakpoints: Vec<f64>,
}

/// A flat output in one phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Its name; the same name in another phase of the agent is the same output.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its members, when it is an array.
    pub family: Option<Family>,
    /// How many elements each of its vectors has: all members of an array that is declared by its size, `r[3]`, the columns
    /// of a matrix, `r[1 .. n, 1 .. 3]`, whose members go row by row. None for numbers and for families of numbers.
    pub vector: Option<usize>,
    /// Its spline.
    pub spline: Spline,
}

impl Output {
    /// Whether the compiler made it, to stand for a corner of the objective (docs/maths.md, section 18).
    pub fn is_helper(&self) -> bool {
        crate::is_helper(&self.name)
    }
}

/// A set of points in a phase's scaled time (docs/maths.md, section 4).
/// Intervals are those of the union of all outputs' breakpoints.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Points {
    /// Gauss-Legendre points in every interval, with their weights.
    Gauss {
        /// Points in an interval.
        points: usize,
    },
    /// Equally spaced points with both ends, with the trapezoid rule's weights.
    /// The value is the one from the right, at the end the one from the left.
    Uniform {
        /// How many points.
        points: usize,
    },
    /// Start of every interval (from the right) and the phase's end (from the left), no weights.
    Breakpoints,
    /// End of every interval but the last, from the left, no weights.
    LeftLimits,
    /// Given times, from the right and the phase's end from the left, no weights.
    Times {
        /// Scaled times, rising.
        times: Vec<Instant>,
    },
}

/// A stretch of an agent's time with its own splines.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its name; none for the one phase of an agent that declares none.
    pub name: Option<String>,
    /// Which agent, as an index into `Structure::agents`.
    pub agent: usize,
    /// Its members, when it is a family: consecutive stretches. Their index follows the agent's.
    pub family: Option<Family>,
    /// The phase (family) it follows; none at the agent's start.
    pub after: Option<usize>,
    /// How long it lasts; for a family, each member.
    pub duration: Duration,
    /// The name of the duration, as in `duration T = 5;`.
    pub duration_name: Option<String>,
    /// The outputs with their splines in this phase.
    pub outputs: Vec<Output>,
    /// The point sets its groups use.
    pub points: Vec<Points>,
    /// Where it stands.
    pub place: Place,
}
