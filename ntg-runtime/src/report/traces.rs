//! Every member of every constraint over time, with its bounds and multipliers: what plots and
//! reports show.

use super::fine::{Plan, Wanted};
use super::means::Masses;
use super::multipliers;
use crate::problem::Problem;
use crate::solution::{Inner, Solution};
use crate::transcribe::points::Point;
use crate::transcribe::rows::{RowInfo, RowKind};
use crate::transcribe::{SetupError, Transcription, names};
use ntg_structure::{Domain, Points};
use std::collections::BTreeMap;

/// One member of a constraint in one phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Index into `Structure::constraints` and `Report::constraints`.
    pub constraint: usize,
    /// The phase's path; empty without one.
    pub phase: String,
    /// The indices of the loops around it, without those of its agent and phase.
    pub indices: Vec<i64>,
    /// Mission time in seconds and value in the constraint's unit, by increasing time; both
    /// one-sided values where it jumps. The time is NaN for a constraint at no point.
    pub points: Vec<(f64, f64)>,
    /// Lower bound in the constraint's unit; minus infinity for none.
    pub lower: f64,
    /// Upper bound in the constraint's unit; infinity for none.
    pub upper: f64,
    /// Mission time and multiplier `dJ*/d(bound)` at the points of the transcription; the time is
    /// NaN for a constraint at no point.
    pub multipliers: Vec<(f64, f64)>,
    /// Whether the multipliers are densities over time (docs/maths.md, equation 9.4).
    pub density: bool,
    /// Start and end of each knot interval in mission time, or of the part of it in which the constraint holds, and the mean
    /// density of the multipliers there, those at the ends included (equation 9.4a); empty where points belong to no intervals.
    pub means: Vec<(f64, f64, f64)>,
}

impl Trace {
    /// Whether two traces are sides of one member.
    fn is_of_member(&self, other: &Self) -> bool {
        (self.constraint, &self.phase, &self.indices) == (other.constraint, &other.phase, &other.indices)
    }

    /// Takes another side of a corner into one trace: the constraint as it was written has the value of the side that is
    /// nearest to its bound, and a bound that moves moves it for all sides at once.
    fn add_side(&mut self, other: &Self) {
        let is_upper = self.upper.is_finite();
        // Between the points of the grid each side is looked at where it may be beyond its own bound.
        let mut sides = other.points.iter().peekable();
        self.points.retain_mut(|(time, value)| {
            while sides.next_if(|(before, _)| before.total_cmp(time).is_lt()).is_some() {}
            let side = sides.next_if(|(at, _)| at.total_cmp(time).is_eq());
            if let Some((_, side)) = side {
                *value = if is_upper { crate::math::max(*value, *side) } else { crate::math::min(*value, *side) };
            }
            side.is_some()
        });
        for ((_, value), (_, side)) in self.multipliers.iter_mut().zip(&other.multipliers) {
            *value += side;
        }
        for ((.., mean), (.., side)) in self.means.iter_mut().zip(&other.means) {
            *mean += side;
        }
    }
}

/// Constraint, phase member and all loop indices.
type Key = (usize, Option<usize>, Vec<i64>);

impl Solution {
    /// Every member of every constraint over time, in the order of the spec; `problem` must be
    /// the one that was solved. There are `samples` stretches for each point of the transcription.
    ///
    /// # Errors
    /// [`SetupError`], only if `problem` is another one.
    pub fn traces(&self, problem: &dyn Problem, samples: usize) -> Result<Vec<Trace>, SetupError> {
        let inner = &self.inner;
        let nlp = Transcription::with(problem, inner.model.structure.clone())?;
        let mut sets: BTreeMap<(Key, usize), Set> = BTreeMap::new();
        Plan::new(&nlp, samples.max(1))?.evaluate(&nlp, (&inner.x, Wanted::All), |checked| {
            let key = key(checked.constraint, checked.point, checked.indices);
            let set = sets.entry((key, checked.group)).or_insert(Set { bounds: checked.bounds, values: vec![] });
            set.values.push((checked.point, checked.value));
        })?;
        // A constraint that stands in several point sets (Gauss points and breakpoints) is shown
        // by the finest.
        let mut found: BTreeMap<Key, Trace> = BTreeMap::new();
        for ((key, _), mut set) in sets {
            set.sort();
            let trace = trace(inner, &key, &set);
            if found.get(&key).is_none_or(|held| held.points.len() < trace.points.len()) {
                found.insert(key, trace);
            }
        }
        let mut masses: BTreeMap<Key, Masses> = BTreeMap::new();
        let starts = inner.model.layout.starts(&inner.x);
        for (info, raw) in inner.rows.iter().zip(&inner.row_multipliers) {
            let RowKind::Constraint(constraint) = info.kind else { continue };
            let key = key(constraint, info.point, &info.indices);
            let Some(trace) = found.get_mut(&key) else { continue };
            let sense = multipliers::sense(&inner.model.structure, unit(inner, constraint));
            masses.entry(key).or_default().push(info.point, sense * raw, is_gauss(&nlp, info));
            let shown = multipliers::multiplier((&inner.model.layout, &starts), &inner.x, info, sense * raw);
            // Beside Gauss points stand breakpoints without weights, whose multipliers are no
            // densities: they are not drawn with the others.
            let comparable = trace.multipliers.is_empty() || trace.density == shown.density;
            if shown.density && !trace.density {
                trace.multipliers.clear();
                trace.density = true;
            }
            if comparable || trace.multipliers.is_empty() {
                trace.multipliers.push((shown.time.unwrap_or(f64::NAN), shown.value));
            }
        }
        let (layout, x) = (&inner.model.layout, &inner.x);
        for (key, masses) in &masses {
            let (Some(trace), Some(phase)) = (found.get_mut(key), key.1) else { continue };
            let (start, duration) = (layout.start(phase, x), layout.duration(phase, x));
            let means = masses.means(&layout.phases[phase], duration).into_iter();
            trace.means =
                means.map(|(from, to, mean)| (start + from * duration, start + to * duration, mean)).collect();
        }
        let mut traces: Vec<Trace> = vec![];
        for mut trace in found.into_values() {
            trace.multipliers.sort_by(|a, b| a.0.total_cmp(&b.0));
            let sides = inner.model.structure.constraints[trace.constraint].sides;
            trace.indices.truncate(trace.indices.len().saturating_sub(sides));
            match traces.last_mut().filter(|last| sides > 0 && last.is_of_member(&trace)) {
                Some(last) => last.add_side(&trace),
                None => traces.push(trace),
            }
        }
        Ok(traces)
    }
}

/// Whether a row stands at Gauss points.
fn is_gauss(nlp: &Transcription, info: &RowInfo) -> bool {
    let structure = &nlp.model.structure;
    let group = nlp.elements.batches.get(info.maker.0).and_then(|batch| structure.groups.get(batch.group));
    match group.map(|group| &group.domain) {
        Some(Domain::Path { phase, points, .. }) => {
            let sets = structure.phases.get(phase.phase).map(|phase| &phase.points);
            sets.and_then(|sets| sets.get(*points)).is_some_and(|set| matches!(set, Points::Gauss { .. }))
        }
        _ => false,
    }
}

fn key(constraint: usize, point: Point, indices: &[i64]) -> Key {
    (constraint, point.phase, indices.to_vec())
}

fn unit(inner: &Inner, constraint: usize) -> f64 {
    inner.model.structure.constraints[constraint].unit.factor
}

/// What was checked of one member.
struct Set {
    bounds: (f64, f64),
    values: Vec<(Point, f64)>,
}

impl Set {
    /// Puts the values in the order of time: what was looked at between the points of the grid comes behind them.
    fn sort(&mut self) {
        self.values.sort_by(|(a, _), (b, _)| a.tau.total_cmp(&b.tau));
        let values = std::mem::take(&mut self.values);
        for (point, value) in values {
            // Where the grid has both sides of a jump, what was looked at besides is one of them.
            let count = self.values.iter().rev().take_while(|(before, _)| before.tau == point.tau).count();
            if count < 2 || point.phase.is_none() {
                self.values.push((point, value));
            }
        }
    }
}

/// The trace of one member from its checked values, without multipliers.
fn trace(inner: &Inner, (constraint, phase, indices): &Key, set: &Set) -> Trace {
    let (structure, layout, x) = (&inner.model.structure, &inner.model.layout, &inner.x);
    let factor = unit(inner, *constraint);
    let phase = *phase;
    let around = phase.map_or(0, |phase| {
        let member = &layout.phases[phase];
        usize::from(layout.agents[member.agent].index.is_some()) + usize::from(member.index.is_some())
    });
    let time = |point: &Point| phase.map_or(f64::NAN, |p| layout.start(p, x) + point.tau * layout.duration(p, x));
    Trace {
        constraint: *constraint,
        phase: phase.map(|phase| names::phase(structure, layout, phase)).unwrap_or_default(),
        indices: indices.get(around..).unwrap_or(&[]).to_vec(),
        points: set.values.iter().map(|(point, value)| (time(point), value / factor)).collect(),
        lower: set.bounds.0 / factor,
        upper: set.bounds.1 / factor,
        multipliers: vec![],
        density: false,
        means: vec![],
    }
}
