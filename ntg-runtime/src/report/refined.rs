//! What mesh refinement did, a part of the report of its last solve.

use std::fmt;

/// One round.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// Knot intervals of all phases.
    pub intervals: usize,
    /// Variables of the nonlinear program.
    pub variables: usize,
    /// The objective as discretised, in the user's sense and unit.
    pub objective: f64,
    /// The objective finely integrated, in the user's sense and unit.
    pub fine: f64,
    /// The relative difference of the two.
    pub quadrature: f64,
    /// The relative change of the finely integrated objective since the round before; NaN in the first.
    pub change: f64,
    /// The largest relative violation on the fine grid.
    pub violation: f64,
    /// Iterations of its solve.
    pub iterations: usize,
    /// Seconds of its solve.
    pub seconds: f64,
}

/// Why refinement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefineStatus {
    /// All errors are within the tolerance.
    Met,
    /// The limit on rounds was reached.
    Rounds,
    /// The limit on variables was reached.
    Variables,
    /// `Settings::time_limit` was reached.
    Time,
    /// A round was not solved; the report is that of the last one that was, or of the first.
    NotSolved,
    /// The callback asked to stop.
    Cancelled,
    /// A finer mesh led to a point that is worse: more violated, or as little and with a worse objective. The report is
    /// that of the best round.
    Worse,
    /// No interval that would have to be split is long enough for it.
    Shortest,
}

/// What refinement did, a part of the report of its last solve.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Refined {
    /// Every round, in order.
    pub rounds: Vec<Round>,
    /// Why it ended.
    pub status: RefineStatus,
    /// The tolerance that was wanted.
    pub tolerance: f64,
}

impl Refined {
    /// Whether all errors are within the tolerance.
    pub fn is_met(&self) -> bool {
        self.status == RefineStatus::Met
    }
}

impl Round {
    /// Whether all errors are within a tolerance.
    pub(crate) fn within(&self, tolerance: f64) -> bool {
        self.is_exact(tolerance) && self.change <= tolerance
    }

    /// Whether the errors are within a tolerance that one round tells by itself.
    pub(crate) fn is_exact(&self, tolerance: f64) -> bool {
        self.quadrature <= tolerance && self.violation <= tolerance
    }
}

impl fmt::Display for RefineStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Met => "the tolerance is met",
            Self::Rounds => "the limit on rounds was reached before the tolerance was met",
            Self::Variables => "the limit on variables was reached before the tolerance was met",
            Self::Time => "the time limit was reached before the tolerance was met",
            Self::NotSolved => "a round was not solved; the solution is that of the last one that was",
            Self::Cancelled => "cancelled; the solution is that of the last round that was solved",
            Self::Worse => "finer meshes led to a worse point; the solution is that of the best round",
            Self::Shortest => "what would have to be split is too short for it; the tolerance is not met",
        })
    }
}

impl fmt::Display for Refined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  refinement to {:.0e}: {}", self.tolerance, self.status)?;
        let heads = ["round", "intervals", "variables", "objective", "quadrature", "change", "violation", "iterations"];
        let [round, intervals, variables, objective, quadrature, change, violation, iterations] = heads;
        write!(f, "    {round:>5} {intervals:>9} {variables:>9} {objective:>18} ")?;
        write!(f, "{quadrature:>10} {change:>9} {violation:>9} {iterations:>10}")?;
        for (number, round) in self.rounds.iter().enumerate() {
            let Round { intervals, variables, objective, iterations, .. } = round;
            let change = if round.change.is_nan() { String::new() } else { format!("{:.1e}", round.change) };
            write!(f, "\n    {:>5} {intervals:>9} {variables:>9} {objective:>18.10} ", number + 1)?;
            write!(f, "{:>10.1e} {change:>9} {:>9.1e} {iterations:>10}", round.quadrature, round.violation)?;
        }
        Ok(())
    }
}
