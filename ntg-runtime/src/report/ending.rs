//! How a solve ended, as the heads of texts, pages and files say it: what is missed between the points is no good end.

use super::Report;

/// The status of a solution, and how much of it holds between the points of the transcription. `between` is the largest
/// relative violation there, `missed` whether anything is worth a warning.
///
/// Whoever misses an equation by more than its largest term holds it nowhere but at the points.
pub fn ending(status: &str, between: f64, missed: bool) -> String {
    match (between > 1.0, missed) {
        (true, _) => format!("{status} at the points, and not between them"),
        (false, true) => format!("{status} at the points"),
        (false, false) => status.to_owned(),
    }
}

impl Report {
    /// The status in a word or in words; of a solution also whether it holds between the points.
    pub fn ending(&self) -> String {
        let missed = !self.violated_between().is_empty() || self.cost_is_off().is_some();
        let status = self.status.label();
        if self.has_solution() { ending(&status, self.violation.between, missed) } else { status }
    }
}

#[cfg(test)]
mod tests {
    use super::ending;

    #[test]
    fn a_head_says_what_does_not_hold_between_the_points() {
        assert_eq!(ending("solved", 1e-6, false), "solved");
        assert_eq!(ending("solved", 0.1, true), "solved at the points");
        assert_eq!(ending("acceptable", 2.0, true), "acceptable at the points, and not between them");
    }
}
