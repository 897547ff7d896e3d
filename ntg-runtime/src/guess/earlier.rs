//! A start from an earlier solution, on the same knots or on others.
//!
//! Agents, phases, outputs and variables are recognised by name. An output of a phase that the
//! earlier problem did not have takes the same part of its agent's whole time.

use super::start::{Curve, pointwise, set};
use crate::solution::Solution;
use crate::transcribe::{Transcription, names};

/// The earlier variables themselves, where both problems have the same layout.
pub(super) fn same(nlp: &Transcription, solution: &Solution) -> Option<Vec<f64>> {
    let (old, new) = (&solution.inner.model, &nlp.model);
    let described = |model: &crate::transcribe::Model| {
        let phases = 0..model.layout.phases.len();
        let phases = phases.map(|p| {
            (names::phase(&model.structure, &model.layout, p), model.layout.phases[p].duration.fixed().is_some())
        });
        phases.collect::<Vec<_>>()
    };
    let knots = || {
        let pairs = old.layout.phases.iter().zip(&new.layout.phases);
        pairs.into_iter().all(|(a, b)| {
            a.outputs.len() == b.outputs.len() && a.outputs.iter().zip(&b.outputs).all(|(a, b)| a.knots == b.knots)
        })
    };
    let alike = old.layout.variables == new.layout.variables && described(old) == described(new) && knots();
    alike.then(|| solution.inner.x.clone())
}

/// Durations, starts and variables of the same name.
pub(super) fn times(nlp: &Transcription, solution: &Solution, x: &mut [f64]) {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let (old, old_x) = (&solution.inner.model, &solution.inner.x);
    for phase in 0..layout.phases.len() {
        if let Some(found) = old_phase(nlp, solution, phase) {
            set(layout.phases[phase].duration, old.layout.duration(found, old_x), x);
        }
    }
    for agent in 0..layout.agents.len() {
        if let Some(found) = old_agent(nlp, solution, agent) {
            set(layout.agents[agent].start, old.layout.agents[found].start.at(old_x), x);
        }
    }
    for value in solution.variables() {
        for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
            let members = crate::transcribe::instances::family_members(declared.family);
            let member =
                members.iter().position(|index| names::member(&declared.name, declared.family, *index) == value.name);
            if let Some(member) = member {
                x[*first as usize + member] = value.value * value.unit.factor;
            }
        }
    }
}

/// One curve for every output that the earlier solution has.
pub(super) fn curves<'a>(nlp: &Transcription, solution: &'a Solution) -> Vec<Curve<'a>> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let mut curves = vec![];
    for (phase, member) in layout.phases.iter().enumerate() {
        let Some(agent) = old_agent(nlp, solution, member.agent) else { continue };
        let old_layout = &solution.inner.model.layout;
        let same = old_phase(nlp, solution, phase);
        for (output, found) in member.outputs.iter().enumerate() {
            let name = &structure.phases[member.phase].outputs[found.output].name;
            let Some(trajectory) = solution.of_agent(agent, name, found.index) else { continue };
            let (start, length) = match same {
                Some(old) => (old_layout.start(old, &solution.inner.x), old_layout.duration(old, &solution.inner.x)),
                None => (trajectory.start(), trajectory.end() - trajectory.start()),
            };
            let function = pointwise(move |tau| Ok(trajectory.si(start + tau * length, 0)));
            curves.push(Curve { phase, output, whole: same.is_none(), function });
        }
    }
    curves
}

fn old_phase(nlp: &Transcription, solution: &Solution, phase: usize) -> Option<usize> {
    let name = names::phase(&nlp.model.structure, &nlp.model.layout, phase);
    let old = &solution.inner.model;
    (0..old.layout.phases.len()).find(|p| names::phase(&old.structure, &old.layout, *p) == name)
}

fn old_agent(nlp: &Transcription, solution: &Solution, agent: usize) -> Option<usize> {
    let name = names::agent(&nlp.model.structure, &nlp.model.layout, agent);
    let old = &solution.inner.model;
    (0..old.layout.agents.len()).find(|a| names::agent(&old.structure, &old.layout, *a) == name)
}
