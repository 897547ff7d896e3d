//! What a person should know about a report although it is a solution.

use super::{ConstraintReport, RefineStatus, Report};
use crate::digits::brief;
use ntg_structure::{Independent, Place};
use std::fmt;

/// One thing to know, in words and with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// In words.
    pub message: String,
    /// The expression or constraint; the place of nothing where it concerns the whole solve.
    pub place: Place,
    /// The name of the constraint that is violated between the points; empty for other warnings.
    pub constraint: String,
    /// The mission time, in SI units; none for what belongs to no time.
    pub time: Option<f64>,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Report {
    /// What is to be known beside the status: expressions that are singular at the guess, constraints of a solution that
    /// are violated between the points by more than `Settings::between_tolerance`, the worst first, and a refinement
    /// that has not come to its tolerance.
    pub fn warnings(&self) -> Vec<Warning> {
        let singular = self.singular.iter().map(|singular| Warning {
            message: singular.to_string(),
            place: singular.place.clone(),
            constraint: String::new(),
            time: None,
        });
        let independent = &self.solution.structure().independent;
        let between = self.violated_between().into_iter().map(|constraint| violated_between(constraint, independent));
        let unmet = self.refined.iter().filter(|refined| refined.status != RefineStatus::Met).map(|refined| Warning {
            message: format!("refinement to {:.0e}: {}", refined.tolerance, refined.status),
            place: Place::default(),
            constraint: String::new(),
            time: None,
        });
        singular.chain(between).chain(unmet).collect()
    }

    /// The constraints of a solution that are violated between the points of the transcription by more than
    /// `Settings::between_tolerance`, the worst first; empty where there is no solution.
    pub fn violated_between(&self) -> Vec<&ConstraintReport> {
        if !self.meets_points() {
            return vec![];
        }
        let relative = |c: &ConstraintReport| c.between.as_ref().map_or(0.0, |worst| worst.relative);
        let is_violated = |c: &&ConstraintReport| relative(c) > self.between_tolerance || relative(c).is_nan();
        let mut found: Vec<&ConstraintReport> = self.constraints.iter().filter(is_violated).collect();
        found.sort_by(|a, b| relative(b).total_cmp(&relative(a)));
        found
    }
}

fn violated_between(constraint: &ConstraintReport, independent: &Independent) -> Warning {
    let mut message = format!("`{}` is violated between the points", constraint.name);
    let worst = constraint.between.as_ref();
    if let Some(worst) = worst {
        message += &format!(" by {}", brief(worst.violation));
        if !constraint.unit.symbol.is_empty() {
            message += &format!(" {}", constraint.unit.symbol);
        }
        message += &format!(" ({:.1e} relative)", worst.relative);
        if let Some(time) = worst.time {
            message += &format!(" at {}", independent.place(time, brief));
        }
        if !worst.phase.is_empty() {
            message += &format!(" in `{}`", worst.phase);
        }
    }
    Warning {
        message,
        place: constraint.place.clone(),
        constraint: constraint.name.clone(),
        time: worst.and_then(|worst| worst.time),
    }
}
