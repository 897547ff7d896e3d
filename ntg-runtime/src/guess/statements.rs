//! The `guess` statements of a spec and those of a program, as times and curves.
//!
//! A curve of a whole agent is given once for each of its phases.

use super::program::{Guess, Statement};
use super::route::Route;
use super::start::{Curve, Function, pointwise, set};
use crate::transcribe::frame::Frame;
use crate::transcribe::instances::{index_at, members, position};
use crate::transcribe::layout::Time;
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::times::Clock;
use crate::transcribe::{SetupError, Transcription, names};
use ntg_splines::Side;
use ntg_structure::{Call, GuessKind, GuessScope};
use std::rc::Rc;

/// Statements about one transcription.
pub(super) struct Statements<'a> {
    pub(super) nlp: &'a Transcription<'a>,
    pub(super) guess: &'a Guess,
}

impl<'a> Statements<'a> {
    /// Times and variables that the spec guesses.
    pub(super) fn spec_times(&self, x: &mut [f64]) -> Result<(), SetupError> {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        for guess in &structure.guesses {
            for indices in members(&guess.loops) {
                match &guess.kind {
                    GuessKind::Duration { value } => {
                        let (phases, _) = self.scope(&guess.scope, &indices)?;
                        let seconds = self.value(value, &indices, x)?[0];
                        self.share(&phases, seconds, x);
                    }
                    GuessKind::Variable { variable, index, value } => {
                        let index = index_at(index.as_ref(), &indices);
                        let variable = layout.variable(structure, *variable, index)?;
                        x[variable as usize] = self.value(value, &indices, x)?[0];
                    }
                    GuessKind::Start { value } => {
                        let (phases, _) = self.scope(&guess.scope, &indices)?;
                        let seconds = self.value(value, &indices, x)?[0];
                        if let Some(phase) = phases.first() {
                            set(layout.agents[layout.phases[*phase].agent].start, seconds, x);
                        }
                    }
                    GuessKind::Output { .. } | GuessKind::Route { .. } => {}
                }
            }
        }
        Ok(())
    }

    /// Curves that the spec guesses.
    pub(super) fn spec_curves(&self, x: &[f64]) -> Result<Vec<Curve<'a>>, SetupError> {
        let nlp = self.nlp;
        let mut curves = vec![];
        for guess in &nlp.model.structure.guesses {
            for indices in members(&guess.loops) {
                match &guess.kind {
                    GuessKind::Output { output, index, value } => {
                        let (phases, whole) = self.scope(&guess.scope, &indices)?;
                        let index = index_at(index.as_ref(), &indices);
                        let clock = Clock::at(&nlp.model.layout, x);
                        let function: Function = Rc::new(move |times| along(nlp, &clock, value, &indices, times));
                        self.add(&phases, whole, (output, index), &function, &mut curves);
                    }
                    GuessKind::Route { outputs, points, values } => {
                        let (phases, whole) = self.scope(&guess.scope, &indices)?;
                        let clock = Clock::at(&nlp.model.layout, x);
                        let numbers = numbers(nlp, &clock, values, &indices, points * outputs.len())?;
                        let points = numbers.chunks(outputs.len().max(1)).map(<[f64]>::to_vec).collect();
                        let Some(route) = Route::new(points).map(Rc::new) else { continue };
                        for (axis, (output, index)) in outputs.iter().enumerate() {
                            let route = route.clone();
                            let function = pointwise(move |s| Ok(route.at(axis, s)));
                            let index = index_at(index.as_ref(), &indices);
                            self.add(&phases, whole, (output, index), &function, &mut curves);
                        }
                    }
                    _ => {}
                }
            }
        }
        Ok(curves)
    }

    /// Times and variables that the program guesses.
    pub(super) fn program_times(&self, x: &mut [f64]) -> Result<(), SetupError> {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        for statement in &self.guess.statements {
            let (name, value) = match statement {
                Statement::Duration { of, seconds } => (of, *seconds),
                Statement::Start { agent, seconds } => (agent, *seconds),
                Statement::Variable { name, value } => (name, *value),
                _ => continue,
            };
            finite(value, name)?;
            let mut found = false;
            match statement {
                Statement::Duration { .. } => {
                    for (agent, member) in layout.agents.iter().enumerate() {
                        let path = names::agent(structure, layout, agent);
                        let whole = structure.agents[member.agent].duration_name.as_deref();
                        let whole = whole.is_some_and(|own| names::means(name, &path, own, None)) || *name == path;
                        if whole && !name.is_empty() {
                            found = true;
                            self.share(&Vec::from_iter(member.phases.clone()), value, x);
                            continue;
                        }
                        for phase in member.phases.clone() {
                            if names::means_duration(structure, layout, name, phase) {
                                found = true;
                                set(layout.phases[phase].duration, value, x);
                            }
                        }
                    }
                }
                Statement::Start { .. } => {
                    for (agent, member) in layout.agents.iter().enumerate() {
                        if *name == names::agent(structure, layout, agent) {
                            found = true;
                            set(member.start, value, x);
                        }
                    }
                }
                _ => {
                    for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
                        let members = crate::transcribe::instances::family_members(declared.family);
                        for (member, index) in members.into_iter().enumerate() {
                            if names::means_member(name, "", (&declared.name, declared.family), index) {
                                found = true;
                                x[*first as usize + member] = value * declared.unit.factor;
                            }
                        }
                    }
                }
            }
            if !found {
                return Err(names::unknown("a guess", name, structure));
            }
        }
        Ok(())
    }

    /// Curves that the program guesses; coefficients are written to `x` by the curves' fit, which
    /// reproduces a spline on the same knots.
    pub(super) fn program_curves(&self, _x: &[f64]) -> Result<Vec<Curve<'a>>, SetupError> {
        let mut curves = vec![];
        for statement in &self.guess.statements {
            match statement {
                Statement::Output { output, value } => {
                    let value = value.clone();
                    self.named(output, &mut curves, |unit| {
                        let value = value.clone();
                        let name = output.clone();
                        Ok(pointwise(move |tau| finite(value(tau) * unit, &name)))
                    })?;
                }
                Statement::Route { outputs, points } => {
                    if points.iter().flatten().any(|v| !v.is_finite()) {
                        return Err(SetupError::Guess { message: "a way-point of the route is not finite".into() });
                    }
                    if let Some(point) = points.iter().find(|point| point.len() != outputs.len()) {
                        let (wanted, got) = (outputs.len(), point.len());
                        let message = format!("a way-point of the route has {got} values for {wanted} outputs");
                        return Err(SetupError::Guess { message });
                    }
                    let Some(route) = Route::new(points.clone()).map(Rc::new) else { continue };
                    for (axis, output) in outputs.iter().enumerate() {
                        self.named(output, &mut curves, |unit| {
                            let route = route.clone();
                            Ok(pointwise(move |s| Ok(route.at(axis, s) * unit)))
                        })?;
                    }
                }
                Statement::Coefficients { output, values } => self.coefficients(output, values, &mut curves)?,
                _ => {}
            }
        }
        Ok(curves)
    }

    /// A spline with given coefficients, on the output's own knots.
    fn coefficients(&self, name: &'a str, values: &'a [f64], curves: &mut Vec<Curve<'a>>) -> Result<(), SetupError> {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        let first = curves.len();
        for phase in 0..layout.phases.len() {
            for (output, member) in layout.phases[phase].outputs.iter().enumerate() {
                let path = names::phase(structure, layout, phase);
                let declared = &structure.phases[layout.phases[phase].phase].outputs[member.output];
                if !names::means_member(name, &path, (&declared.name, declared.family), member.index) {
                    continue;
                }
                let Some(spline) = ntg_splines::Spline::new(&member.knots, values) else {
                    let (found, wanted) = (values.len(), member.knots.coefficients());
                    let message = format!("`{name}` has {wanted} coefficients, but {found} are guessed");
                    return Err(SetupError::Guess { message });
                };
                let unit = declared.unit.factor;
                let function = pointwise(move |tau| {
                    let side = if tau == 1.0 { Side::Left } else { Side::Right };
                    finite(spline.one_sided(tau, 0, side) * unit, name)
                });
                curves.push(Curve { phase, output, whole: false, function });
            }
        }
        if curves.len() == first { Err(names::unknown("a guess", name, structure)) } else { Ok(()) }
    }

    /// Adds a function for every output that a name means: in every phase of its agent, or in the
    /// one phase whose path it has.
    fn named(
        &self,
        name: &str,
        curves: &mut Vec<Curve<'a>>,
        make: impl Fn(f64) -> Result<Function<'a>, SetupError>,
    ) -> Result<(), SetupError> {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        let first = curves.len();
        for (phase, member) in layout.phases.iter().enumerate() {
            let agent = names::agent(structure, layout, member.agent);
            let path = names::phase(structure, layout, phase);
            for (output, found) in member.outputs.iter().enumerate() {
                let declared = &structure.phases[member.phase].outputs[found.output];
                let own = (declared.name.as_str(), declared.family);
                let whole = names::means_member(name, &agent, own, found.index);
                if whole || names::means_member(name, &path, own, found.index) {
                    curves.push(Curve { phase, output, whole, function: make(declared.unit.factor)? });
                }
            }
        }
        if curves.len() == first { Err(names::unknown("a guess", name, structure)) } else { Ok(()) }
    }

    /// Adds a function for an output in each of some phases that has it.
    fn add(
        &self,
        phases: &[usize],
        whole: bool,
        (output, index): (&str, Option<i64>),
        function: &Function<'a>,
        curves: &mut Vec<Curve<'a>>,
    ) {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        for &phase in phases {
            let member = &layout.phases[phase];
            let declared = &structure.phases[member.phase].outputs;
            let found = member.outputs.iter().position(|o| o.index == index && declared[o.output].name == output);
            curves.extend(found.map(|output| Curve { phase, output, whole, function: function.clone() }));
        }
    }

    /// The phases that a statement is about, and whether it speaks of an agent's whole time.
    fn scope(&self, scope: &GuessScope, indices: &[i64]) -> Result<(Vec<usize>, bool), SetupError> {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        match scope {
            GuessScope::Phase(reference) => Ok((vec![layout.phase(structure, reference, indices)?], false)),
            GuessScope::Agent { agent, index } => {
                let Some(declared) = structure.agents.get(*agent) else {
                    return Err(SetupError::malformed(format!("there is no agent number {agent}")));
                };
                let name = || format!("agent `{}`", declared.name.as_deref().unwrap_or_default());
                let index = index_at(index.as_ref(), indices);
                let member = layout.agent_first[*agent] + position(name, declared.family, index, &declared.place)?;
                Ok((layout.agents[member].phases.clone().collect(), true))
            }
        }
    }

    /// Stretches the free ones among some phases so that all together last `seconds`
    /// (docs/maths.md, equation 8.4).
    fn share(&self, phases: &[usize], seconds: f64, x: &mut [f64]) {
        let layout = &self.nlp.model.layout;
        let free = |phase: &&usize| matches!(layout.phases[**phase].duration, Time::Free(_));
        let fixed: f64 = phases.iter().filter(|p| !free(p)).map(|p| layout.duration(*p, x)).sum();
        let present: f64 = phases.iter().filter(free).map(|p| layout.duration(*p, x)).sum();
        let factor = (seconds - fixed) / present;
        if !(factor.is_finite() && factor > 0.0) {
            return; // The fixed phases alone last longer.
        }
        for phase in phases.iter().filter(free) {
            let guessed = factor * layout.duration(*phase, x);
            set(layout.phases[*phase].duration, guessed, x);
        }
    }

    fn value(&self, call: &Call, indices: &[i64], x: &[f64]) -> Result<Vec<f64>, SetupError> {
        numbers(self.nlp, &Clock::at(&self.nlp.model.layout, x), call, indices, 1)
    }
}

/// The finite results of a call without slots, with guessed times.
fn numbers(
    nlp: &Transcription,
    clock: &Clock,
    call: &Call,
    indices: &[i64],
    count: usize,
) -> Result<Vec<f64>, SetupError> {
    let values = Frame { clock, ..nlp.frame() }.numbers(call, indices, Point::NONE)?;
    if values.len() < count {
        return Err(SetupError::malformed("a guess has too few values"));
    }
    all_finite(values)
}

/// The finite first results of a call without slots at many scaled times, with guessed times.
fn along(
    nlp: &Transcription,
    clock: &Clock,
    call: &Call,
    indices: &[i64],
    taus: &[f64],
) -> Result<Vec<f64>, SetupError> {
    let site = |tau: &f64| Site { indices: indices.to_vec(), point: Point { tau: *tau, ..Point::NONE } };
    all_finite(Frame { clock, ..nlp.frame() }.evaluate_all(call, taus.iter().map(site).collect(), &[])?)
}

fn all_finite(values: Vec<f64>) -> Result<Vec<f64>, SetupError> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(value) => Err(SetupError::Guess { message: format!("a value in the spec's guess is {value}") }),
        None => Ok(values),
    }
}

fn finite(value: f64, name: &str) -> Result<f64, SetupError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(SetupError::Guess { message: format!("the guess of `{name}` is {value}; it must be finite") })
    }
}
