//! Second derivatives of the constraints and of the objective at a guess, for the sizes of what has no slope there
//! (docs/maths.md, equation 5.8).

use super::Transcription;
use super::sizes::{Balance, slot_group};
use ntg_nlp::{Evaluation, Nlp, Target};
use std::collections::BTreeMap;

impl Transcription<'_> {
    /// For each pair of groups the `k` of the term `k d_l d_m`, at most of a constraint over that constraint's size, and
    /// in all of the objective over its own.
    pub(super) fn curvatures(&self, guess: &[f64], balance: &Balance) -> BTreeMap<(usize, usize), f64> {
        let rows = balance.row_sizes().map(|size| if size > 0.0 { 1.0 / size } else { 0.0 });
        let rows: Vec<f64> = rows.collect();
        let mut curvatures = self.second_derivatives(guess, (0.0, &rows), balance, f64::max);
        let objective = balance.objective();
        if objective > 0.0 {
            let none = vec![0.0; rows.len()];
            let own = self.second_derivatives(guess, (1.0 / objective, &none), balance, |sum, more| sum + more);
            for (pair, curvature) in own {
                let largest = curvatures.entry(pair).or_insert(0.0);
                *largest = largest.max(curvature);
            }
        }
        curvatures
    }

    /// Second derivatives with these weights of the objective and of the rows, by pairs of groups.
    fn second_derivatives(
        &self,
        guess: &[f64],
        (objective, rows): (f64, &[f64]),
        balance: &Balance,
        join: impl Fn(f64, f64) -> f64,
    ) -> BTreeMap<(usize, usize), f64> {
        let (mut workspace, mut at) = self.workspace();
        let mut found = BTreeMap::new();
        if self.derivatives(guess, objective, rows, &mut workspace, &mut at).is_err() {
            return found;
        }
        for (block, values) in self.elements.blocks.iter().zip(&at.blocks) {
            for (entry, &(i, j)) in block.hessian.iter().enumerate() {
                let share = if i == j { 0.5 } else { 1.0 };
                for e in 0..block.elements {
                    let curvature = share * values.hessian[entry * block.elements + e].abs();
                    // A second derivative that is no number has no size.
                    if curvature.is_nan() || curvature == 0.0 {
                        continue;
                    }
                    let groups = (slot_group(block, e, i, balance), slot_group(block, e, j, balance));
                    let (Some(l), Some(m)) = groups else { continue };
                    let known = found.entry((l.min(m), l.max(m))).or_insert(0.0);
                    *known = join(*known, curvature);
                }
            }
        }
        found
    }

    /// Sizes of what no constraint decides: those with which the objective, to second order, is least (docs/maths.md, equation
    /// 5.8d).
    pub(super) fn size_by_minimum(&self, guess: &[f64], at: &Evaluation, balance: &mut Balance) {
        let Some((mut group, mut sizes)) = balance.decided_by(0) else { return };
        let slopes = self.objective_slopes(at, balance);
        let none = vec![0.0; self.elements.rows.len()];
        let curvatures = self.second_derivatives(guess, (1.0, &none), balance, |sum, more| sum + more);
        loop {
            let relative: BTreeMap<usize, f64> = sizes.iter().copied().collect();
            let sized = |group: &usize| relative.get(group).copied().unwrap_or(0.0);
            let slope: f64 = slopes.iter().map(|(group, slope)| slope * sized(group)).sum();
            let curvature: f64 = curvatures.iter().map(|((l, m), k)| k * sized(l) * sized(m)).sum();
            let least = slope / (2.0 * curvature);
            if least.is_normal() {
                balance.take(sizes.into_iter().map(|(group, size)| (group, least * size)).collect());
            }
            match balance.decided_by(group + 1) {
                Some(next) => (group, sizes) = next,
                None => return,
            }
        }
    }

    /// The size of the objective at a guess: the sum of its terms' slopes times known sizes.
    pub(super) fn objective_size(&self, at: &Evaluation, balance: &Balance) -> f64 {
        let slopes = self.objective_slopes(at, balance);
        slopes.into_iter().map(|(group, slope)| slope * balance.size_of(group).unwrap_or(0.0)).sum()
    }

    /// The sum of the slopes of the objective's terms by slots of each group.
    fn objective_slopes(&self, at: &Evaluation, balance: &Balance) -> BTreeMap<usize, f64> {
        let mut slopes = BTreeMap::new();
        for (block, values) in self.elements.blocks.iter().zip(&at.blocks) {
            for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
                for e in 0..block.elements {
                    let at = row * block.elements + e;
                    if block.target[at] != Target::Objective {
                        continue;
                    }
                    let slope = (block.weight[at] * values.jacobian[entry * block.elements + e]).abs();
                    if let Some(group) = slot_group(block, e, slot, balance) {
                        *slopes.entry(group).or_insert(0.0) += slope;
                    }
                }
            }
        }
        slopes
    }
}
