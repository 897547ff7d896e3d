//! Why a solve ended, in data and in words.

pub use ntg_nlp::residuals::{Residual, Residuals};
pub use ntg_nlp::status::Bounded;

use crate::digits::{apart, brief_in};
use ntg_structure::{Place, Unit};
use std::fmt;

/// A bound that is not met.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The row or variable.
    pub of: Bounded,
    /// Its name in the user's words.
    pub name: String,
    /// Its value at the returned point.
    pub value: f64,
    /// The bound that is missed.
    pub bound: f64,
    /// By how much, positive, in the program's own units.
    pub violation: f64,
    /// The unit of the spec in which messages show the three.
    pub unit: Unit,
}

/// Bounds between which no number lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The row or variable.
    pub of: Bounded,
    /// Its name in the user's words.
    pub name: String,
    /// The lower bound.
    pub lower: f64,
    /// The upper bound, which is smaller, or either is not a number.
    pub upper: f64,
    /// The unit of the spec in which messages show both.
    pub unit: Unit,
}

/// A value that is not finite: what, where, and at which point.
#[derive(Clone, Debug, PartialEq)]
pub struct NotFinite {
    /// The constraint, cost term or subexpression that failed.
    pub place: Place,
    /// The value: `NaN` or `inf`.
    pub value: f64,
    /// Where along the trajectory, in words: "phase covert, t = 12.5 s (tau = 0.25)".
    pub point: String,
}

/// Why a solve ended.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         trajectory { slow: der(x) <= 0.3 [m/s]; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let solution = Move::default().solve(&Settings::default())?;
/// // The mean speed is half a metre a second, so the limit cannot be kept.
/// match solution.status() {
///     Status::Infeasible { rows } => println!("{} is missed by {}", rows[0].name, rows[0].violation),
///     other => panic!("{other}: {}", other.advice()),
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// All residuals are within their tolerances: a local minimum to first order.
    Solved,
    /// The solve could not go on, and all residuals are within 1e-6 though not within their tolerances: in most cases
    /// the solution to five or six digits.
    Acceptable,
    /// A stationary point within the tolerances that is no minimum: beside it the objective is better, and the solve could not get
    /// away from it (docs/maths.md, section 11.13).
    Stationary,
    /// All residuals are within their tolerances, but constraints are violated between the points of the transcription
    /// by more than `Settings::between_tolerance`, which [`Between::Refuse`](crate::settings::Between) does not allow.
    ViolatedBetween {
        /// The constraints, the worst first, in words with time and amount.
        constraints: Vec<String>,
    },
    /// The point minimises the violation of the constraints locally, and some stay violated.
    Infeasible {
        /// What remains violated, the worst (by scale) first.
        rows: Vec<Violation>,
    },
    /// `Settings::max_iterations` was reached.
    IterationLimit,
    /// `Settings::time_limit` was reached.
    TimeLimit,
    /// The callback asked to stop.
    Cancelled,
    /// No acceptable step could be found, although the tolerances are not met.
    StepTooSmall,
    /// The objective falls without limit.
    Unbounded,
    /// A function is not finite at the start, or everywhere around a point.
    NotFinite(NotFinite),
    /// Lower bounds exceed upper bounds; found before any iteration.
    Contradiction {
        /// Every pair that crosses.
        bounds: Vec<Crossing>,
    },
    /// The quadratic subproblems could not be solved, not even in elastic mode.
    SubproblemFailed,
}

impl Status {
    /// Whether a solution was found within the tolerances.
    pub fn is_solved(&self) -> bool {
        matches!(self, Self::Solved)
    }

    /// Whether a solution was found within 1e-6, though not within the tolerances.
    pub fn is_acceptable(&self) -> bool {
        matches!(self, Self::Acceptable)
    }

    /// Whether there is a solution: solved, acceptable, or at least stationary.
    pub fn has_solution(&self) -> bool {
        matches!(self, Self::Solved | Self::Acceptable | Self::Stationary)
    }

    /// One word for a solution, `solved`, `acceptable` or `stationary`; else why there is none, in words.
    pub fn label(&self) -> String {
        match self {
            Self::Acceptable => "acceptable".into(),
            Self::Stationary => "stationary".into(),
            other => other.to_string(),
        }
    }

    /// What a person may try next; empty when solved. A name in backticks is that of a field of
    /// [`Settings`](crate::settings::Settings), for which a front end may write its own word.
    pub fn advice(&self) -> &'static str {
        match self {
            Self::Solved => "",
            Self::Acceptable => {
                "Compare the residuals with what you need; for more digits give typical sizes (`scales`), or remove \
                 constraints that say the same thing twice."
            }
            Self::Stationary => {
                "Give a guess that does not lie in the symmetry of the problem, or try several starts (`starts`)."
            }
            Self::ViolatedBetween { .. } => {
                "Use more points or intervals, or let the mesh be refined (`between`, `refine`)."
            }
            Self::Infeasible { .. } => {
                "Relax one of the named constraints, or start from another guess: the constraints may \
                 contradict each other only near this one."
            }
            Self::IterationLimit => {
                "Allow more iterations (`max_iterations`), give a better guess, or reach the problem by a continuation from an easier one."
            }
            Self::TimeLimit => "Allow more time (`time_limit`), give a better guess, or use fewer intervals first.",
            Self::Cancelled => "Start again from the returned point to go on.",
            Self::StepTooSmall => {
                "Look for badly scaled quantities and give typical sizes (`scales`), or start from another guess."
            }
            Self::Unbounded => "Bound the variables, or check the sign of the objective (minimize or maximize).",
            Self::NotFinite(_) => {
                "Start from a guess at which the named expression is defined, or bound its arguments away from where \
                 it is not."
            }
            Self::Contradiction { .. } => "Correct the bounds: the lower one must not exceed the upper one.",
            Self::SubproblemFailed => {
                "Give typical sizes (`scales`), remove constraints that say the same thing twice, or start from \
                 another guess."
            }
        }
    }
}

/// How many names a sentence lists before it says "and n more".
const LISTED: usize = 3;

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Solved => f.write_str("solved"),
            Self::Acceptable => f.write_str("acceptable: optimal to 1e-6, not to the tolerances"),
            Self::Stationary => f.write_str("stationary: this is no minimum, beside it the objective is better"),
            Self::ViolatedBetween { constraints } => {
                f.write_str("not a solution between the points")?;
                list(f, constraints, |f, constraint| f.write_str(constraint))
            }
            Self::Infeasible { rows } => {
                f.write_str("infeasible: no nearby point meets all constraints")?;
                list(f, rows, |f, row| {
                    let (bound, by) = (brief_in(row.bound, &row.unit), brief_in(row.violation, &row.unit));
                    write!(f, "{} misses its bound {bound} by {by}", row.name)
                })
            }
            Self::IterationLimit => f.write_str("the iteration limit was reached"),
            Self::TimeLimit => f.write_str("the time limit was reached"),
            Self::Cancelled => f.write_str("cancelled"),
            Self::StepTooSmall => f.write_str("no further progress: every acceptable step is too small"),
            Self::Unbounded => f.write_str("unbounded: the objective falls without limit"),
            Self::NotFinite(what) => write!(f, "not finite: {what}"),
            Self::Contradiction { bounds } => {
                f.write_str("contradictory bounds")?;
                list(f, bounds, |f, c| {
                    let (lower, upper) = apart(c.lower, c.upper, &c.unit);
                    write!(f, "{} must lie between {lower} and {upper}", c.name)
                })
            }
            Self::SubproblemFailed => f.write_str("a quadratic subproblem could not be solved"),
        }
    }
}

/// Writes ": a; b; c; and 7 more".
fn list<T>(
    f: &mut fmt::Formatter<'_>,
    items: &[T],
    one: impl Fn(&mut fmt::Formatter<'_>, &T) -> fmt::Result,
) -> fmt::Result {
    for (i, item) in items.iter().take(LISTED).enumerate() {
        f.write_str(if i == 0 { ": " } else { "; " })?;
        one(f, item)?;
    }
    match items.len().saturating_sub(LISTED) {
        0 => Ok(()),
        more => write!(f, "; and {more} more"),
    }
}

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, value, point } = self;
        write!(f, "`{}` is {value}", place.text)?;
        if place.line > 0 {
            write!(f, " (line {}, column {})", place.line, place.column)?;
        }
        if point.is_empty() { Ok(()) } else { write!(f, " at {point}") }
    }
}
