//! What mesh refinement did, a part of the report of its last solve.

use std::fmt;

use crate::digits::decimals;

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

impl Refined {
    /// What the rounds are told by: columns of the same length, each with its head first.
    pub fn columns(&self) -> Vec<Vec<String>> {
        type Cell = fn(usize, &Round) -> String;
        let columns: [(&str, Cell); 8] = [
            ("round", |number, _| (number + 1).to_string()),
            ("intervals", |_, round| round.intervals.to_string()),
            ("variables", |_, round| round.variables.to_string()),
            ("objective", |_, round| decimals(round.objective, 10)),
            ("quadrature", |_, round| format!("{:.1e}", round.quadrature)),
            ("change", |_, round| if round.change.is_nan() { String::new() } else { format!("{:.1e}", round.change) }),
            ("violation", |_, round| format!("{:.1e}", round.violation)),
            ("iterations", |_, round| round.iterations.to_string()),
        ];
        let cells = |of: Cell| self.rounds.iter().enumerate().map(move |(number, round)| of(number, round));
        columns.into_iter().map(|(head, of)| std::iter::once(head.to_owned()).chain(cells(of)).collect()).collect()
    }

    /// What came of it, in one line.
    pub fn headline(&self) -> String {
        format!("  refinement to {:.0e}: {}", self.tolerance, self.status)
    }
}

impl fmt::Display for Refined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.headline())?;
        let columns = self.columns();
        let width = |column: &[String]| column.iter().map(String::len).max().unwrap_or(0);
        for row in 0..=self.rounds.len() {
            f.write_str("\n   ")?;
            columns.iter().try_for_each(|column| write!(f, " {:>w$}", column[row], w = width(column)))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{RefineStatus, Refined, Round};

    #[test]
    fn rounds_stand_in_columns_as_wide_as_what_is_in_them() {
        let round = |variables, objective: f64, change| Round {
            intervals: 8,
            variables,
            objective,
            fine: objective,
            quadrature: 1e-4,
            change,
            violation: 2e-9,
            iterations: 7,
            seconds: 0.0,
        };
        let rounds = vec![round(75, 1.5, f64::NAN), round(1500, -1234.5, 1e-3)];
        let refined = Refined { rounds, status: RefineStatus::Met, tolerance: 1e-6 };
        let expected = [
            "  refinement to 1e-6: the tolerance is met",
            "    round intervals variables        objective quadrature change violation iterations",
            "        1         8        75     1.5000000000     1.0e-4           2.0e-9          7",
            "        2         8      1500 -1234.5000000000     1.0e-4 1.0e-3    2.0e-9          7",
        ];
        assert_eq!(refined.to_string(), expected.join("\n"));
        assert!(refined.columns().iter().all(|column| column.len() == 3));
    }
}
