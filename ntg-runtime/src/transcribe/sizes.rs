//! Typical sizes of what is guessed to be 0 (docs/maths.md, equations 5.5, 5.7 and 5.8).
//!
//! Takes a guess, the first derivatives there, and bounds; gives sizes by *propagation*: what is not 0 in the guess has
//! its own size, a row is as large as its largest term, and what is 0 in the guess is so large that it balances the rows
//! in which it stands. What has no slope there either, such as a coordinate of a speed, is so large that its curvature
//! balances them. Units cannot matter, because a slope of a row times a size has the unit of the row.

use super::durations::Trial;
use super::rows::bound_size;
use super::{Transcription, Workspace};
use ntg_nlp::scaling::beside;
use ntg_nlp::{Block, Evaluation, Nlp, Target};
use std::collections::BTreeMap;
use std::ops::Range;

/// What a limit of 0 leaves where all is slow counts so many times: elsewhere than at the guess it may leave more, and motions that
/// are too fast are nearer to the fastest one than those that are too slow, beside which any detour is as good. A fit to
/// `bench/families/run --only media --count 60 --seed 900`, which takes 7973, 4313, 2504 and 2470 iterations with 1, 8, 16 and 30.
const ROOM: f64 = 30.0;

/// Sizes below this fraction of what balances their constraints are rounding.
const ROUNDING: f64 = 1e-10;

/// A guess and a bound that are so small beside the unit may be rounding, as `10 * cos(90 [deg])` is: whether they are, other
/// constraints tell. A choice: what they tell does not hang on it.
const DOUBTFUL: f64 = 1e-6;
/// A bound below this part of a size that other constraints tell is met anyway, and tells no size. A law: the tolerance.
const MET: f64 = 1e-8;

/// A guess below this part of the unit may be one of someone who means a little more than 0, `guess { x = 1e-6; }`, and below the
/// second part of what other constraints tell it is. Choices: a size that is too small by less does little harm.
pub(super) const SMALL_GUESS: f64 = 1e-2;
const MUCH_SMALLER: f64 = 1e-3;

/// A bound so many times as large as what other constraints tell is no size. A choice: bounds that mean something are within it.
const FAR_BOUND: f64 = 1e4;

/// An integral whose value is less than the first fraction of its value beside the point is as large as that fraction of it;
/// less than the second, it is stationary at the point but for rounding. Those of the objective (5.3).
const LEAST_AT_POINT: f64 = 1e-2;
const STATIONARY: f64 = 1e-6;
/// The part of the way to the point beside on which slope and curvature of an integral are taken. A choice: where that point is
/// ten times as far as what is raised to the power of 20, the power changes by a fifth.
const NEARBY: f64 = 1e-3;

/// What shares a size (an output in all phases of an agent, a variable, a duration), and all constraints in which it
/// stands. Every member of a constraint counts as one of its own: members may differ in size by any factor.
#[derive(Clone, Debug, Default)]
pub(super) struct Balance {
    /// The group of each variable.
    group: Vec<usize>,
    /// The size of each group; none where it is not known yet.
    size: Vec<Option<f64>>,
    /// Whether a group is an integral, which has its size from the integral's values alone.
    is_integral: Vec<bool>,
    /// A bound of the group's own variables; 0 where there is none.
    own_bound: Vec<f64>,
    /// Bounds of each group alone that are not above this tell no size.
    nothing: Vec<f64>,
    /// For each group the constraints in which it stands, with the largest slope by a slot of the group.
    constraints: Vec<Vec<(usize, f64)>>,
    /// For each constraint the groups in it, with slopes.
    groups: Vec<Vec<(usize, f64)>>,
    /// As `groups`, each slot of a group by itself: a rate, and what it is proportional to.
    terms: Vec<Vec<(usize, f64)>>,
    /// For each constraint its largest finite bound; 0 where there is none.
    bound: Vec<f64>,
    /// For each constraint its largest value at the guess by absolute value.
    value: Vec<f64>,
    /// Whether a constraint is an inequality.
    is_inequality: Vec<bool>,
    /// The constraint of each row.
    constraint_of: Vec<usize>,
    /// The objective's size by slopes and known sizes.
    objective: f64,
    /// For pairs of groups the `k` of the largest term `k d_l d_m` beside the size of its constraint.
    curvature: BTreeMap<(usize, usize), f64>,
}

/// Groups with the sizes that were found for them.
pub(super) type Sizes = Vec<(usize, f64)>;

/// The group of a slot of an element: that of its first variable.
pub(super) fn slot_group(block: &Block, e: usize, slot: usize, balance: &Balance) -> Option<usize> {
    let variables = block.variables(e);
    let coefficients = &block.map(e)[slot * variables.len()..][..variables.len()];
    let first = coefficients.iter().position(|c| *c != 0.0)?;
    Some(balance.group[variables[first] as usize])
}

impl Transcription<'_> {
    /// Replaces the sizes of all groups that are 0 in the guess, by the slopes at a point, which may be that guess.
    /// `groups` are variables that share a size; every other variable is a group of its own.
    /// False, and nothing is replaced, where something is not finite at the point.
    pub(super) fn balance_sizes(&self, groups: &[Vec<u32>], (x, guess): (&[f64], &[f64]), scale: &mut [f64]) -> bool {
        let mut balance = self.balance(groups, guess);
        let (mut workspace, mut at) = self.workspace();
        let multipliers = vec![0.0; self.elements.rows.len()];
        if self.derivatives(x, 1.0, &multipliers, &mut workspace, &mut at).is_err() {
            return false;
        }
        let units = self.units();
        self.take_slopes_of_norms(x, &units, &mut workspace, &mut at);
        self.collect_slopes(&at, &mut balance);
        let guessed = balance.size.clone();
        self.forget_doubtful((x, scale, &units), &at, &mut balance);
        balance.forget_rounding();
        let known = balance.size.clone();
        self.find_sizes((x, scale), &at, &mut balance);
        self.size_by_minimum(x, &at, &mut balance);
        balance.forget_far_bounds(&known);
        for ((scale, unit), &group) in scale.iter_mut().zip(units).zip(&balance.group) {
            match balance.size[group] {
                Some(size) if known[group].is_none() => *scale = size,
                None if guessed[group].is_some() => *scale = unit,
                _ => {}
            }
        }
        true
    }

    /// By how many decades the terms of equations differ in size, in sum: of each the largest from the next, and of each
    /// inequality the largest from the bound that it exceeds; with the objective of a motion of the sizes that balance them.
    /// Durations are no terms: they stand in those of derivatives. Where it is `by_rates`, a rate is a term beside what it is
    /// proportional to. `room` is what each row leaves where all is slow: the bound of a limit of 0. None where something is not
    /// finite.
    pub(super) fn imbalance(
        &self,
        (x, groups, room): (&[f64], &[Vec<u32>], &[f64]),
        by_rates: bool,
        (workspace, at): (&mut Workspace, &mut Evaluation),
    ) -> Option<Trial> {
        self.derivatives(x, 1.0, &vec![0.0; self.elements.rows.len()], workspace, at).ok()?;
        let here = at.rows.clone();
        let mut balance = self.balance(groups, x);
        let durations: Vec<usize> = self.durations.iter().map(|d| balance.group[d.variable as usize]).collect();
        durations.iter().for_each(|group| balance.own_bound[*group] = 0.0);
        self.collect_slopes(at, &mut balance);
        balance.forget_rounding();
        balance.propagate(&[Balance::balanced]);
        let mut decades: Vec<f64> =
            (0..balance.groups.len()).map(|constraint| balance.decades(constraint, &durations, by_rates)).collect();
        // From the guess there and back again, by the size of each output.
        let mut motion = x.to_vec();
        for variables in groups {
            let (last, size) = (variables.len().max(2) - 1, balance.size[balance.group[variables[0] as usize]]);
            for (i, variable) in variables.iter().enumerate() {
                let part = i as f64 / last as f64;
                motion[*variable as usize] += 4.0 * part * (1.0 - part) * size.unwrap_or(0.0);
            }
        }
        self.values(&motion, workspace, at).ok()?;
        // What is flat at the guess, as a square of speeds at rest, is exceeded by the motion.
        for (row, constraint) in balance.constraint_of.iter().enumerate().filter(|own| balance.is_inequality[*own.1]) {
            let (lower, upper) = (self.limits.row_lower[row], self.limits.row_upper[row]);
            let missed = |value: f64| (lower - value).max(value - upper);
            let bound = if at.rows[row] > upper { upper } else { lower };
            let exceeded = if bound == 0.0 {
                // Of a place that is as far away as the motion little is known, and the guess is nearer.
                ((missed(here[row]) + room[row]) / (ROOM * room[row])).log10().max(0.0)
            } else {
                (1.0 + missed(at.rows[row]).max(0.0) / bound.abs()).log10()
            };
            if exceeded.is_finite() {
                decades[*constraint] = decades[*constraint].max(exceeded);
            }
        }
        Some(Trial { decades: decades.iter().sum(), objective: at.objective })
    }

    /// Sizes of what has none. `scale` has those that are taken until then.
    fn find_sizes(&self, (x, scale): (&[f64], &[f64]), at: &Evaluation, balance: &mut Balance) {
        balance.propagate(&[Balance::balanced]);
        self.size_integrals(x, scale, balance);
        balance.propagate(&[Balance::balanced]);
        if balance.size.contains(&None) {
            balance.objective = self.measured_objective(x, at, balance);
            balance.curvature = self.curvatures(x, balance);
            balance.propagate(&[Balance::balanced, Balance::curved, Balance::partly_balanced]);
        }
        if balance.size.contains(&None) {
            self.size_beside(x, at, balance);
        }
    }

    /// Sizes of what stands in constraints in which everything else has no slope at the point, as `s` does in `s >= F * v` at rest:
    /// that by which these vary on the way to the point beside (5.8b).
    fn size_beside(&self, x: &[f64], at: &Evaluation, balance: &mut Balance) {
        let sizes: Vec<f64> = balance.group.iter().map(|group| balance.size[*group].unwrap_or(0.0)).collect();
        let mut near = x.to_vec();
        beside(x, &self.limits, &sizes, &mut near);
        let (mut workspace, mut there) = self.workspace();
        if self.values(&near, &mut workspace, &mut there).is_err() {
            return;
        }
        let mut change = vec![0.0_f64; balance.groups.len()];
        for ((constraint, here), there) in balance.constraint_of.iter().zip(&at.rows).zip(&there.rows) {
            let own = (there - here).abs();
            change[*constraint] = change[*constraint].max(if own.is_finite() { own } else { 0.0 });
        }
        let found: Sizes = balance
            .sizes_by(|group| {
                let alone =
                    balance.constraints[group].iter().filter(|(constraint, _)| balance.groups[*constraint].len() == 1);
                let sizes = alone.map(|&(constraint, slope)| change[constraint] / slope);
                sizes.filter(|size| size.is_normal()).reduce(f64::min)
            })
            .collect();
        found.into_iter().for_each(|(group, size)| balance.size[group] = Some(size));
        balance.propagate(&[Balance::balanced]);
    }

    /// The size of the objective by its slopes and known sizes. What is stationary at the point but for rounding, as a sum of
    /// squares of what is 0 there, is as large as its value, or as beside the point where that is rounding too.
    fn measured_objective(&self, x: &[f64], at: &Evaluation, balance: &Balance) -> f64 {
        let sizes: Vec<f64> = balance.group.iter().map(|group| balance.size[*group].unwrap_or(0.0)).collect();
        let mut near = x.to_vec();
        beside(x, &self.limits, &sizes, &mut near);
        let (mut workspace, mut there) = self.workspace();
        let there = self.values(&near, &mut workspace, &mut there).map_or(0.0, |()| there.objective.abs());
        let (slopes, here) = (self.objective_size(at, balance), at.objective.abs());
        if slopes > ROUNDING * here.max(there) {
            slopes
        } else if here > STATIONARY * there {
            here
        } else {
            there
        }
    }

    /// Forgets what the guess and bounds say of groups where other constraints tell sizes beside which that is next to nothing; and
    /// where none does, but the objective varies by rounding alone.
    fn forget_doubtful(&self, (x, scale, units): (&[f64], &[f64], &[f64]), at: &Evaluation, balance: &mut Balance) {
        let mut unit = vec![1.0; balance.size.len()];
        units.iter().zip(&balance.group).for_each(|(own, group)| unit[*group] = *own);
        let mut trial = balance.clone();
        trial.nothing = unit.iter().map(|unit| DOUBTFUL * unit).collect();
        let is_small = |group: &usize| match balance.size[*group] {
            Some(guessed) => guessed < SMALL_GUESS * unit[*group],
            None => balance.least_own_size(*group).is_some_and(|bound| bound < trial.nothing[*group]),
        };
        // What equations tell of a duration is no rounding, however short it is.
        let told = self.durations.iter().filter(|duration| x[duration.variable as usize] == duration.guess);
        let told: Vec<usize> = told.map(|duration| balance.group[duration.variable as usize]).collect();
        let doubtful: Vec<usize> = (0..unit.len()).filter(|group| is_small(group) && !told.contains(group)).collect();
        if doubtful.is_empty() {
            return;
        }
        doubtful.iter().for_each(|group| trial.forget(*group));
        self.find_sizes((x, scale), at, &mut trial);
        let size = self.objective_size(at, balance).max(at.objective.abs());
        for group in doubtful {
            let own = balance.size[group];
            match trial.size[group] {
                Some(told) => {
                    balance.nothing[group] = MET * told;
                    if own.is_some_and(|own| own < MUCH_SMALLER * told) {
                        balance.forget(group);
                    }
                }
                None if own.is_none_or(|own| own < trial.nothing[group])
                    && self.objective_size(at, &balance.alone(group)) < DOUBTFUL * size =>
                {
                    balance.nothing[group] = trial.nothing[group];
                    balance.size[group] = None;
                }
                None => {}
            }
        }
    }

    /// Groups with the sizes that the guess gives.
    fn balance(&self, groups: &[Vec<u32>], guess: &[f64]) -> Balance {
        let mut balance = Balance { group: vec![usize::MAX; guess.len()], ..Balance::default() };
        let alone = |variables: Range<usize>| variables.map(|variable| vec![variable as u32]);
        let others = alone(self.model.layout.coefficients..guess.len());
        // An integral has no guess of its own.
        let integrals = self.model.layout.integral_first.first().map_or(guess.len(), |first| *first as usize);
        for variables in groups.iter().cloned().chain(others) {
            let largest = variables.iter().map(|v| guess[*v as usize].abs()).fold(0.0, f64::max);
            let is_known = largest > f64::MIN_POSITIVE && (variables[0] as usize) < integrals;
            variables.iter().for_each(|v| balance.group[*v as usize] = balance.size.len());
            let bounds = variables.iter().map(|v| {
                // A bound that is far from anything that happens is no size; durations come behind all coefficients.
                let is_late = *v as usize >= self.model.layout.coefficients;
                let duration = self.durations.iter().find(|duration| is_late && duration.variable == *v);
                let v = *v as usize;
                bound_size((self.limits.lower[v], duration.map_or(self.limits.upper[v], |duration| duration.reach)))
            });
            balance.own_bound.push(bounds.filter(|bound| bound.is_finite()).fold(0.0, f64::max));
            balance.nothing.push(0.0);
            balance.size.push(is_known.then_some(largest));
            balance.is_integral.push(variables[0] as usize >= integrals);
        }
        balance
    }

    /// Sizes of integrals, as the objective has its own (5.3): the value at the point, unless it is stationary there, as a
    /// sum of squares is at 0, by the value beside the point. That is no larger than slope and curvature at the point tell: a
    /// power of 20 has a value of 1e17 times its own there, which says nothing of a solution. `scale` has the sizes of what
    /// has none yet. Where the integrals have no values on either way, they stay without a size.
    fn size_integrals(&self, x: &[f64], scale: &[f64], balance: &mut Balance) {
        let size = |j: usize| balance.size[balance.group[j]].unwrap_or(scale[j]);
        let sizes: Vec<f64> = (0..x.len()).map(size).collect();
        let mut near = x.to_vec();
        beside(x, &self.limits, &sizes, &mut near);
        // Integrals stay where they are: each row is then its integral less the sum that defines it.
        let first = self.model.layout.integral_first.first().map_or(x.len(), |first| *first as usize);
        near[first..].copy_from_slice(&x[first..]);
        if first == x.len() {
            balance.is_integral.fill(false);
            return;
        }
        let (mut workspace, mut at) = self.workspace();
        let mut integrals = |part: f64| -> Option<Vec<f64>> {
            let point: Vec<f64> = x.iter().zip(&near).map(|(x, near)| x + part * (near - x)).collect();
            self.values(&point, &mut workspace, &mut at).ok()?;
            let rows = self.elements.integral_rows();
            Some((first..).zip(rows).map(|(variable, &row)| x[variable] - at.rows[row as usize]).collect())
        };
        let [there, before, after] = [1.0, -NEARBY, NEARBY].map(&mut integrals);
        let nearby = before.zip(after);
        for (k, variable) in (first..x.len()).enumerate() {
            let here = x[variable].abs();
            let quadratic = nearby.as_ref().map(|(before, after)| {
                let (slope, curvature) = (after[k] - before[k], after[k] + before[k] - 2.0 * x[variable]);
                here + (slope / (2.0 * NEARBY)).abs() + 0.5 * curvature.abs() / (NEARBY * NEARBY)
            });
            let known = [there.as_ref().map(|there| there[k].abs()), quadratic].into_iter().flatten();
            let there = known.filter(|there| there.is_finite()).fold(f64::INFINITY, f64::min);
            let size = if here > STATIONARY * there { here.max(LEAST_AT_POINT * there) } else { there };
            if size.is_normal() {
                balance.size[balance.group[variable]] = Some(size);
            }
        }
        balance.is_integral.fill(false);
    }

    /// Slopes and bounds of all constraints: of each member the largest over its points.
    fn collect_slopes(&self, at: &Evaluation, balance: &mut Balance) {
        let relations = &self.elements.relations;
        let constraint_of: Vec<usize> = relations.of_row.iter().map(|relation| *relation as usize).collect();
        balance.bound = vec![0.0; relations.count()];
        balance.value = vec![0.0; relations.count()];
        balance.is_inequality = vec![false; relations.count()];
        for (row, &constraint) in constraint_of.iter().enumerate() {
            let limits = (self.limits.row_lower[row], self.limits.row_upper[row]);
            balance.is_inequality[constraint] |= limits.0 != limits.1;
            let (bound, value) = (bound_size(limits), at.rows[row].abs());
            if value.is_finite() {
                balance.value[constraint] = balance.value[constraint].max(value);
            }
            if bound.is_finite() {
                balance.bound[constraint] = balance.bound[constraint].max(bound);
            }
        }
        let mut slopes: BTreeMap<(usize, usize, usize), f64> = BTreeMap::new();
        let mut add = |key, slope: f64| {
            let largest = slopes.entry(key).or_insert(0.0);
            *largest = largest.max(slope);
        };
        for (block, values) in self.elements.blocks.iter().zip(&at.blocks) {
            let slots = block.jacobian.iter().map(|(_, slot)| slot + 1).max().unwrap_or(0);
            let group_of: Vec<Vec<Option<usize>>> = (0..slots)
                .map(|slot| (0..block.elements).map(|e| slot_group(block, e, slot, balance)).collect())
                .collect();
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                // Elements of one block mostly have the same constraint and group.
                let mut run: Option<((usize, usize, usize), f64)> = None;
                for (e, group) in group_of[slot].iter().enumerate() {
                    let Target::Row(target) = block.target[row * block.elements + e] else { continue };
                    let Some(group) = *group else { continue };
                    let weight = block.weight[row * block.elements + e];
                    let slope = (weight * values.jacobian[entry * block.elements + e]).abs();
                    let key = (constraint_of[target as usize], group, slot);
                    run = match run {
                        Some((same, largest)) if same == key => Some((key, largest.max(slope))),
                        other => {
                            other.into_iter().for_each(|(key, largest)| add(key, largest));
                            Some((key, slope))
                        }
                    };
                }
                run.into_iter().for_each(|(key, largest)| add(key, largest));
            }
        }
        balance.constraint_of = constraint_of;
        balance.groups = vec![vec![]; relations.count()];
        balance.constraints = vec![vec![]; balance.size.len()];
        balance.terms = vec![vec![]; relations.count()];
        for ((constraint, group, _), slope) in slopes.into_iter().filter(|(_, slope)| *slope > 0.0) {
            balance.terms[constraint].push((group, slope));
            // Those of one group follow one another.
            match balance.groups[constraint].last_mut().zip(balance.constraints[group].last_mut()) {
                Some((last, own)) if last.0 == group => {
                    let largest = last.1.max(slope);
                    (last.1, own.1) = (largest, largest);
                }
                _ => {
                    balance.groups[constraint].push((group, slope));
                    balance.constraints[group].push((constraint, slope));
                }
            }
        }
    }
}

impl Balance {
    /// Forgets sizes that are so small beside those of constraints that they are rounding of a guess of 0.
    fn forget_rounding(&mut self) {
        let is_rounding = |group: &usize| {
            let balanced = self.candidate(*group, false).unwrap_or(0.0);
            self.size[*group].is_some_and(|size| size < ROUNDING * balanced)
        };
        let rounding: Vec<usize> = (0..self.size.len()).filter(is_rounding).collect();
        rounding.into_iter().for_each(|group| self.size[group] = None);
    }

    /// Takes the sizes that other constraints tell in place of bounds that are far beyond them: a bound of 1e8 is what people
    /// write who know of none.
    fn forget_far_bounds(&mut self, known: &[Option<f64>]) {
        let told = |group: usize| {
            let (size, own) = (self.size[group]?, self.least_own_size(group)?);
            let told = self.candidate(group, false)?;
            (known[group].is_none() && size >= own && size > FAR_BOUND * told).then_some((group, told))
        };
        let found: Sizes = (0..self.size.len()).filter_map(told).collect();
        found.into_iter().for_each(|(group, size)| self.size[group] = Some(size));
    }

    /// Gives sizes to groups. A later way is tried where the ones before it find nothing.
    fn propagate(&mut self, ways: &[fn(&Self) -> Sizes]) {
        for _ in 0..self.size.len() {
            let Some(found) = ways.iter().map(|way| way(self)).find(|found| !found.is_empty()) else { return };
            found.into_iter().for_each(|(group, size)| self.size[group] = Some(size));
        }
    }

    /// What has no size yet, with the sizes that are found.
    fn sizes_by(&self, size: impl Fn(usize) -> Option<f64>) -> impl Iterator<Item = (usize, f64)> {
        (0..self.size.len())
            .filter(|group| self.size[*group].is_none() && !self.is_integral[*group])
            .filter_map(move |group| Some((group, size(group)?)))
    }

    /// All groups that balance constraints in which no other group is without a size.
    fn balanced(&self) -> Sizes {
        self.sizes_by(|group| self.candidate(group, false)).collect()
    }

    /// The first group that balances the known terms of a constraint.
    fn partly_balanced(&self) -> Sizes {
        self.sizes_by(|group| self.candidate(group, true)).take(1).collect()
    }

    /// All groups whose curvature balances something, alone or with a group of known size.
    fn curved(&self) -> Sizes {
        self.sizes_by(|group| {
            let sizes = self.curvature.iter().filter_map(|(&(l, m), curvature)| match (l == group, m == group) {
                (true, true) => Some(1.0 / curvature.sqrt()),
                (true, false) => Some(1.0 / (curvature * self.size[m]?)),
                (false, true) => Some(1.0 / (curvature * self.size[l]?)),
                (false, false) => None,
            });
            sizes.filter(|size| size.is_normal()).reduce(f64::min)
        })
        .collect()
    }

    /// Forgets what the guess says of a group: its size, and the values of constraints of the group alone.
    fn forget(&mut self, group: usize) {
        if self.size[group].take().is_some() {
            let alone = self.constraints[group].iter().filter(|(constraint, _)| self.groups[*constraint].len() == 1);
            alone.for_each(|(constraint, _)| self.value[*constraint] = 0.0);
        }
    }

    /// The sizes of one group alone.
    fn alone(&self, group: usize) -> Self {
        let mut size = vec![None; self.size.len()];
        size[group] = self.size[group];
        Self { size, group: self.group.clone(), ..Self::default() }
    }

    /// The first group without a size from `first` on, if there is one, and all that its size decides, with theirs where its own is 1.
    pub(super) fn decided_by(&self, first: usize) -> Option<(usize, Sizes)> {
        let is_open = |group: &usize| self.size[*group].is_none() && !self.is_integral[*group];
        let group = (first..self.size.len()).find(is_open)?;
        let mut trial = self.clone();
        trial.size[group] = Some(1.0);
        trial.propagate(&[Self::balanced]);
        let decided = (0..self.size.len()).filter(is_open).filter_map(|group| Some((group, trial.size[group]?)));
        Some((group, decided.collect()))
    }

    /// Gives groups their sizes.
    pub(super) fn take(&mut self, sizes: Sizes) {
        sizes.into_iter().for_each(|(group, size)| self.size[group] = Some(size));
    }

    /// The size of a group, if it is known.
    pub(super) fn size_of(&self, group: usize) -> Option<f64> {
        self.size[group]
    }

    /// The objective's size; 0 where that is not known.
    pub(super) fn objective(&self) -> f64 {
        self.objective
    }

    /// The size of each row, which is that of its constraint: its bound, its value at the guess or its largest known
    /// term; 0 where none is known or the constraint is flat at the guess.
    pub(super) fn row_sizes(&self) -> impl Iterator<Item = f64> {
        let sizes = (0..self.bound.len()).map(|constraint| {
            let term = self.largest_term(constraint, usize::MAX);
            if self.is_flat(constraint, term) { 0.0 } else { self.known_size(constraint, term) }
        });
        let sizes: Vec<f64> = sizes.collect();
        self.constraint_of.iter().map(move |constraint| sizes[*constraint])
    }

    /// By how many decades the largest term of a constraint, beside those of groups that are none, differs from the next one, or
    /// from the bound of an inequality that it exceeds; 0 where a term is not known.
    fn decades(&self, constraint: usize, no_terms: &[usize], by_rates: bool) -> f64 {
        /// A value so many times as large as all terms together is that of a constant in the formula.
        const CONSTANT: f64 = 3.0;
        let terms = if by_rates { &self.terms } else { &self.groups };
        let others = terms[constraint].iter().filter(|(group, _)| !no_terms.contains(group));
        let terms: Option<Vec<f64>> = others.map(|&(group, slope)| Some(self.size[group]? * slope)).collect();
        let Some(mut terms) = terms else { return 0.0 };
        let bound = self.bound[constraint];
        if !self.is_inequality[constraint] {
            terms.push(bound);
            let value = self.value[constraint];
            terms.extend((value > CONSTANT * terms.iter().sum::<f64>()).then_some(value));
            terms.sort_by(|a, b| b.total_cmp(a));
        }
        let decades = match terms[..] {
            _ if self.is_inequality[constraint] => (terms.into_iter().fold(0.0, f64::max) / bound).log10().max(0.0),
            [largest, next, ..] if next > 0.0 => (largest / next).log10(),
            _ => 0.0,
        };
        if decades.is_finite() { decades } else { 0.0 }
    }

    /// The largest known term of a constraint beside those of one group.
    fn largest_term(&self, constraint: usize, beside: usize) -> f64 {
        let others = self.groups[constraint].iter().filter(|(other, _)| *other != beside);
        others.filter_map(|(other, slope)| Some(self.size[*other]? * slope)).fold(0.0, f64::max)
    }

    /// The size of a constraint whose largest known term is given. Its value at the guess shows constant terms beside a
    /// bound of 0.
    fn known_size(&self, constraint: usize, term: f64) -> f64 {
        self.bound[constraint].max(self.value[constraint]).max(term)
    }

    /// Whether a constraint is an inequality that is flat at the guess, such as a zone far away: it balances nothing.
    fn is_flat(&self, constraint: usize, term: f64) -> bool {
        self.is_inequality[constraint] && term > 0.0 && term < ROUNDING * self.bound[constraint]
    }

    /// The least size that a bound of a group alone tells.
    fn least_own_size(&self, group: usize) -> Option<f64> {
        let alone = self.constraints[group].iter().filter(|(constraint, _)| self.groups[*constraint].len() == 1);
        let sizes = alone.map(|&(constraint, slope)| self.known_size(constraint, 0.0) / slope);
        sizes.chain([self.own_bound[group]]).filter(|size| *size > 0.0).reduce(f64::min)
    }

    /// The least size with which a group balances one of its constraints or reaches its own bound: a larger one would
    /// make it the largest term of that constraint. `partly`: of constraints in which other groups have no size either
    /// the known terms count.
    fn candidate(&self, group: usize, partly: bool) -> Option<f64> {
        let own = Some(self.own_bound[group]).filter(|bound| *bound > self.nothing[group]);
        let balanced = self.constraints[group].iter().filter_map(|&(constraint, slope)| {
            let mut others = self.groups[constraint].iter().filter(|(other, _)| *other != group);
            if !partly && others.any(|(other, _)| self.size[*other].is_none()) {
                return None;
            }
            let term = self.largest_term(constraint, group);
            let size = self.known_size(constraint, term) / slope;
            let is_told = self.groups[constraint].len() > 1 || size > self.nothing[group];
            (size.is_normal() && is_told && !self.is_flat(constraint, term)).then_some(size)
        });
        own.into_iter().chain(balanced).reduce(f64::min)
    }
}
