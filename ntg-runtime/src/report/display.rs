//! A report as a person reads it.

use super::{ConstraintReport, Estimate, Report, Resolution, Warning, Worst};
use crate::digits::{brief, decimals};
use crate::transcribe::rows::member_words;
use ntg_structure::{Independent, Unit};
use std::fmt;

/// Relative violations below this are not worth a line.
const NEGLIGIBLE: f64 = 1e-6;
/// Most lines of constraints that are missed.
const LISTED: usize = 8;
/// Most lines of phases and agents.
const MOST_PHASES: usize = 21;
/// How wide the labels `objective`, `violation` are, and names among them at least.
const LEAST_LABEL: usize = 11;
/// How wide names of terms and of measurements are at least.
const LEAST_TERM: usize = 24;
/// Longer names, such as a whole formula, make no column.
const MOST_NAME: usize = 48;

/// Digits of an objective behind the point.
const DECIMALS: usize = 9;

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
        let (objective, fine) = (decimals(self.objective, DECIMALS), decimals(self.objective_fine, DECIMALS));
        writeln!(f, "  objective   {objective}{unit}  (finely integrated: {fine}{unit})")?;
        if self.terms.len() > 1 {
            let width = width(self.terms.iter().map(|term| term.name.as_str()), LEAST_TERM);
            for term in &self.terms {
                writeln!(f, "    {:<width$} {}{}", term.name, brief(term.value), symbol(&term.unit))?;
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
            && self.objective_correction.is_finite()
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
        let (events, variables) = (self.solution.event_times(), self.solution.variables());
        let named = || events.iter().filter(|(name, _)| !name.contains('('));
        let names = named().map(|(name, _)| name.as_str()).chain(variables.iter().map(|own| own.name.as_str()));
        let width = width(names, LEAST_LABEL);
        for (name, time) in named() {
            write!(f, "\n  {name:<width$} {}", independent.amount(*time, brief))?;
        }
        let deviations = self.estimate.as_ref().map_or(&[][..], |estimate| &estimate.deviations);
        for (k, variable) in variables.into_iter().enumerate() {
            let deviation = deviations.get(k).map_or(String::new(), |own| format!(" +- {}", brief(own.sigma)));
            let (name, value, unit) = (&variable.name, brief(variable.value), symbol(&variable.unit));
            write!(f, "\n  {name:<width$} {value}{deviation}{unit}")?;
        }
        phases(f, &events, independent)?;
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

/// When each phase and each agent begins and ends, and how long it lasts; nothing where the whole is all there is.
fn phases(f: &mut fmt::Formatter<'_>, events: &[(String, f64)], independent: &Independent) -> fmt::Result {
    let of = |word: &str, name: &str| {
        let found = events.iter().find(|(own, _)| *own == format!("{word}({name})"))?;
        Some(independent.amount(found.1, brief))
    };
    let names: Vec<&str> =
        events.iter().filter_map(|(name, _)| name.strip_prefix("duration(")?.strip_suffix(')')).collect();
    for name in names.iter().take(MOST_PHASES) {
        if let (Some(start), Some(end), Some(duration)) = (of("start", name), of("end", name), of("duration", name)) {
            write!(f, "\n  {name}: from {start} to {end}, for {duration}")?;
        }
    }
    match names.len().saturating_sub(MOST_PHASES) {
        0 => Ok(()),
        more => write!(f, "\n  and {more} more"),
    }
}

/// How wide a column of names is: as the longest that is not out of all measure, which stick out.
fn width<'n>(names: impl Iterator<Item = &'n str>, least: usize) -> usize {
    names.map(|name| name.chars().count()).filter(|length| *length <= MOST_NAME).fold(least, usize::max)
}

/// How well the measurements are met: all together, then each statement.
fn estimated(f: &mut fmt::Formatter<'_>, estimate: &Estimate) -> fmt::Result {
    write!(f, "\n  chi^2       {} of {} measured numbers", brief(estimate.chi2), estimate.count)?;
    let width = width(estimate.measurements.iter().map(|measurement| measurement.name.as_str()), LEAST_TERM);
    for measurement in &estimate.measurements {
        let count = measurement.residuals.len();
        let mean = (measurement.chi2 / count.max(1) as f64).sqrt();
        let worst = measurement.residuals.iter().max_by(|a, b| a.ratio.abs().total_cmp(&b.ratio.abs()));
        let share = 100.0 * measurement.share;
        write!(f, "\n    {:<width$} {share:.0} %, {count} of {} sigma in the mean", measurement.name, brief(mean))?;
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

fn symbol(unit: &Unit) -> String {
    if unit.symbol.is_empty() { String::new() } else { format!(" {}", unit.symbol) }
}

#[cfg(test)]
mod tests {
    use super::{LEAST_LABEL, width};

    #[test]
    fn columns_are_as_wide_as_their_longest_name_but_formulas() {
        let formula = "minimize 1e-6 [s^6] * sum(i in 1 .. n, integral(der(q[i], 3)^2))";
        assert_eq!(width(["T", formula].into_iter(), LEAST_LABEL), LEAST_LABEL);
        assert_eq!(width(["T", "radius_of_the_crater"].into_iter(), LEAST_LABEL), 20);
        assert_eq!(width(["größe_der_störung"].into_iter(), LEAST_LABEL), 17);
    }
}
