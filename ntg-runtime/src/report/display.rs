//! A report as a person reads it.

use super::{ConstraintReport, Estimate, Report, Warning};
use crate::digits::brief;
use crate::transcribe::rows::member_words;
use ntg_structure::{Independent, Unit};
use std::fmt;

/// Relative violations below this are not worth a line.
const NEGLIGIBLE: f64 = 1e-6;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = if self.problem.is_empty() { "the problem" } else { &self.problem };
        writeln!(f, "{name}: {}", self.status)?;
        if !self.advice.is_empty() {
            writeln!(f, "  try: {}", self.advice)?;
        }
        let unit = symbol(&self.objective_unit);
        writeln!(
            f,
            "  objective   {:.9}{unit}  (finely integrated: {:.9}{unit})",
            self.objective, self.objective_fine
        )?;
        if self.terms.len() > 1 {
            for term in &self.terms {
                writeln!(f, "    {:<24} {}{}", term.name, brief(term.value), symbol(&term.unit))?;
            }
        }
        let steps = match self.history.len() {
            0 | 1 => String::new(),
            steps => format!(" over {steps} steps of the continuation"),
        };
        writeln!(f, "  iterations  {}{steps}, {:.3} ms", self.iterations, 1e3 * self.seconds)?;
        let (points, between) = (self.violation.points, self.violation.between);
        write!(f, "  violation   {points:.1e} at the points, {between:.1e} between them (relative)")?;
        if let Some(refined) = &self.refined {
            write!(f, "\n{refined}")?;
        }
        let independent = &self.solution.structure().independent;
        for time in self.solution.event_times().iter().filter(|(name, _)| !name.contains('(')) {
            write!(f, "\n  {:<11} {}", time.0, independent.amount(time.1, brief))?;
        }
        let deviations = self.estimate.as_ref().map_or(&[][..], |estimate| &estimate.deviations);
        for (k, variable) in self.solution.variables().into_iter().enumerate() {
            if let Some(deviation) = deviations.get(k) {
                let (sigma, unit) = (brief(deviation.sigma), symbol(&variable.unit));
                write!(f, "\n  {:<11} {} +- {sigma}{unit}", variable.name, brief(variable.value))?;
                continue;
            }
            write!(f, "\n  {:<11} {}{}", variable.name, brief(variable.value), symbol(&variable.unit))?;
        }
        self.estimate.iter().try_for_each(|estimate| estimated(f, estimate))?;
        // What refinement has to say stands above.
        let is_new = |warning: &&Warning| !warning.place.text.is_empty() || !warning.constraint.is_empty();
        self.warnings().iter().filter(is_new).try_for_each(|warning| write!(f, "\n  warning: {warning}"))?;
        let told = self.violated_between();
        let is_told = |constraint: &ConstraintReport| told.iter().any(|other| std::ptr::eq(*other, constraint));
        self.constraints.iter().try_for_each(|constraint| violated(f, constraint, (is_told(constraint), independent)))
    }
}

/// How well the measurements are met: all together, then each statement.
fn estimated(f: &mut fmt::Formatter<'_>, estimate: &Estimate) -> fmt::Result {
    write!(f, "\n  chi^2       {} of {} measured numbers", brief(estimate.chi2), estimate.count)?;
    for measurement in &estimate.measurements {
        let count = measurement.residuals.len();
        let mean = (measurement.chi2 / count.max(1) as f64).sqrt();
        let worst = measurement.residuals.iter().max_by(|a, b| a.ratio.abs().total_cmp(&b.ratio.abs()));
        let share = 100.0 * measurement.share;
        write!(f, "\n    {:<24} {share:.0} %, {count} of {} sigma in the mean", measurement.name, brief(mean))?;
        if let Some(worst) = worst.filter(|_| count > 1) {
            let indices: Vec<String> = worst.indices.iter().map(i64::to_string).collect();
            write!(f, ", at most {} at [{}]", brief(worst.ratio), indices.join(", "))?;
        }
    }
    if let Some(why) = &estimate.unknown {
        write!(f, "\n    no standard deviations: {why}")?;
    }
    Ok(())
}

/// A line for a constraint that is violated noticeably; a warning has told of some what is between the points.
fn violated(
    f: &mut fmt::Formatter<'_>,
    constraint: &ConstraintReport,
    (is_told, independent): (bool, &Independent),
) -> fmt::Result {
    let between = constraint.between.as_ref().filter(|_| !is_told);
    for (worst, where_) in [(constraint.points.as_ref(), "at a point"), (between, "between points")] {
        let Some(worst) = worst.filter(|w| w.relative > NEGLIGIBLE || w.relative.is_nan()) else { continue };
        let unit = symbol(&constraint.unit);
        let member = member_words(&constraint.name, &worst.indices);
        write!(f, "\n  {member} is missed by {}{unit} {where_}", brief(worst.violation))?;
        if let Some(time) = worst.time {
            write!(f, ", {}", independent.place(time, brief))?;
        }
        if !worst.phase.is_empty() {
            write!(f, " in `{}`", worst.phase)?;
        }
    }
    Ok(())
}

fn symbol(unit: &Unit) -> String {
    if unit.symbol.is_empty() { String::new() } else { format!(" {}", unit.symbol) }
}
