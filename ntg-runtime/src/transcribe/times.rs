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
        let durations = layout.phases.iter().map(|phase| phase.duration.fixed()).collect();
        let starts = (0..layout.phases.len()).map(|phase| layout.fixed_start(phase)).collect();
        Self { durations, starts }
    }

    /// Whether another clock says the same, bit for bit.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.durations == other.durations && self.starts == other.starts
    }

    /// Everything, for known variables.
    pub(crate) fn at(layout: &Layout, x: &[f64]) -> Self {
        let phases = 0..layout.phases.len();
        Self {
            durations: phases.clone().map(|phase| Some(layout.duration(phase, x))).collect(),
            starts: phases.map(|phase| Some(layout.start(phase, x))).collect(),
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
    for agent in 0..layout.agents.len() {
        let member = &layout.agents[agent];
        let (declared, indices) = (&structure.agents[member.agent], Vec::from_iter(member.index));
        if let Start::Fixed(call) = &declared.start {
            let start = match call {
                Some(call) => {
                    let clock = Clock::fixed(layout);
                    Frame { problem, structure, tables, layout, clock: &clock }.number(call, &indices)?
                }
                None => 0.0,
            };
            if !start.is_finite() {
                let what = format!("the start of agent `{}`", names::agent(structure, layout, agent));
                return Err(SetupError::NotFinite { what, value: start, place: declared.place.clone() });
            }
            layout.agents[agent].start = Time::Fixed(start);
        }
        for phase in layout.agents[agent].phases.clone() {
            fix_phase(problem, structure, tables, layout, phase)?;
        }
    }
    Ok(())
}

fn fix_phase(
    problem: &dyn Problem,
    structure: &Structure,
    tables: &[Table],
    layout: &mut Layout,
    phase: usize,
) -> Result<(), SetupError> {
    let declared = &structure.phases[layout.phases[phase].phase];
    let Duration::Fixed(call) = &declared.duration else { return Ok(()) };
    let clock = Clock::fixed(layout);
    let frame = Frame { problem, structure, tables, layout, clock: &clock };
    let seconds = frame.number(call, &frame.phase_indices(phase))?;
    if !(seconds.is_finite() && seconds > 0.0) {
        let phase = phase_words(structure, layout, phase);
        let lasting = frame.structure.independent.amount(seconds, |value| value.to_string());
        return Err(SetupError::Duration { phase, lasting, place: declared.place.clone() });
    }
    layout.phases[phase].duration = Time::Fixed(seconds);
    Ok(())
}

/// "phase `covert`", or "the problem" for one without phases.
pub(crate) fn phase_words(structure: &Structure, layout: &Layout, phase: usize) -> String {
    match names::phase(structure, layout, phase) {
        name if name.is_empty() => "the trajectory".into(),
        name => format!("phase `{name}`"),
    }
}
