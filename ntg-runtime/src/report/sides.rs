//! The side of a limit that varies with time alone, `z >= ground(t)` (docs/maths.md, section 9).
//!
//! What outputs leave of a limit in which they stand linearly is its value where all outputs are 0. A hill between two points is
//! small beside the height of the flight, and no part of what the limit varies by at the points: where the limit is missed, what
//! the side itself varies by counts.

use super::constraints::bounds_are_next_to_zero;
use super::fine::{Checked, Key, Plan, Wanted};
use crate::transcribe::points::Point;
use crate::transcribe::rows::Pair;
use crate::transcribe::{SetupError, Transcription};
use std::collections::{BTreeMap, BTreeSet};

/// A side that varies by less than this part of the value is constant, and a limit is linear where it is as far from the mean of
/// its value and of that without outputs. A law: rounding of sums that have tens of terms.
const ROUNDING: f64 = 1e-10;

/// A place at which a limit is missed.
pub(super) struct Place {
    pub(super) key: Key,
    pub(super) point: Point,
    pub(super) value: f64,
    pub(super) bounds: Pair,
}

/// The places at which limits without a bound but 0 are missed.
#[derive(Default)]
pub(super) struct Sides {
    places: Vec<Place>,
}

/// What is known of a limit without outputs.
#[derive(Default)]
struct Side {
    /// The least and the largest value.
    range: Option<(f64, f64)>,
    /// The values at places, by the time and the side of a breakpoint.
    values: BTreeMap<(u64, bool), f64>,
}

impl Sides {
    /// Takes in a place at which a limit of this size is missed by more than rounding.
    pub(super) fn add(&mut self, checked: &Checked<'_>, size: f64) {
        let Some(key) = checked.limit() else { return };
        if bounds_are_next_to_zero(checked.bounds, size) {
            self.places.push(Place { key, point: checked.point, value: checked.value, bounds: checked.bounds });
        }
    }

    /// Calls `visit` with the places at which a limit with a side of its own is missed, and with what that varies by.
    pub(super) fn visit(
        self,
        nlp: &Transcription,
        (fine, x): (&mut Plan, &[f64]),
        mut visit: impl FnMut(&Place, f64),
    ) -> Result<(), SetupError> {
        if self.places.is_empty() {
            return Ok(());
        }
        let [without, half] = [0.0, 0.5].map(|part| {
            let mut x = x.to_vec();
            x[..nlp.model.layout.coefficients].iter_mut().for_each(|c| *c *= part);
            self.values(nlp, (&mut *fine, &x))
        });
        let (without, half) = (without?, half?);
        for place in &self.places {
            let (Some(without), Some(half)) = (without.get(&place.key), half.get(&place.key)) else { continue };
            let (Some((low, high)), at) = (without.range, moment(&place.point)) else { continue };
            let is_linear = |key: &(u64, bool)| {
                let (Some(none), Some(half)) = (without.values.get(key), half.values.get(key)) else { return false };
                (0.5 * (none + place.value) - half).abs()
                    <= ROUNDING * none.abs().max(place.value.abs()).max(high - low)
            };
            if is_linear(&at) && high - low > ROUNDING * low.abs().max(high.abs()) {
                visit(place, high - low);
            }
        }
        Ok(())
    }

    /// The values of all limits that are missed somewhere, at other coefficients.
    fn values(&self, nlp: &Transcription, (fine, x): (&mut Plan, &[f64])) -> Result<BTreeMap<Key, Side>, SetupError> {
        let mut all: BTreeMap<Key, Side> =
            self.places.iter().map(|place| (place.key.clone(), Side::default())).collect();
        let constraints: BTreeSet<usize> = self.places.iter().map(|place| place.key.0).collect();
        fine.evaluate(nlp, (x, Wanted::All), |checked| {
            if !(checked.value.is_finite() && constraints.contains(&checked.constraint)) {
                return;
            }
            if let Some(side) = checked.limit().and_then(|key| all.get_mut(&key)) {
                let (low, high) = side.range.get_or_insert((checked.value, checked.value));
                (*low, *high) = (low.min(checked.value), high.max(checked.value));
                side.values.insert(moment(&checked.point), checked.value);
            }
        })?;
        Ok(all)
    }
}

/// A point as a key.
fn moment(point: &Point) -> (u64, bool) {
    (point.tau.to_bits(), point.side == ntg_splines::Side::Left)
}
