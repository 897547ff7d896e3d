//! What a solve found, as functions of time.
//!
//! A [`Solution`] owns everything it needs and is cheap to clone. Times are mission time in
//! seconds and are clamped to the ends of the trajectory. Where a derivative jumps, its value is
//! the one from the right, at the very end the one from the left.

mod family;
mod meaning;
mod signal;
mod trajectory;
mod vector;

pub use family::Family;
pub use meaning::{Meaning, SplineView};
pub use signal::Signal;
pub use trajectory::Trajectory;
pub use vector::{Matrix, Vector};

use crate::problem::Problem;
use crate::transcribe::instances::family_members;
use crate::transcribe::rows::RowInfo;
use crate::transcribe::{Model, SetupError, Transcription, names};
use ntg_nlp::Multipliers;
use ntg_structure::{Structure, Unit};
use std::collections::HashSet;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Spline coefficients, times, variables and multipliers of a solved problem.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let found = Move::default().solve(&Settings::default())?;
/// let solution: &Solution = found.untyped(); // Everything by name, for programs that know no spec.
///
/// assert_eq!(solution.times(3), [0.0, 1.0, 2.0]);
/// assert_eq!(solution.time("T"), Some(2.0));
/// for x in solution.trajectories() {
///     println!("{} [{}]: {:?}", x.name(), x.unit().symbol, x.sample(5));
/// }
/// assert!(solution.output("y").is_none());
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Solution {
    pub(crate) inner: Arc<Inner>,
}

/// What all clones share.
pub(crate) struct Inner {
    pub(crate) model: Arc<Model>,
    pub(crate) x: Vec<f64>,
    pub(crate) rows: Vec<RowInfo>,
    /// Derivative of the minimised objective by each row's active bound, SI.
    pub(crate) row_multipliers: Vec<f64>,
    /// The same for the bounds of the variables.
    pub(crate) bound_multipliers: Vec<f64>,
    /// The typical sizes of the variables with which it was solved.
    pub(crate) sizes: Vec<f64>,
}

/// A phase and its times, in seconds of mission time.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseTimes {
    /// Its path, `uav[2].covert`; empty where neither agent nor phase has a name.
    pub name: String,
    /// When it starts.
    pub start: f64,
    /// When it ends.
    pub end: f64,
}

/// A number with its name and the unit in which it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Its name.
    pub name: String,
    /// In declared units.
    pub value: f64,
    /// The declared unit.
    pub unit: Unit,
}

impl fmt::Debug for Solution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = &self.structure().name;
        f.debug_struct("Solution").field("problem", name).field("variables", &self.inner.x.len()).finish()
    }
}

impl Solution {
    /// A point that is no solution, all unknowns at 0: what solutions of a problem have, by which names, before there is one.
    ///
    /// # Errors
    /// What is wrong with the problem and its parameters.
    pub fn unsolved(problem: &dyn Problem) -> Result<Self, SetupError> {
        let nlp = Transcription::new(problem)?;
        let (model, rows, sizes) = (nlp.model.clone(), nlp.elements.rows.clone(), nlp.limits.scale.clone());
        let x = vec![0.0; sizes.len()];
        let (row_multipliers, bound_multipliers) = (vec![0.0; rows.len()], x.clone());
        Ok(Self { inner: Arc::new(Inner { model, x, rows, row_multipliers, bound_multipliers, sizes }) })
    }

    /// What the problem is.
    pub fn structure(&self) -> &Structure {
        &self.inner.model.structure
    }

    /// Multipliers of the nonlinear program's rows, SI, of the minimised objective: positive at a lower
    /// bound, negative at an upper one.
    pub fn row_multipliers(&self) -> &[f64] {
        &self.inner.row_multipliers
    }

    /// Multipliers of the bounds of the nonlinear program's variables, in the sense of
    /// [`Solution::row_multipliers`].
    pub fn bound_multipliers(&self) -> &[f64] {
        &self.inner.bound_multipliers
    }

    /// How many constraint rows the nonlinear program has.
    pub fn rows(&self) -> usize {
        self.inner.rows.len()
    }

    /// Those of [`Solution::coefficients`] that are coefficients of splines.
    pub fn spline_coefficients(&self) -> &[f64] {
        &self.inner.x[..self.inner.model.layout.coefficients]
    }

    /// The variables of the nonlinear program in SI units: spline coefficients first.
    pub fn coefficients(&self) -> &[f64] {
        &self.inner.x
    }

    /// The start of the first agent to start, in seconds of mission time.
    pub fn start(&self) -> f64 {
        self.agent_times().fold(f64::INFINITY, |least, (start, _)| least.min(start))
    }

    /// The end of the last agent to end, in seconds of mission time.
    pub fn end(&self) -> f64 {
        self.agent_times().fold(f64::NEG_INFINITY, |most, (_, end)| most.max(end))
    }

    /// `count` equally spaced times from start to end, both included; one time is the start.
    pub fn times(&self, count: usize) -> Vec<f64> {
        spaced(self.start(), self.end(), count)
    }

    /// All phases of all agents, each agent's in order of time.
    pub fn phases(&self) -> Vec<PhaseTimes> {
        let (model, x) = (&self.inner.model, &self.inner.x);
        let layout = &model.layout;
        let starts = layout.starts(x);
        let phase = |p: usize| {
            let start = starts[p];
            let name = names::phase(&model.structure, layout, p);
            PhaseTimes { name, start, end: start + layout.duration(p, x) }
        };
        (0..layout.phases.len()).map(phase).collect()
    }

    /// Durations and event times in seconds, by name: the names of durations with the path of
    /// their agent and phase (`T`, `boost.burn`, `uav[2].T`), and `start(path)`, `end(path)`, `duration(path)` of every named phase and agent.
    pub fn event_times(&self) -> Vec<(String, f64)> {
        let (model, x) = (&self.inner.model, &self.inner.x);
        let (structure, layout) = (&model.structure, &model.layout);
        let mut found = vec![];
        let mut events = |name: &str, (start, end): (f64, f64), duration: f64| {
            if !name.is_empty() {
                found.push((format!("start({name})"), start));
                found.push((format!("end({name})"), end));
                found.push((format!("duration({name})"), duration));
            }
        };
        let (mut durations, starts) = (vec![], layout.starts(x));
        for (agent, member) in layout.agents.iter().enumerate() {
            let path = names::agent(structure, layout, agent);
            let whole: f64 = member.phases.clone().map(|p| layout.duration(p, x)).sum();
            // The end is that of its last phase, to the last bit.
            let start = member.start.at(x);
            let end = member.phases.clone().fold(start, |t, p| t + layout.duration(p, x));
            events(&path, (start, end), whole);
            match &structure.agents[member.agent].duration_name {
                Some(name) => durations.push((names::join(&path, name), whole)),
                // The one timeline without a name: its duration is called what a guess calls it.
                None if path.is_empty() && self.is_nameless(member.phases.clone()) => {
                    durations.push(("duration".to_owned(), whole));
                }
                None => {}
            }
            for phase in member.phases.clone() {
                let (own, duration) = (&layout.phases[phase], layout.duration(phase, x));
                let path = names::phase(structure, layout, phase);
                let start = starts[phase];
                events(&path, (start, start + duration), duration);
                if let Some(name) = &structure.phases[own.phase].duration_name {
                    durations.push((names::join(&path, name), duration));
                }
            }
        }
        durations.extend(found);
        // The one phase of an agent may share its duration's name with the agent.
        let mut known = HashSet::new(); // Looked up, never iterated.
        durations.retain(|(name, _)| known.insert(name.clone()));
        durations
    }

    /// Whether no phase of a stretch has a name for its duration.
    fn is_nameless(&self, phases: Range<usize>) -> bool {
        let (structure, layout) = (self.structure(), &self.inner.model.layout);
        let mut phases = phases;
        phases.all(|phase| structure.phases[layout.phases[phase].phase].duration_name.is_none())
    }

    /// All variables that the spec declares, members of arrays one by one.
    pub fn variables(&self) -> Vec<Value> {
        let model = &self.inner.model;
        let declared = model.structure.variables.iter().zip(&model.layout.variable_first);
        let declared = declared.filter(|(declared, _)| !declared.is_helper());
        let members = declared.flat_map(|(declared, first)| {
            family_members(declared.family).into_iter().enumerate().map(move |(i, index)| Value {
                name: names::member(&declared.name, declared.family, index),
                value: self.inner.x[*first as usize + i] / declared.unit.factor,
                unit: declared.unit.clone(),
            })
        });
        members.collect()
    }

    /// A declared variable by name (`m0`, `m[2]`), in its declared unit.
    pub fn variable(&self, name: &str) -> Option<f64> {
        self.variables().into_iter().find(|v| v.name == name).map(|v| v.value)
    }

    /// A time by name as in [`Solution::event_times`], in seconds.
    pub fn time(&self, name: &str) -> Option<f64> {
        self.event_times().into_iter().find(|(n, _)| n == name).map(|(_, t)| t)
    }

    /// Start and end of every agent.
    fn agent_times(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (layout, x) = (&self.inner.model.layout, &self.inner.x);
        layout.agents.iter().map(move |agent| {
            let start = agent.start.at(x);
            (start, agent.phases.clone().fold(start, |t, phase| t + layout.duration(phase, x)))
        })
    }
}

/// `count` equally spaced numbers with both ends.
pub(crate) fn spaced(start: f64, end: f64, count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1);
    let at = |i: usize| if i == last && i > 0 { end } else { start + (end - start) * i as f64 / last.max(1) as f64 };
    (0..count).map(at).collect()
}

impl Inner {
    /// A point that is no solution.
    pub(crate) fn point(model: Arc<Model>, x: Vec<f64>) -> Self {
        Self { model, x, rows: vec![], row_multipliers: vec![], bound_multipliers: vec![], sizes: vec![] }
    }

    /// The multipliers, for a solve that starts from here.
    pub(crate) fn multipliers(&self) -> Multipliers<'_> {
        Multipliers { rows: &self.row_multipliers, bounds: &self.bound_multipliers }
    }

    /// Whether another solution is of the same problem on the same mesh.
    pub(crate) fn has_layout_of(&self, other: &Self) -> bool {
        let (own, others) = (&self.model, &other.model);
        let names = |model: &Model| model.structure.named.len();
        let phases = own.layout.phases.iter().zip(&others.layout.phases);
        Arc::ptr_eq(own, others)
            || own.structure.name == others.structure.name
                && own.layout.variables == others.layout.variables
                && own.layout.phases.len() == others.layout.phases.len()
                && names(own) == names(others)
                && phases.into_iter().all(|(a, b)| a.phase == b.phase && a.outputs.len() == b.outputs.len())
    }

    /// Which of these consecutive phases holds time `t` (clamped), and the scaled time in it.
    pub(crate) fn locate(&self, phases: &Range<usize>, t: f64) -> Option<(usize, f64)> {
        let layout = &self.model.layout;
        let last = phases.clone().last()?;
        let mut start = layout.start(phases.start, &self.x);
        for phase in phases.clone() {
            let duration = layout.duration(phase, &self.x);
            if t < start + duration || phase == last {
                // At its very end a phase is over, whatever its start and duration are rounded to.
                let tau = if t >= start + duration { 1.0 } else { (t - start) / duration };
                // A time that is not a number stays one.
                return Some((phase, if tau.is_nan() { tau } else { tau.clamp(0.0, 1.0) }));
            }
            start += duration;
        }
        None
    }
}
