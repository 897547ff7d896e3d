//! Why a solve ended, by indices. Names and advice are the caller's.

use crate::contract::NotFinite;
use std::fmt;

/// What a bound belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounded {
    /// The constraint row with this index.
    Row(usize),
    /// The variable with this index.
    Variable(usize),
}

/// A bound that is not met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// The row or variable.
    pub of: Bounded,
    /// Its value at the returned point.
    pub value: f64,
    /// The bound that is missed.
    pub bound: f64,
    /// By how much, positive, in the program's own units.
    pub violation: f64,
}

/// Bounds between which no number lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The row or variable.
    pub of: Bounded,
    /// The lower bound.
    pub lower: f64,
    /// The upper bound, which is smaller, or either is not a number.
    pub upper: f64,
}

/// Why a solve ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// All residuals are within their tolerances: a local minimum to first order.
    Solved,
    /// The solve could not go on, and all residuals are within 1e-6 though not within
    /// their tolerances.
    Acceptable,
    /// The point minimises the violation of the constraints locally, and some stay violated.
    Infeasible {
        /// What remains violated, the worst (by scale) first.
        rows: Vec<Violation>,
    },
    /// `Options::max_iterations` was reached.
    IterationLimit,
    /// `Options::time_limit` was reached.
    TimeLimit,
    /// The callback asked to stop.
    Cancelled,
    /// No acceptable step could be found, although the tolerances are not met.
    StepTooSmall,
    /// The objective falls without limit.
    Unbounded,
    /// A function is not finite at the start, or everywhere around a point.
    NotFinite {
        /// The number that is not finite.
        what: NotFinite,
        /// The point of that evaluation, in the program's own units.
        x: Vec<f64>,
    },
    /// Lower bounds exceed upper bounds; found before any iteration.
    Contradiction {
        /// Every pair that crosses.
        bounds: Vec<Crossing>,
    },
    /// The quadratic subproblems could not be solved, not even in elastic mode.
    SubproblemFailed,
}

impl Status {
    /// Whether a solution was found.
    pub fn is_solved(&self) -> bool {
        matches!(self, Self::Solved)
    }

    /// Whether there is a solution: solved or acceptable.
    pub fn has_solution(&self) -> bool {
        matches!(self, Self::Solved | Self::Acceptable)
    }

    /// Whether another method could do no better.
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Solved | Self::Acceptable | Self::Cancelled | Self::TimeLimit | Self::Contradiction { .. })
    }
}

impl fmt::Display for Bounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Row(row) => write!(f, "row {row}"),
            Self::Variable(variable) => write!(f, "variable {variable}"),
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Solved => f.write_str("solved"),
            Self::Acceptable => f.write_str("acceptable: optimal to 1e-6, not to the tolerances"),
            Self::Infeasible { rows } => {
                f.write_str("infeasible: no nearby point meets all constraints")?;
                rows.first().map_or(Ok(()), |worst| {
                    let Violation { of, bound, violation, .. } = worst;
                    write!(
                        f,
                        "; of {} violated, {of} misses its bound {bound:.6e} most, by {violation:.3e}",
                        rows.len()
                    )
                })
            }
            Self::IterationLimit => f.write_str("the iteration limit was reached"),
            Self::TimeLimit => f.write_str("the time limit was reached"),
            Self::Cancelled => f.write_str("cancelled"),
            Self::StepTooSmall => f.write_str("no further progress: every acceptable step is too small"),
            Self::Unbounded => f.write_str("unbounded: the objective falls without limit"),
            Self::NotFinite { what, .. } => write!(f, "not finite: {what}"),
            Self::Contradiction { bounds } => {
                f.write_str("contradictory bounds")?;
                bounds.iter().try_for_each(|Crossing { of, lower, upper }| {
                    write!(f, "; {of} must lie between {lower:.6e} and {upper:.6e}")
                })
            }
            Self::SubproblemFailed => f.write_str("a quadratic subproblem could not be solved"),
        }
    }
}
