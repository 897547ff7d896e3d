//! Limits that a path jumps over between two points (docs/maths.md, section 9).
//!
//! What a limit forbids may lie between two points that keep it: a band of speeds, a wall. The size of what is missed then says
//! nothing, since it is that of the band and not of the path. That the path leaves on the other side says it: at the point before
//! the limit falls towards the point after, at the point after it rises from the point before, and its gradients there point away
//! from each other. A path that cuts a corner leaves on the side on which it has come, with nearly the same gradient. And what is
//! missed is what the straight way from the one point to the other misses: a path that goes round a corner between two points misses
//! less.

use super::fine::{Checked, Key};
use crate::transcribe::Transcription;
use crate::transcribe::rows::{RowInfo, RowKind};
use crate::transcribe::slots::Source;
use ntg_nlp::{Evaluation, Outcome};
use ntg_structure::{Domain, Output};
use std::collections::BTreeMap;

/// What is missed of a limit that is jumped over is at least this part of what the straight way misses. A choice: all but a
/// twentieth of a parabola's width is as deep, and what goes round a corner misses a hundredth of what the straight way does.
const OF_STRAIGHT: f64 = 0.1;
/// The rows of inequalities along phases, gathered when the first one is asked for.
pub(super) struct Jumped<'a> {
    nlp: &'a Transcription<'a>,
    outcome: &'a Outcome,
    at: &'a Evaluation,
    /// Typical sizes of the variables.
    scale: Vec<f64>,
    /// By member, the times of its rows in order, and the rows.
    rows: Option<BTreeMap<Key, Vec<(f64, usize)>>>,
}

/// A row at one point: its value, and by slot its gradient, the slot's value and typical size.
struct Local {
    row: f64,
    slope: Vec<f64>,
    value: Vec<f64>,
    size: Vec<f64>,
}

impl<'a> Jumped<'a> {
    /// Nothing is gathered yet; `at` holds the program's first derivatives at the last point.
    pub(super) fn new(nlp: &'a Transcription<'a>, (outcome, at): (&'a Outcome, &'a Evaluation)) -> Self {
        Self { nlp, outcome, at, scale: vec![], rows: None }
    }

    /// Whether a limit that is violated at a place between two points is jumped over there.
    pub(super) fn is_jump(&mut self, checked: &Checked<'_>) -> bool {
        let (lower, upper) = checked.bounds;
        let Some(key) = checked.limit() else { return false };
        let side = if checked.value < lower { 1.0 } else { -1.0 };
        self.gather();
        let Some(own) = self.rows.as_ref().and_then(|rows| rows.get(&key)) else { return false };
        let next = own.partition_point(|(tau, _)| *tau < checked.point.tau);
        let (Some(&(_, before)), Some(&(_, after))) = (next.checked_sub(1).and_then(|i| own.get(i)), own.get(next))
        else {
            return false;
        };
        let (Some(before), Some(after)) = (self.local(before), self.local(after)) else { return false };
        let bound = if side > 0.0 { lower } else { upper };
        let missed = side * (bound - checked.value);
        missed >= OF_STRAIGHT * depth(&before, &after, (bound, side)).unwrap_or(f64::INFINITY)
    }

    fn gather(&mut self) {
        if self.rows.is_some() {
            return;
        }
        let mut rows: BTreeMap<Key, Vec<(f64, usize)>> = BTreeMap::new();
        for (row, info) in self.nlp.elements.rows.iter().enumerate() {
            let (RowKind::Constraint(constraint), Some(phase)) = (info.kind, info.point.phase) else { continue };
            if self.nlp.limits.row_lower[row] < self.nlp.limits.row_upper[row] {
                rows.entry((constraint, info.indices.clone(), phase)).or_default().push((info.point.tau, row));
            }
        }
        rows.values_mut().for_each(|own| own.sort_by(|one, other| one.0.total_cmp(&other.0)));
        self.scale = self.nlp.grown_sizes(&self.outcome.x);
        self.rows = Some(rows);
    }

    /// A row at its point; none where the row is not along a phase, or depends on what may jump by itself, as an input does.
    fn local(&self, row: usize) -> Option<Local> {
        let (number, e, function) = self.nlp.elements.rows[row].maker;
        let (block, values) = (self.nlp.elements.blocks.get(number)?, self.at.blocks.get(number)?);
        let structure = &self.nlp.model.structure;
        let batch = self.nlp.elements.batches.get(number)?;
        let mut local = Local {
            row: self.at.rows[row],
            slope: vec![0.0; block.slots],
            value: vec![0.0; block.slots],
            size: vec![0.0; block.slots],
        };
        if !matches!(structure.groups[batch.group].domain, Domain::Path { .. }) {
            return None;
        }
        let sources = batch.batch.sources();
        let declared = |slot: usize| declared(self.nlp, sources.get(slot)?);
        let variables = block.variables(e);
        for (entry, &(_, slot)) in block.jacobian.iter().enumerate().filter(|(_, (of, _))| *of == function) {
            if declared(slot).is_some_and(may_jump) {
                return None;
            }
            let map = block.map(e).chunks_exact(variables.len().max(1)).nth(slot)?;
            let sum: f64 = variables.iter().zip(map).map(|(j, c)| c * self.outcome.x[*j as usize]).sum();
            let typical = variables.iter().zip(map).find(|(_, c)| **c != 0.0);
            local.slope[slot] =
                block.weight[function * block.elements + e] * values.jacobian[entry * block.elements + e];
            local.value[slot] = sum + block.offset[slot * block.elements + e];
            local.size[slot] = typical.map_or(0.0, |(j, _)| self.scale[*j as usize]);
        }
        // Places are compared by one measure, whatever each of their coordinates varies by.
        let kind = |slot: usize| declared(slot).map(|(output, derivative)| (&output.unit, derivative));
        let own = local.size.clone();
        for (slot, size) in local.size.iter_mut().enumerate() {
            let alike = (0..block.slots).filter(|other| kind(slot).is_some() && kind(*other) == kind(slot));
            *size = alike.fold(*size, |most, other| most.max(own[other]));
        }
        Some(local)
    }
}

/// Whether a constraint depends on nothing along phases that may jump by itself, as an input does.
pub(super) fn is_continuous(nlp: &Transcription, constraint: usize) -> bool {
    has_only(nlp, constraint, &|of| !may_jump(of))
}

/// Whether a constraint depends on nothing along phases but what equations of motion move: neither inputs nor highest derivatives.
pub(super) fn is_of_states(nlp: &Transcription, constraint: usize) -> bool {
    has_only(nlp, constraint, &|(output, derivative)| derivative < output.spline.smoothness)
}

/// Whether all outputs and derivatives on which a constraint depends along phases are of a kind.
fn has_only(nlp: &Transcription, constraint: usize, kind: &dyn Fn((&Output, usize)) -> bool) -> bool {
    let own = |info: &&RowInfo| {
        matches!(info.kind, RowKind::Constraint(of) if of == constraint) && info.point.phase.is_some()
    };
    nlp.elements.rows.iter().filter(own).all(|info| {
        let (number, _, function) = info.maker;
        let (Some(block), Some(batch)) = (nlp.elements.blocks.get(number), nlp.elements.batches.get(number)) else {
            return false;
        };
        let sources = batch.batch.sources();
        let mut slots = block.jacobian.iter().filter(|(of, _)| *of == function).map(|(_, slot)| *slot);
        slots.all(|slot| sources.get(slot).and_then(|source| declared(nlp, source)).is_none_or(kind))
    })
}

/// The output that a slot is of, and which derivative by time.
fn declared<'n>(nlp: &'n Transcription, source: &Source) -> Option<(&'n Output, usize)> {
    let &Source::Flat { phase, output, derivative, .. } = source else { return None };
    let phase = &nlp.model.layout.phases[phase];
    Some((&nlp.model.structure.phases[phase.phase].outputs[phase.outputs[output].output], derivative))
}

/// Whether an output's derivative by time may jump by itself, as an input does.
pub(super) fn may_jump((output, derivative): (&Output, usize)) -> bool {
    derivative >= output.spline.smoothness && output.spline.breakpoints.len() > 2
}

/// By how much the straight way from one point to another misses a limit, which allows what is above its bound with side 1 and
/// below it with -1. None where the limit does not fall on the way from the one and rise towards the other, with gradients that
/// point away from each other. On the way the limit is the cubic with the values and slopes of both ends.
fn depth(before: &Local, after: &Local, (bound, side): (f64, f64)) -> Option<f64> {
    let slots = before.slope.len().min(after.slope.len());
    let (mut falls, mut rises, mut along) = (0.0, 0.0, 0.0);
    for slot in 0..slots {
        let way = after.value[slot] - before.value[slot];
        falls += side * before.slope[slot] * way;
        rises += side * after.slope[slot] * way;
        along += before.slope[slot] * after.slope[slot] * before.size[slot] * before.size[slot];
    }
    let [first, last] = [before, after].map(|of| side * (of.row - bound));
    let least = least_of_cubic((first, last), (falls, rises));
    (falls < 0.0 && rises > 0.0 && along < 0.0 && least < 0.0).then_some(-least)
}

/// The least value between 0 and 1 of the cubic with these values and slopes there, of which the first slope falls and the
/// last one rises. At places alone the least value of a path that crosses hundreds of radii in a step is far above it.
fn least_of_cubic((first, last): (f64, f64), (falls, rises): (f64, f64)) -> f64 {
    let change = last - first;
    let (cube, square) = (falls + rises - 2.0 * change, 3.0 * change - 2.0 * falls - rises);
    // The root of 3 cube t^2 + 2 square t + falls at which it rises, without cancellation: falls is negative.
    let root = (square * square - 3.0 * cube * falls).max(0.0).sqrt();
    let lowest = if square >= 0.0 { -falls / (square + root) } else { (root - square) / (3.0 * cube) };
    let t = if lowest.is_finite() { lowest.clamp(0.0, 1.0) } else { 0.5 };
    first + t * (falls + t * (square + t * cube))
}

#[cfg(test)]
mod tests {
    use super::{Local, depth, least_of_cubic};

    #[test]
    fn the_least_value_of_a_cubic_is_exact() {
        // (t - 0.3)^2 - 0.01 and t^3 - t.
        assert!((least_of_cubic((0.08, 0.48), (-0.6, 1.4)) + 0.01).abs() < 1e-15);
        let known = -2.0 / 27.0_f64.sqrt();
        assert!((least_of_cubic((0.0, 0.0), (-1.0, 2.0)) - known).abs() < 1e-15);
        // The last slope alone is that of a minimum near the start.
        assert!((least_of_cubic((0.0, 0.0), (-2.0, 1.0)) - known).abs() < 1e-15);
    }

    #[test]
    fn a_way_of_a_thousand_radii_goes_through_a_disc() {
        let through = depth(&disc(-1000.3, 0.1), &disc(1700.0, 0.1), (1.0, 1.0)).expect("it is jumped over");
        assert!((through - 0.99).abs() < 1e-6, "{through}");
    }

    /// The square of the distance from the origin.
    fn disc(x: f64, y: f64) -> Local {
        Local { row: x * x + y * y, slope: vec![2.0 * x, 2.0 * y], value: vec![x, y], size: vec![1.0; 2] }
    }

    #[test]
    fn the_straight_way_through_a_disc_misses_its_depth() {
        let through = depth(&disc(-1.0, 0.1), &disc(1.0, 0.1), (1.0, 1.0)).expect("it is jumped over");
        assert!((through - 0.99).abs() < 1e-12, "{through}");
        assert_eq!(depth(&disc(-0.3, 0.96), &disc(0.3, 0.96), (1.0, 1.0)), None, "it cuts the side");
        assert_eq!(depth(&disc(-1.0, 0.1), &disc(1.0, 0.2), (1.2, -1.0)), None, "within a disc nothing is between");
    }
}
