//! `final(x)`, `max(speed)`, `T`: what is wanted of every row beside the usual.

use ntg_runtime::problem::Problem;
use ntg_runtime::report::Report;
use ntg_runtime::structure::Structure;

/// Samples of a quantity for its least and greatest value.
const SAMPLES: usize = 401;

/// A wanted value.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// As it was written: the column's name.
    pub text: String,
    kind: Kind,
    name: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A number: a named one, a time, or a variable.
    Number,
    Initial,
    Final,
    Least,
    Greatest,
    /// The largest violation of a constraint between its points, in its unit.
    Violation,
    /// `dJ*/d(bound)` of a constraint, its bound moved everywhere.
    Sensitivity,
}

impl Wanted {
    /// Reads a wanted value and looks its name up in a problem.
    ///
    /// # Errors
    /// In words: an unknown form or name, with what there is.
    pub fn parse(text: &str, structure: &Structure) -> Result<Self, String> {
        let text = text.trim();
        let (kind, name) = match text.strip_suffix(')').and_then(|rest| rest.split_once('(')) {
            Some(("initial", name)) => (Kind::Initial, name),
            Some(("final", name)) => (Kind::Final, name),
            Some(("min", name)) => (Kind::Least, name),
            Some(("max", name)) => (Kind::Greatest, name),
            Some(("violation", name)) => (Kind::Violation, name),
            Some(("sensitivity", name)) => (Kind::Sensitivity, name),
            _ => (Kind::Number, text),
        };
        let value = Self { text: text.to_owned(), kind, name: name.trim().to_owned() };
        let known = value.known(structure);
        let base = |name: &str| {
            let last = name.rsplit('.').next().unwrap_or(name).to_owned();
            last.split('[').next().unwrap_or(&last).to_owned()
        };
        let event = kind == Kind::Number && text.contains('(');
        let found = known.iter().any(|known| *known == value.name || base(known) == base(&value.name));
        if found || (event && ["start(", "end(", "duration("].iter().any(|word| text.starts_with(word))) {
            return Ok(value);
        }
        Err(format!(
            "`{text}`: write initial(NAME), final(NAME), min(NAME), max(NAME), violation(CONSTRAINT), \
             sensitivity(CONSTRAINT) or the name of a number; `{}` is none of: `{}`",
            value.name,
            known.join("`, `")
        ))
    }

    /// The names that may stand in this form.
    fn known(&self, structure: &Structure) -> Vec<String> {
        let names: Vec<String> = match self.kind {
            Kind::Violation | Kind::Sensitivity => {
                let constraints = structure.constraints.iter();
                constraints.map(|c| c.name.clone().unwrap_or_else(|| c.place.text.clone())).collect()
            }
            Kind::Number => {
                let named = structure.named.iter().map(|named| &named.name);
                let durations = structure.phases.iter().flat_map(|phase| &phase.duration_name);
                let whole = structure.agents.iter().flat_map(|agent| &agent.duration_name);
                let variables =
                    structure.variables.iter().filter(|variable| !variable.is_helper()).map(|variable| &variable.name);
                named.chain(durations).chain(whole).chain(variables).cloned().collect()
            }
            _ => {
                let outputs = structure.phases.iter().flat_map(|phase| &phase.outputs);
                let outputs = outputs.filter(|output| !output.is_helper()).map(|output| &output.name);
                outputs.chain(structure.named.iter().map(|named| &named.name)).cloned().collect()
            }
        };
        let mut once: Vec<String> = vec![];
        for name in names {
            if !once.contains(&name) {
                once.push(name);
            }
        }
        once
    }

    /// The value in one solution, in its declared unit; NaN where the solution does not have it.
    pub fn of(&self, problem: &dyn Problem, report: &Report) -> f64 {
        let solution = &report.solution;
        let constraint = || report.constraint(&self.name);
        let found = match self.kind {
            Kind::Number => solution
                .variable(&self.name)
                .or_else(|| solution.time(&self.name))
                .or_else(|| solution.signal(problem, &self.name).map(|signal| signal.at(0.0))),
            Kind::Violation => constraint().and_then(|c| c.between.as_ref().or(c.points.as_ref())).map(|w| w.violation),
            Kind::Sensitivity => constraint().map(|c| c.sensitivity),
            Kind::Initial | Kind::Final | Kind::Least | Kind::Greatest => self.over_time(problem, report),
        };
        found.unwrap_or(f64::NAN)
    }

    fn over_time(&self, problem: &dyn Problem, report: &Report) -> Option<f64> {
        let solution = &report.solution;
        if let Some(output) = solution.output(&self.name) {
            let times = self.times(output.start(), output.end());
            return Some(self.pick(times.iter().map(|t| output.at(*t))));
        }
        let signal = solution.signal(problem, &self.name)?;
        let (start, end) = signal.span().unwrap_or((0.0, 0.0));
        Some(self.pick(signal.values(&self.times(start, end)).into_iter()))
    }

    /// Where it is looked at.
    fn times(&self, start: f64, end: f64) -> Vec<f64> {
        let last = (SAMPLES - 1) as f64;
        match self.kind {
            Kind::Initial => vec![start],
            Kind::Least | Kind::Greatest => (0..SAMPLES).map(|i| start + (end - start) * i as f64 / last).collect(),
            _ => vec![end],
        }
    }

    fn pick(&self, mut values: impl Iterator<Item = f64>) -> f64 {
        match self.kind {
            Kind::Least => values.fold(f64::INFINITY, f64::min),
            Kind::Greatest => values.fold(f64::NEG_INFINITY, f64::max),
            _ => values.next().unwrap_or(f64::NAN),
        }
    }
}
