//! Durations and starts: the fixed ones, and all of them for known variables.
//!
//! The start of a phase is the start of its agent and the durations before it
//! (docs/maths.md, equation 3.4).

use super::error::SetupError;
use super::frame::Frame;
use super::layout::{Layout, Time};
use super::names;
use crate::problem::Problem;
use ntg_splines::Table;
use ntg_structure::{Duration, Start, Structure};

/// The durations and starts of phases that kernels may use as data: the fixed ones in a
/// transcription, also the guessed ones in a guess.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clock {
    /// One entry a phase, in seconds.
    pub(crate) durations: Vec<Option<f64>>,
    /// One entry a phase, in seconds of mission time.
    pub(crate) starts: Vec<Option<f64>>,
}

impl Clock {
    /// What is fixed.
    pub(crate) fn fixed(layout: &Layout) -> Self {
        let durations: Vec<Option<f64>> = layout.phases.iter().map(|phase| phase.duration.fixed()).collect();
        let starts = layout.agents.iter().flat_map(|agent| {
            let own = agent.phases.clone().map(|phase| durations[phase]);
            own.scan(agent.start.fixed(), |start, duration| {
                let after = start.zip(duration).map(|(start, duration)| start + duration);
                Some(std::mem::replace(start, after))
            })
        });
        let starts = starts.collect();
        Self { durations, starts }
    }

    /// Whether another clock says the same, bit for bit.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.durations == other.durations && self.starts == other.starts
    }

    /// Everything, for known variables.
    pub(crate) fn at(layout: &Layout, x: &[f64]) -> Self {
        Self {
            durations: (0..layout.phases.len()).map(|phase| Some(layout.duration(phase, x))).collect(),
            starts: layout.starts(x).into_iter().map(Some).collect(),
        }
    }
}

impl Time {
    /// The value, if it is fixed and already computed.
    pub(crate) fn fixed(self) -> Option<f64> {
        match self {
            Self::Fixed(value) if !value.is_nan() => Some(value),
            _ => None,
        }
    }

    /// The value, for known variables.
    pub(crate) fn at(self, x: &[f64]) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Free(variable) => x[variable as usize],
        }
    }
}

impl Layout {
    /// How long a phase lasts, in seconds.
    pub(crate) fn duration(&self, phase: usize, x: &[f64]) -> f64 {
        self.phases[phase].duration.at(x)
    }

    /// When a phase starts, in seconds of mission time (docs/maths.md, equation 3.4).
    pub(crate) fn start(&self, phase: usize, x: &[f64]) -> f64 {
        let start = self.agents[self.phases[phase].agent].start.at(x);
        self.before(phase).fold(start, |t, earlier| t + self.duration(earlier, x))
    }

    /// When each phase starts, as [`Layout::start`].
    pub(crate) fn starts(&self, x: &[f64]) -> Vec<f64> {
        let mut starts = Vec::with_capacity(self.phases.len());
        for agent in &self.agents {
            let mut t = agent.start.at(x);
            for phase in agent.phases.clone() {
                starts.push(t);
                t += self.duration(phase, x);
            }
        }
        starts
    }

    /// When a phase starts, if everything before it is fixed.
    pub(crate) fn fixed_start(&self, phase: usize) -> Option<f64> {
        let start = self.agents[self.phases[phase].agent].start.fixed()?;
        self.before(phase).try_fold(start, |t, earlier| Some(t + self.phases[earlier].duration.fixed()?))
    }
}

/// Computes all fixed durations and starts from parameters.
/// Finds: times that are not finite, durations that are not positive.
pub(crate) fn fix(
    problem: &dyn Problem,
    structure: &Structure,
    tables: &[Table],
    layout: &mut Layout,
) -> Result<(), SetupError> {
    let mut clock = Clock::fixed(layout);
    for agent in 0..layout.agents.len() {
        let member = &layout.agents[agent];
        let (declared, indices) = (&structure.agents[member.agent], Vec::from_iter(member.index));
        if let Start::Fixed(call) = &declared.start {
            let start = match call {
                Some(call) => Frame { problem, structure, tables, layout, clock: &clock }.number(call, &indices)?,
                None => 0.0,
            };
            if !start.is_finite() {
                let what = format!("the start of agent `{}`", names::agent(structure, layout, agent));
                return Err(SetupError::NotFinite { what, value: start, place: declared.place.clone() });
            }
            layout.agents[agent].start = Time::Fixed(start);
        }
        let mut start = layout.agents[agent].start.fixed();
        for phase in layout.agents[agent].phases.clone() {
            clock.starts[phase] = start;
            let frame = Frame { problem, structure, tables, layout, clock: &clock };
            if let Some(seconds) = fixed_duration(&frame, phase)? {
                layout.phases[phase].duration = Time::Fixed(seconds);
                clock.durations[phase] = Some(seconds);
            }
            start = start.zip(clock.durations[phase]).map(|(start, duration)| start + duration);
        }
    }
    Ok(())
}

/// How long a phase lasts, if that is fixed.
fn fixed_duration(frame: &Frame, phase: usize) -> Result<Option<f64>, SetupError> {
    let (structure, layout) = (frame.structure, frame.layout);
    let declared = &structure.phases[layout.phases[phase].phase];
    let Duration::Fixed(call) = &declared.duration else { return Ok(None) };
    let seconds = frame.number(call, &frame.phase_indices(phase))?;
    if !(seconds.is_finite() && seconds > 0.0) {
        let phase = phase_words(structure, layout, phase);
        let lasting = frame.structure.independent.amount(seconds, |value| value.to_string());
        return Err(SetupError::Duration { phase, lasting, place: declared.place.clone() });
    }
    Ok(Some(seconds))
}

/// "phase `covert`", or "the problem" for one without phases.
pub(crate) fn phase_words(structure: &Structure, layout: &Layout, phase: usize) -> String {
    match names::phase(structure, layout, phase) {
        name if name.is_empty() => "the trajectory".into(),
        name => format!("phase `{name}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{AgentMember, PhaseMember};
    use super::*;

    /// Two agents of three and two phases; variable 0 is a start, variables from 1 on are durations.
    fn layout() -> Layout {
        let mut layout = Layout::default();
        let agents = [(0..3, Time::Fixed(0.1)), (3..5, Time::Free(0))];
        for (agent, (phases, start)) in agents.into_iter().enumerate() {
            layout.agents.push(AgentMember { agent, index: None, phases, start });
        }
        let durations = [Time::Fixed(0.2), Time::Fixed(0.7), Time::Free(1), Time::Fixed(0.3), Time::Free(2)];
        layout.phases = (0..5)
            .map(|phase| PhaseMember {
                phase,
                agent: usize::from(phase >= 3),
                index: None,
                duration: durations[phase],
                outputs: vec![],
                output_first: vec![],
                breakpoints: vec![0.0, 1.0],
            })
            .collect();
        layout
    }

    #[test]
    fn the_starts_of_all_phases_are_those_of_each_bit_for_bit() {
        let (layout, x) = (layout(), [0.4, 1.1, 2.3]);
        let starts: Vec<f64> = (0..5).map(|phase| layout.start(phase, &x)).collect();
        assert_eq!(layout.starts(&x), starts);
        assert_eq!(Clock::at(&layout, &x).starts, starts.iter().copied().map(Some).collect::<Vec<_>>());
        let fixed: Vec<Option<f64>> = (0..5).map(|phase| layout.fixed_start(phase)).collect();
        assert_eq!(Clock::fixed(&layout).starts, fixed);
        assert_eq!(fixed[2..], [Some(0.1 + 0.2 + 0.7), None, None]);
    }
}
