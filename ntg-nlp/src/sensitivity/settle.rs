//! Which bounds hold at the solution nearest to a point, to first order (docs/maths.md, section 16.2).
//!
//! ```text
//! min 1/2 w^T H w + g^T w   subject to   c + J w within the bounds
//! ```
//!
//! An interior-point method ends at a point where a distance and a multiplier that both become small are about the root of its
//! barrier parameter each: where a limit binds along an arc, neither tells which points of the arc hold. This quadratic program
//! does. It is solved from `w = 0` with the bounds that seem to hold, by the primal active-set method: a step to the least value
//! with these bounds ends at the first other one that it meets, which is added; where it meets none, the bound whose
//! multiplier has the wrong sign by most is given up.
//!
//! Reference: J. Nocedal, S. J. Wright, *Numerical Optimization* (2006), algorithm 16.3.

use super::activity::{Bounded, Side};
use super::{Sensitivity, Unavailable};
use crate::kkt::Part;

/// Bounds that are added or given up at most. A choice: where the sides are right, none is, and an arc takes tens.
const ROUNDS: usize = 100;
/// Changes of variables beside their sizes, and of multipliers beside the largest one, that are more than the error of second
/// order that is left. A choice.
const FAR: f64 = 1e-6;
/// Refinements at most: two or three are usual, and what is left of contradictions does not become less. A choice.
const REFINEMENTS: usize = 8;
/// A multiplier counts as 0 below this fraction of the largest one. A law: some thousand roundings.
const ROUNDING: f64 = 1e-12;

/// The solution nearest to a point, to first order, in scaled units.
pub(super) struct Nearest {
    /// The steps of the variables.
    pub(super) step: Vec<f64>,
    /// The changes of the multipliers of all rows and variables.
    pub(super) multipliers: Vec<f64>,
    /// Whether other bounds hold there, and multipliers differ by so much that derivatives have to be taken again.
    pub(super) is_other: bool,
}

/// Where a quadratic program with some bounds that hold is least.
struct Least {
    step: Vec<f64>,
    /// The changes of the values of all rows and variables, and of their multipliers.
    values: Vec<f64>,
    multipliers: Vec<f64>,
    /// Whether all bounds that are to hold can.
    is_resolved: bool,
}

impl Least {
    /// Whether variables or multipliers change by so much that derivatives are others there.
    fn is_far(&self, bounded: &[Bounded]) -> bool {
        let largest = |all: &mut dyn Iterator<Item = f64>| all.fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let before = largest(&mut bounded.iter().map(Bounded::held_multiplier));
        largest(&mut self.step.iter().copied()) > FAR || largest(&mut self.multipliers.iter().copied()) > FAR * before
    }
}

impl<W> Sensitivity<W> {
    /// Decides which bounds hold, and factorises the matrix with those. Where that is not found out, the sides are those that
    /// were given, and what would have changed is undecided.
    pub(super) fn settle(&mut self, first: Vec<Bounded>) -> Result<(Vec<Bounded>, Option<Nearest>), Unavailable> {
        let mut bounded = first.clone();
        if let Some(nearest) = self.nearest(&mut bounded) {
            return Ok((bounded, Some(nearest)));
        }
        let mut left = first;
        for (own, last) in left.iter_mut().zip(&bounded) {
            own.is_undecided = last.is_undecided;
        }
        self.hold(&left);
        self.factorise()?;
        Ok((left, None))
    }

    /// Moves sides until the bounds that hold are those of the nearest solution; none where that is not reached.
    fn nearest(&mut self, bounded: &mut [Bounded]) -> Option<Nearest> {
        let mut at = vec![0.0; bounded.len()];
        for round in 0..ROUNDS {
            let least = self.least(bounded)?;
            let change = match first_met(bounded, &at, &least.values).filter(|_| least.is_resolved) {
                Some((length, met, side)) => {
                    at.iter_mut().zip(&least.values).for_each(|(at, to)| *at += length * (to - *at));
                    Some((met, side))
                }
                None => {
                    if least.is_resolved {
                        at.copy_from_slice(&least.values);
                    }
                    wrongly_held(bounded, &least.multipliers).map(|worst| (worst, Side::Free))
                }
            };
            let Some((changed, side)) = change else {
                if !least.is_resolved {
                    return None;
                }
                let changes = least.values.iter().zip(&least.multipliers);
                for (own, (value, multiplier)) in bounded.iter_mut().zip(changes) {
                    own.note(*value, *multiplier);
                    own.is_undecided = false;
                }
                let is_other = round > 0 && least.is_far(bounded);
                return Some(Nearest { step: least.step, multipliers: least.multipliers, is_other });
            };
            bounded[changed].side = side;
            bounded[changed].is_undecided = true;
            self.hold(bounded);
            self.factorise().ok()?;
        }
        None
    }

    /// Where the quadratic program is least with the bounds that are taken to hold; none where the system has no solution.
    fn least(&mut self, bounded: &[Bounded]) -> Option<Least> {
        self.clear();
        let mut weights = vec![0.0; self.system.functions()];
        for (function, of) in self.bounded_functions().zip(bounded) {
            weights[function] = of.held_multiplier();
            self.work.rows[function][0] = of.change_to_bound();
        }
        weights[self.system.objective()] = -1.0;
        let mut left = vec![0.0; self.work.left.len()];
        self.system.transposed_product(&weights, &mut left);
        self.work.left.iter_mut().zip(left).for_each(|(to, left)| to[0] = left);
        let is_resolved = match self.solve_within(REFINEMENTS, (Part::Free, Part::Free)) {
            Ok(()) => true,
            // Bounds contradict each other: the multipliers grow with what is left, and have the wrong sign at those that do
            // not hold.
            Err(Unavailable::Unresolved(left)) if left.is_finite() => false,
            Err(_) => return None,
        };
        let step: Vec<f64> = self.work.steps(0).collect();
        let mut values = vec![0.0; self.system.functions()];
        self.system.product(&step, &mut values);
        let multipliers: Vec<f64> = self.work.multipliers(0).collect();
        let of = |all: &[f64]| self.bounded_functions().map(|function| all[function]).collect();
        let mut least = Least { values: of(&values), multipliers: of(&multipliers), step, is_resolved };
        // What is left of rounding is as large as rounding.
        least.is_resolved |= !least.is_far(bounded);
        Some(least)
    }
}

/// The first bound that is met on the way from one change of the values to another: how far along, whose and which it is.
fn first_met(bounded: &[Bounded], from: &[f64], to: &[f64]) -> Option<(f64, usize, Side)> {
    let changes = from.iter().zip(to);
    let met = bounded.iter().zip(changes).enumerate();
    met.filter_map(|(k, (own, (from, to)))| own.blocks(*from, *to).map(|(length, side)| (length, k, side)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The bound whose multiplier has the wrong sign by most.
fn wrongly_held(bounded: &[Bounded], changes: &[f64]) -> Option<usize> {
    let held = || bounded.iter().zip(changes).enumerate().filter_map(|(k, (own, y))| Some((k, own.hold_of(*y)?)));
    let most = held().fold(0.0_f64, |most, (_, y)| most.max(y.abs()));
    held().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, y)| *y < -ROUNDING * most).map(|(k, _)| k)
}
