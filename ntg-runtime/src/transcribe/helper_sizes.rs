//! Sizes of helpers that stand for distances (docs/maths.md, equation 5.8c).
//!
//! Takes the sizes of everything else; gives those of helpers that cones hold, `c^2 >= u . u`. At a guess of 0 such a row says
//! nothing of how large `c` is. Half a size of everything else away it does: there it is `r(c) = r(0) + k c^2`, and its value
//! at two more `c` tells `k`, and that it is a cone.

use super::Transcription;
use ntg_nlp::{Nlp, Target};
use std::ops::Range;

/// The part of its size by which everything else is moved. That of the objective's size (5.3).
const BESIDE: f64 = 0.5;
/// The power of `c` in a cone, from three values. A law: two, but for rounding.
const POWER: Range<f64> = 1.9..2.1;
/// The first of two `c`, in sizes: the square of a smaller one is rounding beside that of a large distance. A choice.
const PROBES: [f64; 3] = [1.0, 1e6, 1e12];

impl Transcription<'_> {
    /// The sizes at which some helpers, each with the coefficients of its output or itself alone, meet their cones beside a
    /// point; none for what no cone holds.
    pub(super) fn helper_sizes(&self, helpers: &[Vec<u32>], guess: &[f64], scale: &[f64]) -> Vec<Option<f64>> {
        let mut is_helper = vec![false; guess.len()];
        helpers.iter().flatten().for_each(|v| is_helper[*v as usize] = true);
        let (mut work, mut at) = self.workspace();
        let mut rows_at = |multiple: f64| {
            let moved = |(v, guess): (usize, &f64)| match is_helper[v] {
                true => multiple * scale[v],
                false => (guess + BESIDE * scale[v]).max(self.limits.lower[v]).min(self.limits.upper[v]),
            };
            let x: Vec<f64> = guess.iter().enumerate().map(moved).collect();
            self.values(&x, &mut work, &mut at).ok().map(|()| at.rows.clone())
        };
        let Some(none) = rows_at(0.0) else { return vec![None; helpers.len()] };
        let probes: Vec<(f64, Vec<f64>, Vec<f64>)> =
            PROBES.iter().filter_map(|probe| Some((*probe, rows_at(*probe)?, rows_at(2.0 * probe)?))).collect();
        // How many sizes a helper is where it meets a cone.
        let met = |row: usize| {
            probes.iter().find_map(|(probe, one, two)| {
                let (first, second) = (one[row] - none[row], two[row] - none[row]);
                let multiple = probe * (-none[row] / first).sqrt();
                (POWER.contains(&(second / first).log2()) && multiple.is_normal()).then_some(multiple)
            })
        };
        let mut largest = vec![0.0_f64; guess.len()];
        for block in self.blocks() {
            for e in 0..block.elements {
                let Some(helper) = block.variables(e).iter().find(|v| is_helper[**v as usize]) else { continue };
                let targets = (0..block.rows).map(|row| block.target[row * block.elements + e]);
                let rows = targets.filter_map(|target| match target {
                    Target::Row(row) => met(row as usize),
                    _ => None,
                });
                largest[*helper as usize] = rows.fold(largest[*helper as usize], f64::max);
            }
        }
        let size = |own: &Vec<u32>| {
            let most = own.iter().map(|v| largest[*v as usize]).fold(0.0, f64::max);
            (most > 0.0).then(|| most * scale[own[0] as usize] / BESIDE)
        };
        helpers.iter().map(size).collect()
    }
}
