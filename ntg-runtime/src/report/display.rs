//! A report as a person reads it.

use super::{ConstraintReport, Report};
use crate::transcribe::names::brief;
use ntg_structure::Unit;
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
        for time in self.solution.event_times().iter().filter(|(name, _)| !name.contains('(')) {
            write!(f, "\n  {:<11} {} s", time.0, brief(time.1))?;
        }
        for variable in self.solution.variables() {
            write!(f, "\n  {:<11} {}{}", variable.name, brief(variable.value), symbol(&variable.unit))?;
        }
        self.singular.iter().try_for_each(|singular| write!(f, "\n  warning: {singular}"))?;
        self.constraints.iter().try_for_each(|constraint| violated(f, constraint))
    }
}

/// A line for a constraint that is violated noticeably.
fn violated(f: &mut fmt::Formatter<'_>, constraint: &ConstraintReport) -> fmt::Result {
    for (worst, where_) in [(&constraint.points, "at a point"), (&constraint.between, "between points")] {
        let Some(worst) = worst.as_ref().filter(|w| w.relative > NEGLIGIBLE || w.relative.is_nan()) else { continue };
        let unit = symbol(&constraint.unit);
        write!(f, "\n  `{}` is missed by {}{unit} {where_}", constraint.name, brief(worst.violation))?;
        if let Some(time) = worst.time {
            write!(f, ", t = {} s", brief(time))?;
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
