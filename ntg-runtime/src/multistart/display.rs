//! Many starts as a person reads about them.

use super::{MultiReport, Origin};
use crate::digits::{brief, decimals};
use std::fmt;

/// Minima that are listed before "and n more".
const LISTED: usize = 12;
/// Reasons for failure that are listed.
const REASONS: usize = 4;

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Guess => "the guess",
            Self::Search => "a coarse search",
            Self::Route => "a random route",
            Self::Perturbed => "a perturbed guess",
            Self::Parameters => "the guess, other parameters",
        })
    }
}

impl fmt::Display for MultiReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (tried, solved) = (self.tried(), self.solved());
        let name = if self.problem.is_empty() { "the problem" } else { &self.problem };
        let minima = if self.minima.len() == 1 { "minimum" } else { "minima" };
        let found = self.minima.len();
        writeln!(f, "{name}: {solved} of {tried} starts solved, {found} local {minima}, {:.2} s", self.seconds)?;
        for note in &self.notes {
            writeln!(f, "  note: {note}")?;
        }
        if found > 0 {
            writeln!(f, "  {:>18} {:>6} {:>14}  first found from", "objective", "starts", "between points")?;
        }
        for minimum in self.minima.iter().take(LISTED) {
            let (report, origin) = (&minimum.report, self.starts[minimum.first].origin);
            let between = report.violation.between;
            let objective = decimals(report.objective, 9);
            writeln!(f, "  {objective:>18} {:>6} {between:>14.1e}  {origin}", minimum.count)?;
        }
        if found > LISTED {
            writeln!(f, "  and {} more", found - LISTED)?;
        }
        for (reason, count) in self.failures().into_iter().take(REASONS) {
            writeln!(f, "  {count:>4} not solved: {reason}")?;
        }
        let times: Vec<f64> = self.starts.iter().map(|s| s.seconds).collect();
        write!(f, "  slowest start {} s", brief(times.iter().copied().fold(0.0, f64::max)))
    }
}

impl MultiReport {
    /// Why starts were not solved, and how many each time; the most frequent reason first.
    pub fn failures(&self) -> Vec<(String, usize)> {
        let mut found: Vec<(String, usize)> = vec![];
        for start in self.starts.iter().filter(|start| start.minimum.is_none()) {
            // What stands after the colon differs from start to start.
            let reason = start.status.split(':').next().unwrap_or_default().to_owned();
            match found.iter_mut().find(|known| known.0 == reason) {
                Some(known) => known.1 += 1,
                None => found.push((reason, 1)),
            }
        }
        found.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        found
    }
}
