//! Drivers that carry a kernel of one point over many lanes.
//!
//! Generated kernels are functions of arrays of known length; the drivers gather a lane's inputs,
//! call the kernel, and scatter its results. They allocate nothing. Every array is cut into rows
//! of exactly `lanes` numbers before the loop, which frees the loop of bounds checks where the
//! compiler keeps the rows in registers.

use crate::problem::{Derivatives, Lanes};

/// Calls `f` with the inputs of every lane and scatters its results.
///
/// `inputs` holds `I * lanes` numbers and `out` at least `R * lanes`; entry `i` of lane `l` is
/// `[i * lanes + l]`. Where `out` is shorter than that, or `inputs` is, nothing is written.
#[inline]
pub fn values<const I: usize, const R: usize>(
    lanes: usize,
    inputs: &[f64],
    out: &mut [f64],
    f: impl Fn(&[f64; I], &mut [f64; R]),
) {
    if lanes == 0 || inputs.len() < I * lanes || out.len() < R * lanes {
        return;
    }
    let rows: [&[f64]; I] = std::array::from_fn(|i| &inputs[i * lanes..][..lanes]);
    let mut results = [0.0; R];
    for lane in 0..lanes {
        f(&gather(&rows, lane), &mut results);
        scatter(&results, lanes, lane, out);
    }
}

/// Calls `f` with the inputs and weights of every lane and scatters values, first derivatives and
/// weighted second derivatives. `I`, `J` and `H` may be 0.
///
/// Arrays are laid out as for [`values`]; where one is too short, nothing is written.
#[inline]
pub fn derivatives<const I: usize, const R: usize, const J: usize, const H: usize>(
    point: Lanes<'_>,
    out: Derivatives<'_>,
    f: impl Fn(&[f64; I], &[f64; R], &mut [f64; R], &mut [f64; J], &mut [f64; H]),
) {
    let Lanes { lanes, inputs, weights } = point;
    let short = out.values.len() < R * lanes || out.jacobian.len() < J * lanes || out.hessian.len() < H * lanes;
    if lanes == 0 || inputs.len() < I * lanes || weights.len() < R * lanes || short {
        return;
    }
    let inputs: [&[f64]; I] = std::array::from_fn(|i| &inputs[i * lanes..][..lanes]);
    let weights: [&[f64]; R] = std::array::from_fn(|r| &weights[r * lanes..][..lanes]);
    let (mut values, mut jacobian, mut hessian) = ([0.0; R], [0.0; J], [0.0; H]);
    for lane in 0..lanes {
        f(&gather(&inputs, lane), &gather(&weights, lane), &mut values, &mut jacobian, &mut hessian);
        scatter(&values, lanes, lane, out.values);
        scatter(&jacobian, lanes, lane, out.jacobian);
        scatter(&hessian, lanes, lane, out.hessian);
    }
}

#[inline(always)]
fn gather<const N: usize>(rows: &[&[f64]; N], lane: usize) -> [f64; N] {
    std::array::from_fn(|i| rows[i][lane])
}

#[inline(always)]
fn scatter<const N: usize>(entries: &[f64; N], lanes: usize, lane: usize, out: &mut [f64]) {
    for (row, entry) in out.chunks_exact_mut(lanes).zip(entries) {
        row[lane] = *entry;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lane_sees_its_own_inputs_and_writes_its_own_results() {
        let inputs = [1.0, 2.0, 3.0, 10.0, 20.0, 30.0];
        let mut out = [f64::NAN; 6];
        values::<2, 2>(3, &inputs, &mut out, |u, r| *r = [u[0] + u[1], u[0] * u[1]]);
        assert_eq!(out, [11.0, 22.0, 33.0, 10.0, 40.0, 90.0]);
    }

    #[test]
    fn derivatives_may_be_empty() {
        let (mut value, weights) = ([f64::NAN; 2], [3.0, 4.0]);
        let point = Lanes { lanes: 2, inputs: &[], weights: &weights };
        let out = Derivatives { values: &mut value, jacobian: &mut [], hessian: &mut [] };
        derivatives::<0, 1, 0, 0>(point, out, |_, w, v, _, _| v[0] = w[0] * 2.0);
        assert_eq!(value, [6.0, 8.0]);
    }
}
