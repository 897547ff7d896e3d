//! `final(x)`, `max(speed)`, `T`: what is wanted of every row beside the usual.

use ntg_runtime::problem::Problem;
use ntg_runtime::report::Report;
use ntg_runtime::solution::Solution;
use ntg_runtime::structure::Structure;

/// Samples of a quantity for its least and greatest value.
const SAMPLES: usize = 401;

/// Names that are told where one is none of them. A choice: a line or two of a terminal.
const TOLD: usize = 12;

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

    /// Reads wanted values; one of an array, or of a family of agents, is one for each member.
    ///
    /// # Errors
    /// In words: an unknown form or name, or a member that there is not.
    pub fn all(texts: &[String], problem: &dyn Problem) -> Result<Vec<Self>, String> {
        let structure = problem.structure();
        // What is wrong with the problem itself is told by its rows.
        let solution = Solution::unsolved(problem).ok();
        let mut all: Vec<Self> = vec![];
        for text in texts {
            let value = Self::parse(text, &structure)?;
            let members = match &solution {
                Some(solution) => value.members(problem, solution)?,
                None => vec![value],
            };
            for member in members {
                if !all.contains(&member) {
                    all.push(member);
                }
            }
        }
        Ok(all)
    }

    /// The value itself if solutions have one of its name, else those of the members of what it names.
    fn members(self, problem: &dyn Problem, solution: &Solution) -> Result<Vec<Self>, String> {
        let signals = solution.signals(problem).into_iter().map(|signal| signal.name().to_owned());
        let names: Vec<String> = match self.kind {
            Kind::Violation | Kind::Sensitivity => return Ok(vec![self]),
            Kind::Number => {
                let times = solution.event_times().into_iter().map(|time| time.0);
                let variables = solution.variables().into_iter().map(|variable| variable.name);
                variables.chain(times).chain(signals).collect()
            }
            _ => {
                let outputs = solution.trajectories().into_iter().map(|output| output.name().to_owned());
                outputs.chain(signals).collect()
            }
        };
        let is_there = |name: &str| match self.kind {
            Kind::Number => names.iter().any(|known| known == name) || solution.signal(problem, name).is_some(),
            _ => solution.output(name).is_some() || solution.signal(problem, name).is_some(),
        };
        if is_there(&self.name) {
            return Ok(vec![self]);
        }
        // In one phase alone: `leg.r` is `leg.r[1]` and so on.
        let phases = solution.phases().into_iter().map(|phase| phase.name).filter(|name| !name.is_empty());
        let last = |name: &str| name.rsplit('.').next().unwrap_or(name).to_owned();
        let in_phases: Vec<String> =
            phases.flat_map(|phase| names.iter().map(move |name| format!("{phase}.{}", last(name)))).collect();
        let mut found: Vec<&String> = vec![];
        for name in names.iter().chain(in_phases.iter().filter(|name| self.name.contains('.') && is_there(name))) {
            if is_member(name, &self.name) && !found.contains(&name) {
                found.push(name);
            }
        }
        if found.is_empty() {
            let more = if names.len() > TOLD { format!(", and {} more", names.len() - TOLD) } else { String::new() };
            let told = &names[..names.len().min(TOLD)];
            return Err(format!(
                "`{}`: solutions have no `{}`; they have `{}`{more}",
                self.text,
                self.name,
                told.join("`, `")
            ));
        }
        let of = |name: &String| {
            let text = if self.kind == Kind::Number { name.clone() } else { self.text.replacen(&self.name, name, 1) };
            Self { text, kind: self.kind, name: name.clone() }
        };
        Ok(found.into_iter().map(of).collect())
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

/// Whether a name is that of a member of what another one names: `uav[2].r[1]` of `r`, `r[1]`, `uav.r` and `uav[2].r`.
fn is_member(name: &str, of: &str) -> bool {
    let (name, of): (Vec<&str>, Vec<&str>) = (name.split('.').collect(), of.split('.').collect());
    let is_like = |(own, wanted): (&&str, &&str)| own == wanted || own.split('[').next() == Some(wanted);
    name.len() >= of.len() && name[name.len() - of.len()..].iter().zip(&of).all(is_like)
}

#[cfg(test)]
mod tests {
    use super::is_member;

    #[test]
    fn members_are_those_of_arrays_and_of_agents() {
        for of in ["r", "r[1]", "uav.r", "uav[2].r", "uav.r[1]"] {
            assert!(is_member("uav[2].r[1]", of), "{of}");
        }
        for of in ["r[2]", "uav[1].r", "u", "x.uav.r", "2].r"] {
            assert!(!is_member("uav[2].r[1]", of), "{of}");
        }
    }
}
