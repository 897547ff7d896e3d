//! Kernels of generated code, and the drivers that carry them over many lanes.
//!
//! A kernel is written once, for packs of lanes of any width ([`Pack`]), and compiled for each set
//! of instructions that `ntg-math` knows. Which one runs is decided on the processor, once a call
//! of the contract; the bits are the same on all. The drivers load a pack of each input, call the
//! kernel, and store a pack of each result. They allocate nothing.

use ntg_math::{MOST_LANES, Pack, Simd, Task, Work, dispatch};
use ntg_splines::Table;
use ntg_structure::Structure;

use crate::problem::{Derivatives, Lanes, Problem};

/// What generated code implements: [`Problem`], for lanes of any width.
pub trait Kernels: Sync {
    /// As [`Problem::structure`].
    fn structure(&self) -> Structure;

    /// As [`Problem::values`]; there are no weights.
    fn values<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], values: &mut [f64]);

    /// As [`Problem::derivatives`].
    fn derivatives<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>);

    /// As [`Problem::probes`]; there are no weights.
    fn probes<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], probes: &mut [f64]);
}

impl<T: Kernels> Problem for T {
    fn structure(&self) -> Structure {
        Kernels::structure(self)
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        let call = Call { problem: self, kernel, point: Lanes { lanes, inputs, weights: &[] }, tables };
        dispatch(Values(call, values));
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        dispatch(ValuesAndDerivatives(Call { problem: self, kernel, point, tables }, out));
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        let call = Call { problem: self, kernel, point: Lanes { lanes, inputs, weights: &[] }, tables };
        dispatch(Probes(call, probes));
    }
}

/// A call of the contract.
struct Call<'a, T> {
    problem: &'a T,
    kernel: usize,
    point: Lanes<'a>,
    tables: &'a [Table],
}

struct Values<'a, T>(Call<'a, T>, &'a mut [f64]);
struct ValuesAndDerivatives<'a, T>(Call<'a, T>, Derivatives<'a>);
struct Probes<'a, T>(Call<'a, T>, &'a mut [f64]);

impl<T: Kernels> Task for Values<'_, T> {
    #[inline]
    fn run<S: Simd>(self, simd: S) {
        let Call { problem, kernel, point, tables } = self.0;
        problem.values(simd, kernel, point, tables, self.1);
    }
}

impl<T: Kernels> Task for ValuesAndDerivatives<'_, T> {
    #[inline]
    fn run<S: Simd>(self, simd: S) {
        let Call { problem, kernel, point, tables } = self.0;
        problem.derivatives(simd, kernel, point, tables, self.1);
    }
}

impl<T: Kernels> Task for Probes<'_, T> {
    #[inline]
    fn run<S: Simd>(self, simd: S) {
        let Call { problem, kernel, point, tables } = self.0;
        problem.probes(simd, kernel, point, tables, self.1);
    }
}

/// Calls `f` with the inputs of every pack of lanes and stores its results.
///
/// `point.inputs` holds `I` numbers for every lane and `out` at least `R`; entry `i` of lane `l` is
/// `[i * lanes + l]`. Where either is shorter than that, nothing is written.
#[inline]
pub fn values<S: Simd, const I: usize, const R: usize>(
    simd: S,
    point: Lanes<'_>,
    out: &mut [f64],
    f: impl Fn(S, &[Pack<S>; I], &mut [Pack<S>; R]),
) {
    if point.lanes == 0 || point.inputs.len() < I * point.lanes || out.len() < R * point.lanes {
        return;
    }
    simd.vectorize(EveryPack { simd, point, out, f });
}

/// Calls `f` with the inputs and weights of every pack of lanes and stores values, first derivatives
/// and weighted second derivatives. `I`, `J` and `H` may be 0.
///
/// Arrays are laid out as for [`values`]; where one is too short, nothing is written.
#[inline]
pub fn derivatives<S: Simd, const I: usize, const R: usize, const J: usize, const H: usize>(
    simd: S,
    point: Lanes<'_>,
    out: Derivatives<'_>,
    f: impl Fn(S, &[Pack<S>; I], &[Pack<S>; R], &mut [Pack<S>; R], &mut [Pack<S>; J], &mut [Pack<S>; H]),
) {
    let lanes = point.lanes;
    let short = out.values.len() < R * lanes || out.jacobian.len() < J * lanes || out.hessian.len() < H * lanes;
    if lanes == 0 || point.inputs.len() < I * lanes || point.weights.len() < R * lanes || short {
        return;
    }
    simd.vectorize(EveryPackWithDerivatives { simd, point, out, f });
}

struct EveryPack<'a, S, F, const I: usize, const R: usize> {
    simd: S,
    point: Lanes<'a>,
    out: &'a mut [f64],
    f: F,
}

impl<S: Simd, F, const I: usize, const R: usize> Work for EveryPack<'_, S, F, I, R>
where
    F: Fn(S, &[Pack<S>; I], &mut [Pack<S>; R]),
{
    #[inline(always)]
    fn run(self) {
        let Self { simd, point, out, f } = self;
        let lanes = point.lanes;
        let inputs: [&[f64]; I] = rows(point.inputs, lanes);
        for from in packs::<S>(lanes) {
            let mut results = [Pack::splat(simd, 0.0); R];
            f(simd, &gather(simd, &inputs, from), &mut results);
            scatter(&results, lanes, from, out);
        }
    }
}

struct EveryPackWithDerivatives<'a, S, F, const I: usize, const R: usize, const J: usize, const H: usize> {
    simd: S,
    point: Lanes<'a>,
    out: Derivatives<'a>,
    f: F,
}

impl<S: Simd, F, const I: usize, const R: usize, const J: usize, const H: usize> Work
    for EveryPackWithDerivatives<'_, S, F, I, R, J, H>
where
    F: Fn(S, &[Pack<S>; I], &[Pack<S>; R], &mut [Pack<S>; R], &mut [Pack<S>; J], &mut [Pack<S>; H]),
{
    #[inline(always)]
    fn run(self) {
        let Self { simd, point, out, f } = self;
        let lanes = point.lanes;
        let inputs: [&[f64]; I] = rows(point.inputs, lanes);
        let weights: [&[f64]; R] = rows(point.weights, lanes);
        for from in packs::<S>(lanes) {
            let zero = Pack::splat(simd, 0.0);
            let (mut values, mut jacobian, mut hessian) = ([zero; R], [zero; J], [zero; H]);
            let (inputs, weights) = (gather(simd, &inputs, from), gather(simd, &weights, from));
            f(simd, &inputs, &weights, &mut values, &mut jacobian, &mut hessian);
            scatter(&values, lanes, from, out.values);
            scatter(&jacobian, lanes, from, out.jacobian);
            scatter(&hessian, lanes, from, out.hessian);
        }
    }
}

/// The first lane of each pack. Where the last pack has too few lanes, it takes some of the one before
/// it again: the same inputs give the same results.
#[inline(always)]
fn packs<S: Simd>(lanes: usize) -> impl Iterator<Item = usize> {
    let last = lanes.saturating_sub(S::LANES);
    (0..lanes).step_by(S::LANES).map(move |from| from.min(last))
}

#[inline(always)]
fn rows<const N: usize>(array: &[f64], lanes: usize) -> [&[f64]; N] {
    std::array::from_fn(|i| &array[i * lanes..][..lanes])
}

/// One pack of each row; where there are fewer lanes than a pack has, the last one fills it.
#[inline(always)]
fn gather<S: Simd, const N: usize>(simd: S, rows: &[&[f64]; N], from: usize) -> [Pack<S>; N] {
    std::array::from_fn(|i| {
        let row = &rows[i][from..];
        if row.len() >= S::LANES { Pack::load(simd, row) } else { Pack::load(simd, &padded(row)) }
    })
}

#[cold]
fn padded(row: &[f64]) -> [f64; MOST_LANES] {
    std::array::from_fn(|lane| row[lane.min(row.len() - 1)])
}

#[inline(always)]
fn scatter<S: Simd, const N: usize>(entries: &[Pack<S>; N], lanes: usize, from: usize, out: &mut [f64]) {
    for (row, entry) in out.chunks_exact_mut(lanes).zip(entries) {
        let row = &mut row[from..];
        if row.len() >= S::LANES {
            entry.store(row);
        } else {
            let mut pack = [0.0; MOST_LANES];
            entry.store(&mut pack);
            row.copy_from_slice(&pack[..row.len()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two kernels: sum and product of two inputs; twice a weight without inputs.
    struct Two;

    impl Kernels for Two {
        fn structure(&self) -> Structure {
            Structure::default()
        }

        fn values<S: Simd>(&self, simd: S, _: usize, point: Lanes<'_>, _: &[Table], out: &mut [f64]) {
            values::<S, 2, 2>(simd, point, out, |_, u, r| *r = [u[0] + u[1], u[0] * u[1]]);
        }

        fn derivatives<S: Simd>(&self, simd: S, _: usize, point: Lanes<'_>, _: &[Table], out: Derivatives<'_>) {
            derivatives::<S, 0, 1, 0, 0>(simd, point, out, |_, _, w, v, _, _| v[0] = w[0] * 2.0);
        }

        fn probes<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], out: &mut [f64]) {
            Kernels::values(self, simd, kernel, point, tables, out);
        }
    }

    #[test]
    fn a_lane_sees_its_own_inputs_and_writes_its_own_results_whatever_their_number() {
        for lanes in 1..20 {
            let inputs: Vec<f64> = (0..2 * lanes).map(|i| i as f64 + 1.0).collect();
            let mut out = vec![f64::NAN; 2 * lanes];
            Problem::values(&Two, 0, lanes, &inputs, &[], &mut out);
            for lane in 0..lanes {
                let (a, b) = (inputs[lane], inputs[lanes + lane]);
                assert_eq!([out[lane], out[lanes + lane]], [a + b, a * b], "lane {lane} of {lanes}");
            }
        }
    }

    #[test]
    fn derivatives_may_be_empty() {
        let (mut value, weights) = ([f64::NAN; 2], [3.0, 4.0]);
        let point = Lanes { lanes: 2, inputs: &[], weights: &weights };
        let out = Derivatives { values: &mut value, jacobian: &mut [], hessian: &mut [] };
        Problem::derivatives(&Two, 0, point, &[], out);
        assert_eq!(value, [6.0, 8.0]);
    }

    #[test]
    fn arrays_that_are_too_short_are_left_alone() {
        let mut out = [f64::NAN; 3];
        Problem::values(&Two, 0, 2, &[1.0, 2.0, 3.0, 4.0], &[], &mut out);
        assert!(out.iter().all(|x| x.is_nan()));
    }
}
