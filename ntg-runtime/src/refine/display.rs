//! Refinement as a person reads about it.

use super::{RefineStatus, Refined, Round};
use std::fmt;

impl fmt::Display for RefineStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Met => "the tolerance is met",
            Self::Rounds => "the limit on rounds was reached before the tolerance was met",
            Self::Variables => "the limit on variables was reached before the tolerance was met",
            Self::Time => "the time limit was reached before the tolerance was met",
            Self::NotSolved => "a round was not solved; the solution is that of the last one that was",
            Self::Cancelled => "cancelled; the solution is that of the last round that was solved",
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
