//! Which outputs are positions.
//!
//! Two or three outputs of an agent are the position of a *vehicle* where a route guesses them
//! together. In an agent without such a route they are those that boundary conditions fix at both ends or
//! constant bounds confine: the two or three elements of a vector, a vector of two with the height beside it, or two or
//! three numbers of one unit and one index.

use crate::guess::Guess;
use crate::transcribe::instances::{index_at, members};
use crate::transcribe::layout::Layout;
use crate::transcribe::slots::AffineMap;
use crate::transcribe::{Transcription, names};
use ntg_splines::Side;
use ntg_structure::{Family, GuessKind, GuessScope, Output};

/// An output by name and index.
type Axis = (String, Option<i64>);

/// The outputs that are one vehicle's position.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Vehicle {
    pub(super) agent: usize,
    /// Name and index of two or three outputs.
    pub(super) axes: Vec<Axis>,
    /// For each phase of the agent, which of the phase's outputs they are.
    pub(super) members: Vec<Vec<usize>>,
}

/// Smallest and largest number of outputs of one position.
const AXES: std::ops::RangeInclusive<usize> = 2..=3;

/// Every vehicle of a problem.
pub(super) fn vehicles(nlp: &Transcription, guess: &Guess) -> Vec<Vehicle> {
    let mut found: Vec<Vehicle> = vec![];
    let mut add = |agent: usize, axes: Vec<Axis>| {
        let known = |v: &Vehicle| v.agent == agent && v.axes.iter().any(|axis| axes.contains(axis));
        if !found.iter().any(known) {
            found.extend(Vehicle::new(&nlp.model.layout, nlp, agent, axes));
        }
    };
    for (agent, axes) in guessed(nlp, guess) {
        add(agent, axes);
    }
    for agent in 0..nlp.model.layout.agents.len() {
        if !found.iter().any(|vehicle| vehicle.agent == agent) {
            let plain = plain(nlp, agent);
            found.extend(plain.into_iter().filter_map(|axes| Vehicle::new(&nlp.model.layout, nlp, agent, axes)));
        }
    }
    found
}

/// The paths of all coordinates of vehicles.
pub(super) fn positions(nlp: &Transcription, vehicles: &[Vehicle]) -> Vec<String> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let paths = vehicles.iter().flat_map(|vehicle| {
        let (path, phase) = (names::agent(structure, layout, vehicle.agent), layout.agents[vehicle.agent].phases.start);
        vehicle.members.first().into_iter().flatten().map(move |output| {
            let own = &layout.phases[phase].outputs[*output];
            let declared = &structure.phases[layout.phases[phase].phase].outputs[own.output];
            names::join(&path, &names::member(&declared.name, declared.family, own.index))
        })
    });
    paths.collect()
}

impl Vehicle {
    /// None where a phase of the agent does not have all of the outputs.
    fn new(layout: &Layout, nlp: &Transcription, agent: usize, axes: Vec<Axis>) -> Option<Self> {
        let member = |phase: usize, (name, index): &Axis| {
            let declared = &nlp.model.structure.phases[layout.phases[phase].phase].outputs;
            layout.phases[phase].outputs.iter().position(|o| o.index == *index && declared[o.output].name == *name)
        };
        let phases = layout.agents[agent].phases.clone();
        let members: Option<Vec<Vec<usize>>> =
            phases.map(|phase| axes.iter().map(|axis| member(phase, axis)).collect()).collect();
        AXES.contains(&axes.len()).then_some(Self { agent, axes, members: members? })
    }

    /// Its position at a scaled time of a phase, SI.
    pub(super) fn at(&self, nlp: &Transcription, phase: usize, tau: f64, x: &[f64]) -> Vec<f64> {
        let layout = &nlp.model.layout;
        let first = layout.agents[self.agent].phases.start;
        let side = if tau < 1.0 { Side::Right } else { Side::Left };
        let value =
            |output: &usize| AffineMap { terms: layout.basis(phase, *output, 0, tau, side), offset: 0.0 }.value(x);
        self.members[phase - first].iter().map(value).collect()
    }

    /// Its first and last positions.
    pub(super) fn ends(&self, nlp: &Transcription, x: &[f64]) -> [Vec<f64>; 2] {
        let phases = &nlp.model.layout.agents[self.agent].phases;
        [self.at(nlp, phases.start, 0.0, x), self.at(nlp, phases.end - 1, 1.0, x)]
    }

    /// The box in which routes are looked for: what the guess covers, made wider by half of its
    /// larger side, within constant bounds on the outputs (docs/maths.md, equation 12.1).
    pub(super) fn extent(&self, nlp: &Transcription, x: &[f64]) -> Vec<(f64, f64)> {
        /// Points of each phase that say what the guess covers.
        const SAMPLES: usize = 33;
        let phases = nlp.model.layout.agents[self.agent].phases.clone();
        let mut held = vec![(f64::INFINITY, f64::NEG_INFINITY); self.axes.len()];
        for phase in phases.clone() {
            for i in 0..SAMPLES {
                let at = self.at(nlp, phase, i as f64 / (SAMPLES - 1) as f64, x);
                held.iter_mut().zip(at).for_each(|(h, v)| *h = (h.0.min(v), h.1.max(v)));
            }
        }
        let own = nlp.own_bounds();
        let bounds: Vec<_> = self.members[0].iter().map(|o| own.all(nlp, (phases.start, *o))).collect();
        let sides = held.iter().zip(&bounds).map(|(h, bound)| {
            let confined = bound.map_or(0.0, |(lower, upper)| upper - lower);
            (h.1 - h.0).max(if confined.is_finite() { 0.5 * confined } else { 0.0 })
        });
        let largest = sides.fold(0.0, f64::max);
        let wider = if largest > 0.0 { 0.5 * largest } else { self.unit(nlp) };
        let widen = |(h, bound): (&(f64, f64), &Option<(f64, f64)>)| {
            let (lower, upper) = bound.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            ((h.0 - wider).max(lower.min(h.0)), (h.1 + wider).min(upper.max(h.1)))
        };
        held.iter().zip(&bounds).map(widen).collect()
    }

    fn unit(&self, nlp: &Transcription) -> f64 {
        let phase = &nlp.model.layout.phases[nlp.model.layout.agents[self.agent].phases.start];
        nlp.model.structure.phases[phase.phase].outputs[phase.outputs[self.members[0][0]].output].unit.factor
    }
}

/// Outputs that routes guess together, the spec's first.
fn guessed(nlp: &Transcription, guess: &Guess) -> Vec<(usize, Vec<Axis>)> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let mut found = vec![];
    for declared in &structure.guesses {
        let GuessKind::Route { outputs, .. } = &declared.kind else { continue };
        for indices in members(&declared.loops) {
            let agent = match &declared.scope {
                GuessScope::Phase(phase) => {
                    layout.phase(structure, phase, &indices).map(|p| layout.phases[p].agent).ok()
                }
                GuessScope::Agent { agent, index } => {
                    let index = index_at(index.as_ref(), &indices);
                    layout.agents.iter().position(|member| member.agent == *agent && member.index == index)
                }
            };
            let axes = outputs.iter().map(|(name, index)| (name.clone(), index_at(index.as_ref(), &indices)));
            found.extend(agent.map(|agent| (agent, axes.collect())));
        }
    }
    for route in guess.routes() {
        for agent in 0..layout.agents.len() {
            let path = names::agent(structure, layout, agent);
            let axis = |given: &String| {
                let mut own = outputs(nlp, agent).into_iter();
                own.find_map(|(axis, family)| {
                    names::means_member(given, &path, (&axis.0, family), axis.1).then_some(axis)
                })
            };
            found.extend(route.iter().map(axis).collect::<Option<Vec<_>>>().map(|axes| (agent, axes)));
        }
    }
    found
}

/// Name and index of every output of an agent's first phase, and the array that it is a member of.
fn outputs(nlp: &Transcription, agent: usize) -> Vec<(Axis, Option<Family>)> {
    let layout = &nlp.model.layout;
    let Some(phase) = layout.agents[agent].phases.clone().next() else { return vec![] };
    let declared = &nlp.model.structure.phases[layout.phases[phase].phase].outputs;
    let own = layout.phases[phase].outputs.iter().map(|o| (&declared[o.output], o.index));
    own.map(|(output, index)| ((output.name.clone(), index), output.family)).collect()
}

/// A coordinate that may be one of a position.
struct Candidate {
    axis: Axis,
    unit: String,
    /// Which vector it is an element of: the name of the array, and the row of a matrix.
    vector: Option<(String, usize)>,
}

/// Groups of outputs that are fixed at both ends, or confined: the elements of a vector, a plane vector with the one height
/// beside it, and numbers of one unit and one index.
fn plain(nlp: &Transcription, agent: usize) -> Vec<Vec<Axis>> {
    let (mut vectors, mut rest): (Vec<Vec<Candidate>>, Vec<Candidate>) = (vec![], vec![]);
    for candidate in candidates(nlp, agent) {
        match vectors.iter_mut().find(|known| candidate.vector.is_some() && known[0].vector == candidate.vector) {
            Some(vector) => vector.push(candidate),
            None if candidate.vector.is_some() => vectors.push(vec![candidate]),
            None => rest.push(candidate),
        }
    }
    let mut groups: Vec<Vec<Candidate>> = vec![];
    for mut vector in vectors {
        let row = vector[0].vector.as_ref().map_or(0, |(_, row)| *row);
        let is_height = |other: &Candidate| {
            let index = other.axis.1.map_or(1, |index| usize::try_from(index).unwrap_or(0));
            other.unit == vector[0].unit && index == row
        };
        let heights: Vec<usize> = (0..rest.len()).filter(|k| is_height(&rest[*k])).collect();
        if let ([height], 2) = (&heights[..], vector.len()) {
            vector.push(rest.remove(*height));
        }
        groups.push(vector);
    }
    let alike = |group: &[Candidate], own: &Candidate| group[0].unit == own.unit && group[0].axis.1 == own.axis.1;
    let first = groups.len();
    for candidate in rest {
        match groups[first..].iter_mut().find(|group| alike(group, &candidate)) {
            Some(group) => group.push(candidate),
            None => groups.push(vec![candidate]),
        }
    }
    groups.retain(|group| AXES.contains(&group.len()));
    // Velocities are tied at both ends, too: a route of the position says how they change.
    if groups.iter().any(|group| !is_rate(&group[0].unit)) {
        groups.retain(|group| !is_rate(&group[0].unit));
    }
    let axes = groups.into_iter().map(|group| group.into_iter().map(|candidate| candidate.axis).collect::<Vec<_>>());
    axes.collect()
}

/// Whether a unit is one of something per time.
fn is_rate(unit: &str) -> bool {
    ["/s", "/min", "/h", "/day"].iter().any(|per| unit.contains(per))
}

/// The outputs of an agent that boundary conditions fix at both ends, or constant bounds confine.
fn candidates(nlp: &Transcription, agent: usize) -> Vec<Candidate> {
    let layout = &nlp.model.layout;
    let phases = layout.agents[agent].phases.clone();
    let (Some(first), Some(last)) = (phases.clone().next(), phases.last()) else { return vec![] };
    let declared = &nlp.model.structure.phases[layout.phases[first].phase].outputs;
    let bounds = nlp.own_bounds();
    let mut found = vec![];
    for (output, member) in layout.phases[first].outputs.iter().enumerate() {
        let own = &declared[member.output];
        let fixed = |phase: usize, output: usize, tau: f64, side: Side| {
            let map = AffineMap { terms: layout.basis(phase, output, 0, tau, side), offset: 0.0 };
            nlp.linear.value(&map).is_some()
        };
        let confined = bounds.all(nlp, (first, output)).is_some_and(|(a, b)| (b - a).is_finite());
        let later = &nlp.model.structure.phases[layout.phases[last].phase].outputs;
        let same =
            |o: &crate::transcribe::layout::OutputMember| o.index == member.index && later[o.output].name == own.name;
        let Some(at_end) = layout.phases[last].outputs.iter().position(same) else { continue };
        let tied = fixed(first, output, 0.0, Side::Right) && fixed(last, at_end, 1.0, Side::Left);
        if confined || tied {
            let axis = (own.name.clone(), member.index);
            found.push(Candidate { axis, unit: own.unit.symbol.clone(), vector: vector_of(own, member.index) });
        }
    }
    found
}

/// The vector of a plane or of space that a member of an array belongs to: the array's name, and which vector of it, from 1.
fn vector_of(output: &Output, index: Option<i64>) -> Option<(String, usize)> {
    let size = output.vector.filter(|size| AXES.contains(size))?;
    let member = usize::try_from(index? - output.family?.first).ok()?;
    Some((output.name.clone(), 1 + member / size))
}
