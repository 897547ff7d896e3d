//! What violations of bounds of 0 are relative to (docs/maths.md, equations 9.3a and 9.3b).

use super::jumped::may_jump;
use crate::transcribe::Transcription;
use ntg_nlp::{Block, Evaluation, Outcome, Target};
use ntg_structure::{Domain, Row, Slot};
use std::collections::BTreeMap;

/// What is below this part of its typical size all along the solution is noise, and no size. A law: what the tolerance of
/// 1e-8 leaves of it is then at most a thousandth.
const SMALL: f64 = 1e-5;
/// A size between the points is at least this part of the size at the points. A choice: what varies by less, beside terms
/// that cancel, is at rest, and what is missed of it is no motion that the points do not see.
const LEAST_BETWEEN: f64 = 1e-4;
/// A rate counts as at least this part of what the typical size of its output is over the whole phase. A choice: where an
/// output moves by less, as in a phase whose length is all but 0, nothing is missed.
const LEAST_RATE: f64 = 1e-3;

/// A limit whose terms and value vary by less than this part of the size at the points is active all along, and has that
/// size. A choice: what a limit varies by may be next to nothing there, and no overshoot is large beside the limit.
const LEAST_RANGE: f64 = 3e-4;

/// A slope that keeps its sign and varies by no more than this factor makes a term of a row that is posed in another form than it
/// is written in as good as linear. A choice: by the width of a cone (18.4) the slope is 1 at the bound and 1/2 far within it.
const BENT: f64 = 3.0;

/// A slope that varies by no more than this factor makes the term of an input as good as linear in any row: the force in `f / v` at
/// a speed that is held. A choice: a percent.
const STEADY: f64 = 1.01;

/// A limit with two sides has the size of what the side varies by that varies by less, and at least this part of the other
/// size. A choice: the points may not see a hill, and what is missed by 3e-5 of all is no hill.
const LEAST_SIDE: f64 = 3e-3;

/// A variable that is a bound counts for at least this part of what the limit varies by. A choice: a least peak of what can be
/// followed exactly is what the mesh leaves of it, 1e-4 to 1e-2 of all, and means nothing.
const LEAST_BOUND: f64 = 3e-2;

/// Below this part of the size of its terms what an equation says is 0, as `sin(pi)`, and so is what is missed of it. A law:
/// rounding of some terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The sizes of one member of a constraint, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    at_points: f64,
    between: f64,
    rounding: f64,
}

/// What violations of a member of a constraint are relative to, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measure {
    pub(crate) size: f64,
    /// What rounding leaves of it: no less is missed.
    pub(crate) rounding: f64,
}

/// What violations are relative to, SI, by constraint and the indices of its member.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sizes(BTreeMap<(usize, Vec<i64>), Size>);

/// The terms of one relation along the solution.
#[derive(Clone, Debug, Default)]
struct Terms {
    /// The largest derivative by a slot times the size of the slot's value.
    largest: f64,
    /// The largest term of a derivative by time.
    rate: f64,
    /// What a rate is at least.
    least: f64,
    /// The largest sum of terms that a rate is the difference of.
    cancelled: f64,
    /// The largest variation of a term in which a slot stands linearly.
    variation: f64,
    /// The same with terms whose slope is the same at all points, in a block with rows in which their slot is curved.
    steady: f64,
    /// Of a limit: the largest term that a declared variable is, as a number in its place would be its bound.
    bound: f64,
    /// The steepest slope of a row by a variable of its size.
    slope: f64,
    /// Of an equation that holds at single points: what it says, if more is missed than rounding.
    value: f64,
    /// Of a limit: the least and the largest value at the points.
    limited: Option<(f64, f64)>,
    /// Of rows that have linear slots and others: the least and the largest value of what is left without the linear terms.
    rest: Option<(f64, f64)>,
}

impl Terms {
    fn size(&self) -> Option<Size> {
        let at_points = [self.largest, self.slope].into_iter().find(|size| *size > 0.0)?;
        if self.value > ROUNDING * at_points {
            return Some(Size { at_points: self.value, between: self.value, rounding: 0.0 });
        }
        // Of a sine of a thousand turns the slope times the angle says nothing, nor an offset of a temperature.
        let mut seen = self.rate.max(self.variation);
        if seen < LEAST_BETWEEN * at_points {
            // What is at rest is held by what varies: a temperature by the heat that is taken away.
            seen = seen.max(self.steady);
        }
        let between: f64 = match self.limited {
            _ if self.rate > 0.0 => seen.min(at_points).max(LEAST_BETWEEN * at_points).max(self.least),
            // Neither a height above the sea nor the slope of a wall says how high the wall is.
            Some((low, high)) if seen.max(high - low) > LEAST_RANGE * at_points => {
                let whole = seen.max(high - low).min(at_points);
                self.rest.map_or(whole, |(low, high)| with_side(whole, self.variation.min(high - low)))
            }
            _ => at_points,
        };
        let bound = self.limited.map_or(0.0, |_| self.bound.min(at_points));
        let between = if bound > 0.0 { bound.max(LEAST_BOUND * between) } else { between };
        Some(Size { at_points, between, rounding: ROUNDING * self.cancelled })
    }
}

/// The size of a limit of which one side varies by this much, and all of it by `whole`.
pub(super) fn with_side(whole: f64, side: f64) -> f64 {
    side.clamp(LEAST_SIDE * whole, whole)
}

/// Adds what the equations of a block say whose constraints hold at single points, where more is missed than rounding.
fn add_values(nlp: &Transcription, (outcome, at): (&Outcome, &Evaluation), block: &Block, terms: &mut [Terms]) {
    let limits = &nlp.limits;
    for target in &block.target {
        let Target::Row(row) = *target else { continue };
        let (row, relation) = (row as usize, nlp.elements.relations.of_row[row as usize] as usize);
        let missed = (at.rows[row] - limits.row_lower[row]).abs() * outcome.row_factors[row];
        if limits.row_lower[row] == limits.row_upper[row] && missed > ROUNDING {
            terms[relation].value = limits.row_lower[row].abs();
        }
    }
}

/// What a slot is in the rows of a block.
#[derive(Clone, Copy)]
struct Kind {
    /// A derivative by time.
    is_rate: bool,
    /// No second derivative depends on it.
    is_linear: bool,
    /// A declared variable.
    is_variable: bool,
    /// An input, or what may jump as one.
    is_input: bool,
}

/// The least and largest value of each term of each relation of a block, of its slope and of its slot.
struct Ranges {
    /// The first relation of the block.
    first: usize,
    /// How many terms each has.
    terms: usize,
    /// By relation, from the first on, and term.
    ranges: Vec<[(f64, f64); 3]>,
}

impl Ranges {
    /// No values yet; `relations` are those of all rows.
    fn of(block: &Block, relations: &[u32]) -> Self {
        let own = || {
            block.target.iter().filter_map(|target| match target {
                Target::Row(row) => Some(relations[*row as usize] as usize),
                Target::Objective => None,
            })
        };
        let (first, terms) = (own().min().unwrap_or(0), block.jacobian.len());
        let count = own().max().map_or(0, |last| last + 1 - first);
        Self { first, terms, ranges: vec![[(f64::INFINITY, f64::NEG_INFINITY); 3]; count * terms] }
    }

    fn add(&mut self, (relation, term): (usize, usize), (slope, value): (f64, f64)) {
        let ranges = &mut self.ranges[(relation - self.first) * self.terms + term];
        for (range, own) in ranges.iter_mut().zip([slope * value, slope, value]) {
            *range = (range.0.min(own), range.1.max(own));
        }
    }

    /// Raises the variations of relations to those of these terms, of which a curved one counts where it is nearly linear in a row
    /// that is posed in another form.
    fn raise(&self, all: &mut [Terms], is_posed: &[bool], kind: impl Fn(usize) -> Kind) {
        let relations = all.iter_mut().zip(is_posed).skip(self.first);
        for ((own, is_posed), ranges) in relations.zip(self.ranges.chunks_exact(self.terms.max(1))) {
            for (term, [(low, high), (flat, steep), (least, most)]) in ranges.iter().enumerate() {
                let bent = if flat * steep > 0.0 {
                    flat.abs().max(steep.abs()) / flat.abs().min(steep.abs())
                } else {
                    f64::INFINITY
                };
                let kind = kind(term);
                if kind.is_linear || *is_posed && bent <= BENT {
                    own.variation = own.variation.max(high - low);
                    if kind.is_variable && low <= high {
                        own.bound = own.bound.max(low.abs()).max(high.abs());
                    }
                } else if kind.is_input && bent <= STEADY {
                    own.variation = own.variation.max(steep.abs().max(flat.abs()) * (most - least));
                }
                if flat == steep {
                    own.steady = own.steady.max(high - low);
                }
            }
        }
    }
}

/// A slot at a point.
#[derive(Clone, Copy)]
struct SlotValue {
    value: f64,
    /// The typical size of the variable that it is made of.
    typical: f64,
    /// The part of it that a rate is at least, where the phase is so short that a smaller one changes rates of lower order.
    most: f64,
    /// The sum of the terms that it is the difference of.
    cancelled: f64,
}

/// Which part of its mission each phase is.
fn parts(nlp: &Transcription, x: &[f64]) -> Vec<f64> {
    let layout = &nlp.model.layout;
    let durations: Vec<f64> = (0..layout.phases.len()).map(|phase| layout.duration(phase, x)).collect();
    let whole = |agent: usize| layout.agents[agent].phases.clone().map(|phase| durations[phase]).sum::<f64>();
    layout.phases.iter().zip(&durations).map(|(phase, duration)| duration / whole(phase.agent)).collect()
}

impl Sizes {
    /// The sizes of the members of all trajectory constraints along the solution; where all terms are 0, and elsewhere than along a
    /// trajectory, of what integrals are in too, the largest slope of the member's rows. `at` holds first derivatives where they are
    /// finite, and zeros elsewhere.
    pub(super) fn at(nlp: &Transcription, (outcome, at): (&Outcome, &Evaluation)) -> Self {
        let relations = &nlp.elements.relations;
        let scale = nlp.grown_sizes(&outcome.x);
        let mut terms = vec![Terms::default(); relations.count()];
        let (groups, shown) = (&nlp.model.structure.groups, nlp.model.structure.constraints_shown());
        let mut is_posed = vec![false; relations.count()];
        relations.of_constraints().for_each(|(c, _, relation)| is_posed[relation] = shown.get(c) == Some(&true));
        let parts = parts(nlp, &outcome.x);
        let blocks = nlp.elements.batches.iter().zip(nlp.elements.blocks.iter().zip(&at.blocks));
        for (batch, (block, values)) in blocks {
            let group = &groups[batch.group];
            if !matches!(group.domain, Domain::Path { .. }) {
                add_values(nlp, (outcome, at), block, &mut terms);
                continue;
            }
            let order = |slot: usize| match group.call.slots.get(slot) {
                Some(Slot::Flat { derivative, .. }) => *derivative,
                _ => 0,
            };
            let is_rate = |slot: usize| order(slot) > 0;
            let is_linear = |slot: usize| block.hessian.iter().all(|(i, j)| *i != slot && *j != slot);
            let is_variable = |slot: usize| matches!(group.call.slots.get(slot), Some(Slot::Variable { .. }));
            let is_input = |slot: usize| match group.call.slots.get(slot) {
                Some(Slot::Flat { phase, output, derivative: 0, .. }) => {
                    may_jump((&nlp.model.structure.phases[phase.phase].outputs[*output], 0))
                }
                _ => false,
            };
            let kind = |slot| Kind {
                is_rate: is_rate(slot),
                is_linear: is_linear(slot),
                is_variable: is_variable(slot),
                is_input: is_input(slot),
            };
            let kinds: Vec<Kind> = (0..block.slots).map(kind).collect();
            let mut ranges = Ranges::of(block, &relations.of_row);
            let has_slots = |row: usize, linear: bool| {
                block
                    .jacobian
                    .iter()
                    .any(|(of, slot)| *of == row && !kinds[*slot].is_rate && kinds[*slot].is_linear == linear)
            };
            // A part of an integral is no term of the row that it adds to, which holds at no point.
            let is_term = |row: usize| matches!(group.rows[row], Row::Constraint { .. });
            let is_two_sided = |row: usize| is_term(row) && has_slots(row, true) && has_slots(row, false);
            let two_sided: Vec<bool> = (0..block.rows).map(is_two_sided).collect();
            let (mut slots, mut rest) = (vec![], vec![0.0; block.rows]);
            for e in 0..block.elements {
                let variables = block.variables(e);
                let part = batch.batch.sites[e].point.phase.map_or(1.0, |phase| parts[phase]);
                slots.clear();
                slots.extend(block.map(e).chunks_exact(variables.len().max(1)).enumerate().map(|(slot, map)| {
                    let parts = || variables.iter().zip(map).map(|(j, c)| c * outcome.x[*j as usize]);
                    let (value, cancelled): (f64, f64) = (parts().sum(), parts().map(f64::abs).sum());
                    let typical = variables.iter().zip(map).find(|(_, c)| **c != 0.0);
                    // No rate is noise that changes the rate of the next lower order, of which the mission tells a size.
                    let most = part.powi(i32::try_from(order(slot).saturating_sub(1)).unwrap_or(0));
                    let typical = typical.map_or(0.0, |(j, _)| scale[*j as usize]);
                    SlotValue { value, typical, most, cancelled }
                }));
                for (row, rest) in rest.iter_mut().enumerate() {
                    let lane = row * block.elements + e;
                    *rest = block.weight[lane] * values.values[lane];
                }
                for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                    let lane = row * block.elements + e;
                    let Target::Row(target) = block.target[lane] else { continue };
                    if !is_term(row) {
                        continue;
                    }
                    let relation = relations.of_row[target as usize] as usize;
                    let slope = block.weight[lane] * values.jacobian[entry * block.elements + e];
                    let SlotValue { value, typical, most, cancelled } = slots[slot];
                    let term = (slope * value.abs().max(SMALL.min(most) * typical)).abs();
                    if !term.is_finite() {
                        continue;
                    }
                    let own = &mut terms[relation];
                    own.largest = own.largest.max(term);
                    match kinds[slot] {
                        Kind { is_rate: true, .. } => {
                            own.rate = own.rate.max(term);
                            own.cancelled = own.cancelled.max((slope * cancelled).abs());
                            own.least = own.least.max((slope * LEAST_RATE.min(most) * typical).abs());
                        }
                        Kind { is_linear: true, .. } => {
                            ranges.add((relation, entry), (slope, value));
                            rest[row] -= slope * value;
                        }
                        _ => ranges.add((relation, entry), (slope, value)),
                    }
                }
                for (row, rest) in rest.iter().enumerate().filter(|(row, rest)| two_sided[*row] && rest.is_finite()) {
                    let Target::Row(target) = block.target[row * block.elements + e] else { continue };
                    let (low, high) =
                        terms[relations.of_row[target as usize] as usize].rest.get_or_insert((*rest, *rest));
                    (*low, *high) = (low.min(*rest), high.max(*rest));
                }
            }
            ranges.raise(&mut terms, &is_posed, |entry| kinds[block.jacobian[entry].1]);
        }
        let bounds = nlp.limits.row_lower.iter().zip(&nlp.limits.row_upper);
        for ((relation, value), (lower, upper)) in relations.of_row.iter().zip(&at.rows).zip(bounds) {
            if lower < upper && value.is_finite() {
                let (low, high) = terms[*relation as usize].limited.get_or_insert((*value, *value));
                (*low, *high) = (low.min(*value), high.max(*value));
            }
        }
        for (relation, factor) in relations.of_row.iter().zip(&outcome.row_factors) {
            if factor.is_finite() && *factor > 0.0 {
                let own = &mut terms[*relation as usize];
                own.slope = own.slope.max(1.0 / factor);
            }
        }
        let known = relations.of_constraints();
        Self(
            known.filter_map(|(c, indices, relation)| Some(((c, indices.to_vec()), terms[relation].size()?))).collect(),
        )
    }

    /// The size of a member of a constraint at the points; the constraint's unit where none is known.
    pub(super) fn at_points(&self, nlp: &Transcription, constraint: usize, indices: &[i64]) -> Measure {
        self.of(nlp, constraint, indices, |size| size.at_points)
    }

    /// The size between the points.
    pub(super) fn between(&self, nlp: &Transcription, constraint: usize, indices: &[i64]) -> Measure {
        self.of(nlp, constraint, indices, |size| size.between)
    }

    fn of(&self, nlp: &Transcription, constraint: usize, indices: &[i64], which: impl Fn(&Size) -> f64) -> Measure {
        let known = self.0.get(&(constraint, indices.to_vec()));
        let measure = known.map(|size| Measure { size: which(size), rounding: size.rounding });
        let unit = || nlp.model.structure.constraints[constraint].unit.factor;
        measure.unwrap_or_else(|| Measure { size: unit(), rounding: 0.0 })
    }
}
