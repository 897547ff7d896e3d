//! One output of one agent, over all of its phases or in one of them.

use super::{Inner, Solution, spaced};
use crate::transcribe::names;
use ntg_splines::Side;
use ntg_structure::Unit;
use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A flat output as a function of mission time, in its declared unit.
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
/// let solution = Move::default().solve(&Settings::default())?;
/// let x: &Trajectory = &solution.x;
/// assert!((x.at(1.0) - 0.5).abs() < 1e-6); // In its declared unit,
/// assert!((x.derivative(1.0, 1) - 0.75).abs() < 1e-6); // and in that per second.
/// assert!((x.at(99.0) - 1.0).abs() < 1e-6); // Times are clamped to its own.
/// assert_eq!(x.sample(11).len(), 11);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Trajectory {
    inner: Arc<Inner>,
    /// The phases over which it runs: all of its agent's, or one.
    phases: Range<usize>,
    name: String,
    unit: Unit,
    /// For each of these phases the member of its outputs.
    outputs: Vec<Option<usize>>,
}

impl fmt::Debug for Trajectory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Trajectory").field("name", &self.name).field("unit", &self.unit).finish()
    }
}

impl Trajectory {
    /// Its path: `x`, `uav[2].x[1]`, `covert.x` in one phase.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The declared unit, in which values are given.
    pub fn unit(&self) -> &Unit {
        &self.unit
    }

    /// Becomes the same output in another solution; false, and nothing changes, where that is of another problem.
    pub fn rebind(&mut self, solution: &Solution) -> bool {
        let is_same = self.inner.has_layout_of(&solution.inner);
        if is_same {
            self.inner = Arc::clone(&solution.inner);
        }
        is_same
    }

    /// The value at mission time `t` (seconds, clamped to its own time), in the declared unit.
    pub fn at(&self, t: f64) -> f64 {
        self.derivative(t, 0)
    }

    /// A derivative with respect to time at mission time `t`, in declared units per second to the
    /// power of `order`.
    pub fn derivative(&self, t: f64, order: usize) -> f64 {
        self.si(t, order) / self.unit.factor
    }

    /// A derivative with respect to time in SI units (docs/maths.md, equation 3.2).
    /// NaN in a phase that does not have the output.
    pub fn si(&self, t: f64, order: usize) -> f64 {
        let (layout, x) = (&self.inner.model.layout, &self.inner.x);
        let Some((phase, tau)) = self.inner.locate(&self.phases, t) else { return f64::NAN };
        let Some(output) = self.outputs[phase - self.phases.start] else { return f64::NAN };
        if tau.is_nan() {
            return f64::NAN;
        }
        let side = if tau == 1.0 { Side::Left } else { Side::Right };
        let scaled = layout.flat(phase, output, order, (tau, side), x);
        scaled / crate::math::powi(layout.duration(phase, x), i32::try_from(order).unwrap_or(i32::MAX))
    }

    /// The phase at a mission time, the scaled time in it, and the member of its outputs.
    pub(crate) fn place(&self, t: f64) -> Option<(usize, f64, usize)> {
        let (phase, tau) = self.inner.locate(&self.phases, t).filter(|(_, tau)| !tau.is_nan())?;
        Some((phase, tau, self.outputs[phase - self.phases.start]?))
    }

    /// When it starts, in seconds of mission time.
    pub fn start(&self) -> f64 {
        self.inner.model.layout.start(self.phases.start, &self.inner.x)
    }

    /// When it ends, in seconds of mission time.
    pub fn end(&self) -> f64 {
        let (layout, x) = (&self.inner.model.layout, &self.inner.x);
        self.phases.clone().fold(self.start(), |t, phase| t + layout.duration(phase, x))
    }

    /// Whether a mission time, in seconds, is within its own time. Times are sums of durations: the last one may be
    /// rounded past its own end.
    pub fn exists_at(&self, t: f64) -> bool {
        is_within(t, (self.start(), self.end()))
    }

    /// `count` values at equally spaced times over its own time, as `(t, value)`.
    pub fn sample(&self, count: usize) -> Vec<(f64, f64)> {
        spaced(self.start(), self.end(), count).into_iter().map(|t| (t, self.at(t))).collect()
    }
}

/// Whether a time is in a span, to a billionth of it.
pub(super) fn is_within(t: f64, (start, end): (f64, f64)) -> bool {
    let slack = 1e-9 * (end - start);
    t >= start - slack && t <= end + slack
}

impl Solution {
    /// Every output of every agent.
    pub fn trajectories(&self) -> Vec<Trajectory> {
        let layout = &self.inner.model.layout;
        (0..layout.agents.len())
            .flat_map(|agent| self.along(&self.agent_path(agent), layout.agents[agent].phases.clone()))
            .collect()
    }

    /// An output by its path: `x`, `x[1]`, `uav[2].x` over all phases of the agent, one continuous
    /// view; `covert.x`, `uav[2].leg[1].x` in one phase alone, up to both of its ends.
    pub fn output(&self, path: &str) -> Option<Trajectory> {
        let (structure, layout) = (&self.inner.model.structure, &self.inner.model.layout);
        let in_phase = |phase: usize| self.along(&names::phase(structure, layout, phase), phase..phase + 1);
        let in_phases = (0..layout.phases.len()).flat_map(in_phase);
        self.trajectories().into_iter().chain(in_phases).find(|t| t.name == path)
    }

    /// An output of one member of an agent.
    ///
    /// | argument | meaning                                                |
    /// |----------|--------------------------------------------------------|
    /// | `agent`  | index into `Structure::agents`                         |
    /// | `member` | its index in the spec, when the agent is a family      |
    /// | `output` | the output's name                                      |
    /// | `index`  | its index in the spec, when the output is an array     |
    pub fn trajectory(
        &self,
        agent: usize,
        member: Option<i64>,
        output: &str,
        index: Option<i64>,
    ) -> Option<Trajectory> {
        let layout = &self.inner.model.layout;
        let agent = layout.agents.iter().position(|a| a.agent == agent && a.index == member)?;
        self.of_agent(agent, output, index)
    }

    /// An output of one agent member, by position in the layout.
    pub(crate) fn of_agent(&self, agent: usize, output: &str, index: Option<i64>) -> Option<Trajectory> {
        self.one((&self.agent_path(agent), self.inner.model.layout.agents[agent].phases.clone()), output, index)
    }

    fn agent_path(&self, agent: usize) -> String {
        names::agent(&self.inner.model.structure, &self.inner.model.layout, agent)
    }

    /// An output in consecutive phases, which have a path.
    fn one(&self, (path, phases): (&str, Range<usize>), output: &str, index: Option<i64>) -> Option<Trajectory> {
        let (structure, layout) = (&self.inner.model.structure, &self.inner.model.layout);
        let (mut unit, mut family) = (None, None);
        let outputs = phases.clone().map(|phase| {
            let member = &layout.phases[phase];
            let declared = &structure.phases[member.phase].outputs;
            let found = member.outputs.iter().position(|o| o.index == index && declared[o.output].name == output)?;
            let own = &declared[member.outputs[found].output];
            unit.get_or_insert_with(|| own.unit.clone());
            family = family.or(own.family);
            Some(found)
        });
        let outputs: Vec<Option<usize>> = outputs.collect();
        let name = names::join(path, &names::member(output, family, index));
        Some(Trajectory { inner: self.inner.clone(), phases, name, unit: unit?, outputs })
    }

    /// Every output that consecutive phases of one agent have.
    fn along(&self, path: &str, phases: Range<usize>) -> Vec<Trajectory> {
        let (structure, layout) = (&self.inner.model.structure, &self.inner.model.layout);
        let mut found: Vec<Trajectory> = vec![];
        let mut known: HashMap<(&str, Option<i64>), usize> = HashMap::new(); // Looked up, never iterated.
        for phase in phases.clone() {
            let member = &layout.phases[phase];
            for (number, output) in member.outputs.iter().enumerate() {
                let declared = &structure.phases[member.phase].outputs[output.output];
                if declared.is_helper() {
                    continue;
                }
                let at = *known.entry((&declared.name, output.index)).or_insert_with(|| {
                    let name = names::join(path, &names::member(&declared.name, declared.family, output.index));
                    let (outputs, unit) = (vec![None; phases.len()], declared.unit.clone());
                    found.push(Trajectory { inner: self.inner.clone(), phases: phases.clone(), name, unit, outputs });
                    found.len() - 1
                });
                found[at].outputs[phase - phases.start].get_or_insert(number);
            }
        }
        found
    }
}
