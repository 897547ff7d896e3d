//! Who sits where in the vector of variables (docs/maths.md, section 4.2).
//!
//! Takes a [`Structure`]; gives every member of its families of agents, phases and outputs, with
//! knots, and the index of every variable: first the coefficients, phase by phase, those of one
//! phase interleaved over its outputs in order of time, so that neighbours in time are neighbours
//! in the vector; then free durations, free starts, declared variables and integrals.
//!
//! Finds: impossible splines. Afterwards: every phase has at least one interval; fixed times are
//! NaN until `times::fix` has computed them.

use super::error::SetupError;
use super::instances::{family_len, family_members, index_at, members, position};
use super::points::union;
use ntg_splines::Knots;
use ntg_structure::{Duration, Family, Phase, PhaseRef, Place, Start, Structure};
use std::ops::Range;
use std::sync::Arc;

/// A duration or a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Time {
    /// Known before the solve, in seconds.
    Fixed(f64),
    /// A variable of the program.
    Free(u32),
}

/// One member of a (family of) agents.
#[derive(Clone, Debug)]
pub(crate) struct AgentMember {
    /// Index into `Structure::agents`.
    pub(crate) agent: usize,
    /// Its index, when the agent is a family.
    pub(crate) index: Option<i64>,
    /// Its phases in order of time, as indices into `Layout::phases`.
    pub(crate) phases: Range<usize>,
    /// When it starts.
    pub(crate) start: Time,
}

/// One member of a (family of) phases.
#[derive(Clone, Debug)]
pub(crate) struct PhaseMember {
    /// Index into `Structure::phases`.
    pub(crate) phase: usize,
    /// Index into `Layout::agents`.
    pub(crate) agent: usize,
    /// Its index, when the phase is a family.
    pub(crate) index: Option<i64>,
    /// How long it lasts.
    pub(crate) duration: Time,
    /// Members of all outputs.
    pub(crate) outputs: Vec<OutputMember>,
    /// Where the members of each of `Phase::outputs` begin in `outputs`.
    pub(crate) output_first: Vec<usize>,
    /// Union of the outputs' breakpoints.
    pub(crate) breakpoints: Vec<f64>,
}

/// One member of a (family of) outputs in one phase.
#[derive(Clone, Debug)]
pub(crate) struct OutputMember {
    /// Index into `Phase::outputs`.
    pub(crate) output: usize,
    /// Its index, when the output is an array.
    pub(crate) index: Option<i64>,
    /// Its knots; equal ones of a problem are the same.
    pub(crate) knots: Arc<Knots>,
    /// The variable that is each of its coefficients.
    pub(crate) coefficients: Vec<u32>,
}

/// Members and variables of a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout {
    pub(crate) agents: Vec<AgentMember>,
    pub(crate) phases: Vec<PhaseMember>,
    /// Where the members of each of `Structure::agents` begin in `agents`.
    pub(crate) agent_first: Vec<usize>,
    /// For each of `Structure::phases` the first member of each of its agent's members.
    pub(crate) phase_first: Vec<Vec<usize>>,
    /// The first member of each of `Structure::variables`, as a variable of the program.
    pub(crate) variable_first: Vec<u32>,
    /// The members of each of `Structure::integrals`: their indices, in order.
    pub(crate) integral_members: Vec<Vec<Vec<i64>>>,
    /// The first member of each of `Structure::integrals`, as a variable of the program.
    pub(crate) integral_first: Vec<u32>,
    /// How many variables are coefficients.
    pub(crate) coefficients: usize,
    /// How many variables there are.
    pub(crate) variables: usize,
}

impl Layout {
    /// The variables that are durations, phase by phase.
    pub(crate) fn free_durations(&self) -> impl Iterator<Item = u32> + '_ {
        self.phases.iter().filter_map(|phase| match phase.duration {
            Time::Free(variable) => Some(variable),
            Time::Fixed(_) => None,
        })
    }

    /// Expands all families and numbers all variables.
    pub(crate) fn new(structure: &Structure) -> Result<Self, SetupError> {
        let mut layout = Self { phase_first: vec![vec![]; structure.phases.len()], ..Self::default() };
        for agent in 0..structure.agents.len() {
            layout.agent_first.push(layout.agents.len());
            for index in family_members(structure.agents[agent].family) {
                layout.add_agent(structure, agent, index)?;
            }
        }
        layout.coefficients = layout.variables;
        layout.number_times(structure);
        for variable in &structure.variables {
            let count = family_len(variable.family);
            let first = layout.take(count);
            layout.variable_first.push(first);
        }
        for integral in &structure.integrals {
            let found = members(&integral.loops);
            let first = layout.take(found.len());
            layout.integral_first.push(first);
            layout.integral_members.push(found);
        }
        Ok(layout)
    }

    /// Which member a reference to a phase means, inside given indices.
    pub(crate) fn phase(
        &self,
        structure: &Structure,
        reference: &PhaseRef,
        indices: &[i64],
    ) -> Result<usize, SetupError> {
        let Some(phase) = structure.phases.get(reference.phase) else {
            return Err(SetupError::malformed(format!("there is no phase number {}", reference.phase)));
        };
        let agent = &structure.agents[phase.agent];
        let index = index_at(reference.agent.as_ref(), indices);
        let agent_name = || format!("agent `{}`", agent.name.as_deref().unwrap_or_default());
        let member = position(agent_name, agent.family, index, &agent.place)?;
        let index = index_at(reference.index.as_ref(), indices);
        let phase_name = || format!("phase `{}`", phase.name.as_deref().unwrap_or_default());
        let position = position(phase_name, phase.family, index, &phase.place)?;
        Ok(self.phase_first[reference.phase][member] + position)
    }

    /// Which member of a phase's outputs is meant; `place` is the phase's.
    pub(crate) fn output(
        &self,
        structure: &Structure,
        phase: usize,
        output: usize,
        index: Option<i64>,
    ) -> Result<usize, SetupError> {
        let member = &self.phases[phase];
        let declared: &Phase = &structure.phases[member.phase];
        let Some(found) = declared.outputs.get(output) else {
            return Err(SetupError::malformed(format!("there is no output number {output}")));
        };
        let name = || format!("output `{}`", found.name);
        Ok(member.output_first[output] + position(name, found.family, index, &declared.place)?)
    }

    /// The variable that is a member of a declared variable.
    pub(crate) fn variable(
        &self,
        structure: &Structure,
        variable: usize,
        index: Option<i64>,
    ) -> Result<u32, SetupError> {
        let Some(declared) = structure.variables.get(variable) else {
            return Err(SetupError::malformed(format!("there is no variable number {variable}")));
        };
        let name = || format!("variable `{}`", declared.name);
        let position = position(name, declared.family, index, &declared.place)?;
        Ok(self.variable_first[variable] + narrow(position))
    }

    /// The variable that is a member of an integral.
    pub(crate) fn integral(&self, structure: &Structure, integral: usize, index: &[i64]) -> Result<u32, SetupError> {
        let Some(found) = self.integral_members.get(integral) else {
            return Err(SetupError::malformed(format!("there is no integral number {integral}")));
        };
        // Members are in the order of their indices.
        match found.binary_search_by(|member| member[..].cmp(index)).ok() {
            Some(position) => Ok(self.integral_first[integral] + narrow(position)),
            None => {
                let place = structure.integrals[integral].place.clone();
                Err(outside(format!("the integral `{}`", place.text), index, place))
            }
        }
    }

    /// Phases of an agent before the given one.
    pub(crate) fn before(&self, phase: usize) -> Range<usize> {
        self.agents[self.phases[phase].agent].phases.start..phase
    }

    fn add_agent(&mut self, structure: &Structure, agent: usize, index: Option<i64>) -> Result<(), SetupError> {
        let first = self.phases.len();
        let member = self.agents.len();
        for (phase, declared) in structure.phases.iter().enumerate().filter(|(_, p)| p.agent == agent) {
            self.phase_first[phase].push(self.phases.len());
            for index in family_members(declared.family) {
                self.add_phase(structure, phase, member, index)?;
            }
        }
        let phases = first..self.phases.len();
        self.agents.push(AgentMember { agent, index, phases, start: Time::Fixed(f64::NAN) });
        Ok(())
    }

    fn add_phase(
        &mut self,
        structure: &Structure,
        phase: usize,
        agent: usize,
        index: Option<i64>,
    ) -> Result<(), SetupError> {
        let declared = &structure.phases[phase];
        let (mut outputs, mut output_first): (Vec<OutputMember>, _) = (vec![], vec![]);
        for (output, found) in declared.outputs.iter().enumerate() {
            let spline = &found.spline;
            let knots = Knots::new(spline.order, spline.breakpoints.clone(), spline.smoothness);
            let knots = knots.map_err(|error| SetupError::Knots {
                output: format!("`{}`", found.name),
                error,
                place: declared.place.clone(),
            })?;
            let earlier = self.phases.iter().flat_map(|phase| &phase.outputs).chain(&outputs);
            let same = earlier.map(|output| &output.knots).find(|known| ***known == knots).cloned();
            let knots = same.unwrap_or_else(|| Arc::new(knots));
            output_first.push(outputs.len());
            for index in family_members(found.family) {
                outputs.push(OutputMember { output, index, knots: Arc::clone(&knots), coefficients: vec![] });
            }
        }
        let breakpoints = union(outputs.iter().map(|o| o.knots.breakpoints()));
        let common = common(structure, phase, &outputs, &output_first);
        self.number_coefficients(&mut outputs, &common);
        let duration = Time::Fixed(f64::NAN);
        self.phases.push(PhaseMember { phase, agent, index, duration, outputs, output_first, breakpoints });
        Ok(())
    }

    /// Numbers one phase's coefficients by the time at which each acts most (its Greville
    /// abscissa), outputs side by side: the order of docs/maths.md, equation 4.4.
    /// A coefficient that an output has in common with another one before it is that one's.
    fn number_coefficients(&mut self, outputs: &mut [OutputMember], common: &[Option<(usize, usize)>]) {
        let mut order: Vec<(f64, usize, usize)> = vec![];
        for (o, output) in outputs.iter_mut().enumerate() {
            let greville = output.knots.greville();
            output.coefficients = vec![0; greville.len()];
            let first = common[o].map_or(0, |(_, count)| count);
            order.extend(greville.into_iter().enumerate().skip(first).map(|(i, tau)| (tau, o, i)));
        }
        // A stable sort: coefficients of equal abscissae stay in the order of output and index.
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, o, i) in order {
            outputs[o].coefficients[i] = self.take(1);
        }
        for (o, common) in common.iter().enumerate() {
            let Some((from, count)) = *common else { continue };
            let own = outputs[from].coefficients[..count].to_vec();
            outputs[o].coefficients[..count].copy_from_slice(&own);
        }
    }

    fn number_times(&mut self, structure: &Structure) {
        for phase in 0..self.phases.len() {
            if matches!(structure.phases[self.phases[phase].phase].duration, Duration::Free(_)) {
                self.phases[phase].duration = Time::Free(self.take(1));
            }
        }
        for agent in 0..self.agents.len() {
            if matches!(structure.agents[self.agents[agent].agent].start, Start::Free(_)) {
                self.agents[agent].start = Time::Free(self.take(1));
            }
        }
    }

    fn take(&mut self, count: usize) -> u32 {
        let first = narrow(self.variables);
        self.variables += count;
        first
    }
}

/// With which other output each has its first coefficients in common, and how many (docs/maths.md, section 4.2).
///
/// Up to an end of an interval two splines on the same knots are the same exactly where all coefficients are that act
/// before it.
fn common(
    structure: &Structure,
    phase: usize,
    outputs: &[OutputMember],
    first: &[usize],
) -> Vec<Option<(usize, usize)>> {
    let mut common = vec![None; outputs.len()];
    for shared in structure.shared.iter().filter(|shared| shared.phase == phase) {
        let elements = shared.until.len();
        let members = outputs.iter().enumerate().filter(|(_, member)| member.output == shared.output);
        for (o, member) in members.filter(|(o, _)| *o >= first[shared.output] + elements) {
            let element = (o - first[shared.output]) % elements;
            let intervals = member.knots.breakpoints()[1..].iter().filter(|end| **end <= shared.until[element]).count();
            if let Some(last) = intervals.checked_sub(1) {
                let count = member.knots.support_start(last) + member.knots.order();
                common[o] = Some((first[shared.output] + element, count));
            }
        }
    }
    common
}

/// An index of a variable; the vector of variables fits into memory, so 32 bits hold it.
pub(crate) fn narrow(index: usize) -> u32 {
    u32::try_from(index).expect("fewer than 2^32 variables fit into memory")
}

/// Several indices at once that name no member.
pub(crate) fn outside(what: String, index: &[i64], place: Place) -> SetupError {
    let Family { first, last, .. } = Family::of(1, 0);
    SetupError::IndexOutOfRange {
        what: format!("{what}{index:?}"),
        index: index.first().copied().unwrap_or(0),
        first,
        last,
        place,
    }
}
