//! A report as a person reads it.

use super::{ConstraintReport, Estimate, Report, Resolution, Warning, Worst};
use crate::digits::brief;
use crate::transcribe::rows::member_words;
use ntg_structure::{Independent, Unit};
use std::fmt;

/// Relative violations below this are not worth a line.
const NEGLIGIBLE: f64 = 1e-6;
/// Most lines of constraints that are missed.
const LISTED: usize = 8;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = if self.problem.is_empty() { "the problem" } else { &self.problem };
        // Behind `acceptable` stands what that means.
        let words = self.status.to_string();
        writeln!(f, "{name}: {}{}", self.ending(), words.strip_prefix(&self.status.label()).unwrap_or_default())?;
        if !self.advice.is_empty() {
            writeln!(f, "  try: {}", self.advice)?;
        }
        let unit = symbol(&self.objective_unit);
        let (objective, fine) = (digits(self.objective), digits(self.objective_fine));
        writeln!(f, "  objective   {objective}{unit}  (finely integrated: {fine}{unit})")?;
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
        if self.resolution().is_some_and(|resolution| resolution != Resolution::Fine)
            && self.objective_correction != 0.0
        {
            let correction = self.objective_correction;
            writeln!(
                f,
                "  correction  {correction:+.1e}{unit} to the objective, for what equations miss between the points"
            )?;
        }
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
        let noticeable = 0.1 * self.between_tolerance;
        let missed = self.constraints.iter().filter_map(|constraint| {
            let between =
                constraint.between.as_ref().filter(|worst| !is_told(constraint) && is_above(worst, noticeable));
            let points = constraint.points.as_ref().filter(|worst| is_above(worst, NEGLIGIBLE));
            let points = points.map(|worst| (worst, "at a point"));
            let between = between.map(|worst| (worst, "between points"));
            points.or(between).map(|(worst, where_)| (constraint, worst, where_))
        });
        let mut missed: Vec<_> = missed.collect();
        missed.sort_by(|(_, a, _), (_, b, _)| b.relative.total_cmp(&a.relative));
        missed.iter().take(LISTED).try_for_each(|(constraint, worst, where_)| {
            write!(f, "\n  {}", missed_words(constraint, worst, where_, independent))
        })?;
        match missed.len().saturating_sub(LISTED) {
            0 => Ok(()),
            more => write!(f, "\n  and {more} more"),
        }
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
            write!(f, ", at most {}", brief(worst.ratio))?;
            if !indices.is_empty() {
                write!(f, " at [{}]", indices.join(", "))?;
            }
        }
    }
    if let Some(why) = &estimate.unknown {
        write!(f, "\n    no standard deviations: {why}")?;
    }
    Ok(())
}

/// Whether a relative violation is above something; one that is no number is above all.
fn is_above(worst: &Worst, relative: f64) -> bool {
    worst.relative > relative || worst.relative.is_nan()
}

/// By how much a constraint is missed, and where.
fn missed_words(constraint: &ConstraintReport, worst: &Worst, where_: &str, independent: &Independent) -> String {
    let member = member_words(&constraint.name, &worst.indices);
    let time = worst.time.map_or(String::new(), |time| format!(", {}", independent.place(time, brief)));
    let phase = if worst.phase.is_empty() { String::new() } else { format!(" in `{}`", worst.phase) };
    format!("{member} is missed by {}{} {where_}{time}{phase}", brief(worst.violation), symbol(&constraint.unit))
}

/// Nine digits behind the point, of small numbers behind the first one.
fn digits(number: f64) -> String {
    if number != 0.0 && number.abs() < 1e-3 { format!("{number:.9e}") } else { format!("{:.9}", number + 0.0) }
}

fn symbol(unit: &Unit) -> String {
    if unit.symbol.is_empty() { String::new() } else { format!(" {}", unit.symbol) }
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn small_numbers_keep_their_digits_and_zero_has_no_sign() {
        assert_eq!(digits(7.601_260_400_1), "7.601260400");
        assert_eq!(digits(-3.764_163_6e-5), "-3.764163600e-5");
        assert_eq!(digits(-0.0), "0.000000000");
    }
}
