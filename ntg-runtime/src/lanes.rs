//! Kernels of generated code, and the drivers that carry them over many lanes.
//!
//! A kernel is written once, for packs of lanes of any width ([`Pack`]), and compiled for each set
//! of instructions that `ntg-math` knows. Which one runs is decided on the processor, once a call
//! of the contract; the bits are the same on all. The drivers load a pack of each input, call the
//! kernel, and store a pack of each result. They allocate nothing.

use std::marker::PhantomData;

use ntg_math::{MOST_LANES, Pack, Scalar, Simd, Task, Work, dispatch};
use ntg_splines::Table;
use ntg_structure::Structure;
use ntg_structure::constant::{self, Constant};

use crate::problem::{Derivatives, Lanes, Problem};

/// What generated code implements: [`Problem`], for lanes of any width.
pub trait Kernels: Sync {
    /// What the problem is, with the spec's own values of parameters and tables.
    fn structure(&self) -> &'static constant::Structure;

    /// As [`Problem::update`]: writes the values of parameters and tables.
    fn update(&self, structure: &mut Structure);

    /// As [`Problem::values`] of kernels that have derivatives; there are no weights.
    fn values<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], values: &mut [f64]);

    /// As [`Problem::derivatives`].
    fn derivatives<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>);

    /// As [`Problem::values`] of all other kernels: functions that are only shown, bounds, guesses. A solve asks for
    /// them at its ends and not in its iterations, so they are compiled for one lane alone.
    fn undifferentiated(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], values: &mut [f64]);

    /// As [`Problem::probes`]; there are no weights. Asked once a solve at most, so it is compiled for one lane alone.
    fn probes(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], probes: &mut [f64]);
}

impl<T: Kernels> Problem for T {
    fn structure(&self) -> Structure {
        updated(Kernels::structure(self), &|structure| Kernels::update(self, structure))
    }

    fn update(&self, structure: &mut Structure) {
        Kernels::update(self, structure);
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        let call = Call { problem: self, kernel, point: Lanes { lanes, inputs, weights: &[] }, tables };
        dispatch(AllValues(call, values));
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        dispatch(AllDerivatives(Call { problem: self, kernel, point, tables }, out));
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        Kernels::probes(self, kernel, Lanes { lanes, inputs, weights: &[] }, tables, probes);
    }
}

/// The structure with the present values of parameters and tables. Not generic, so that a program has no code that
/// makes or drops a structure.
fn updated(constant: &constant::Structure, update: &dyn Fn(&mut Structure)) -> Structure {
    let mut structure = constant.owned();
    update(&mut structure);
    structure
}

/// A call of the contract.
struct Call<'a, T> {
    problem: &'a T,
    kernel: usize,
    point: Lanes<'a>,
    tables: &'a [Table],
}

struct AllValues<'a, T>(Call<'a, T>, &'a mut [f64]);
struct AllDerivatives<'a, T>(Call<'a, T>, Derivatives<'a>);

impl<T: Kernels> Task for AllValues<'_, T> {
    #[inline]
    fn run<S: Simd>(self, simd: S) {
        let Call { problem, kernel, point, tables } = self.0;
        problem.values(simd, kernel, point, tables, self.1);
    }
}

impl<T: Kernels> Task for AllDerivatives<'_, T> {
    #[inline]
    fn run<S: Simd>(self, simd: S) {
        let Call { problem, kernel, point, tables } = self.0;
        problem.derivatives(simd, kernel, point, tables, self.1);
    }
}

/// The values of one kernel, at a pack of lanes: `I` inputs, `R` rows.
///
/// A type and not a function value, since only methods are certain to be compiled into the loop that
/// may use the processor's instructions; a function that is called from there without being part of
/// it is many times slower.
pub trait Values<const I: usize, const R: usize> {
    /// Writes every row.
    fn at<S: Simd>(simd: S, tables: &[Table], inputs: &[Pack<S>; I], out: &mut [Pack<S>; R]);
}

/// Values and derivatives of one kernel: `J` first derivatives, and `H` second derivatives of the rows
/// times their weights.
pub trait ValuesAndDerivatives<const I: usize, const R: usize, const J: usize, const H: usize> {
    /// Writes all of them.
    fn at<S: Simd>(
        simd: S,
        tables: &[Table],
        inputs: &[Pack<S>; I],
        weights: &[Pack<S>; R],
        values: &mut [Pack<S>; R],
        jacobian: &mut [Pack<S>; J],
        hessian: &mut [Pack<S>; H],
    );
}

/// What is probed in one kernel: `P` arguments that should stay inside a domain.
pub trait Probes<const I: usize, const P: usize> {
    /// Writes every one.
    fn at<S: Simd>(simd: S, tables: &[Table], inputs: &[Pack<S>; I], out: &mut [Pack<S>; P]);
}

/// Calls a kernel with the inputs of every pack of lanes and stores its rows.
///
/// `point.inputs` holds `I` numbers for every lane and `out` at least `R`; entry `i` of lane `l` is
/// `[i * lanes + l]`. Where either is shorter than that, nothing is written.
#[inline]
pub fn values<S: Simd, K: Values<I, R>, const I: usize, const R: usize>(
    simd: S,
    _: K,
    point: Lanes<'_>,
    tables: &[Table],
    out: &mut [f64],
) {
    if point.lanes == 0 || point.inputs.len() < I * point.lanes || out.len() < R * point.lanes {
        return;
    }
    simd.vectorize(EveryPack::<S, K, I, R> { simd, point, tables, out, kernel: PhantomData });
}

/// As [`values`], one lane after the other.
#[inline]
pub fn undifferentiated<K: Values<I, R>, const I: usize, const R: usize>(
    _: K,
    point: Lanes<'_>,
    tables: &[Table],
    out: &mut [f64],
) {
    let zero = Pack::splat(Scalar, 0.0);
    every_lane(point, &mut [zero; I], &mut [zero; R], out, &|inputs, results| {
        if let (Some(inputs), Some(results)) = (inputs.first_chunk(), results.first_chunk_mut()) {
            K::at(Scalar, tables, inputs, results);
        }
    });
}

/// As [`values`], of what is probed, one lane after the other.
#[inline]
pub fn probes<K: Probes<I, P>, const I: usize, const P: usize>(
    _: K,
    point: Lanes<'_>,
    tables: &[Table],
    out: &mut [f64],
) {
    let zero = Pack::splat(Scalar, 0.0);
    every_lane(point, &mut [zero; I], &mut [zero; P], out, &|inputs, results| {
        if let (Some(inputs), Some(results)) = (inputs.first_chunk(), results.first_chunk_mut()) {
            K::at(Scalar, tables, inputs, results);
        }
    });
}

/// A kernel for one lane.
type OfOneLane<'a> = &'a dyn Fn(&[Pack<Scalar>], &mut [Pack<Scalar>]);

/// Calls a kernel with the inputs of every lane and stores its results; the two slices of packs have their numbers.
/// Not generic, so that a program has no loop for each of its kernels.
fn every_lane(
    point: Lanes<'_>,
    inputs: &mut [Pack<Scalar>],
    results: &mut [Pack<Scalar>],
    out: &mut [f64],
    kernel: OfOneLane<'_>,
) {
    let lanes = point.lanes;
    if lanes == 0 || point.inputs.len() < inputs.len() * lanes || out.len() < results.len() * lanes {
        return;
    }
    for lane in 0..lanes {
        for (input, row) in inputs.iter_mut().zip(point.inputs.chunks_exact(lanes)) {
            *input = Pack::load(Scalar, &row[lane..]);
        }
        kernel(inputs, results);
        for (result, row) in results.iter().zip(out.chunks_exact_mut(lanes)) {
            result.store(&mut row[lane..]);
        }
    }
}

/// Calls a kernel with the inputs and weights of every pack of lanes and stores values, first
/// derivatives and weighted second derivatives. `I`, `J` and `H` may be 0.
///
/// Arrays are laid out as for [`values`]; where one is too short, nothing is written.
#[inline]
pub fn derivatives<S: Simd, K, const I: usize, const R: usize, const J: usize, const H: usize>(
    simd: S,
    _: K,
    point: Lanes<'_>,
    tables: &[Table],
    out: Derivatives<'_>,
) where
    K: ValuesAndDerivatives<I, R, J, H>,
{
    let lanes = point.lanes;
    let short = out.values.len() < R * lanes || out.jacobian.len() < J * lanes || out.hessian.len() < H * lanes;
    if lanes == 0 || point.inputs.len() < I * lanes || point.weights.len() < R * lanes || short {
        return;
    }
    simd.vectorize(EveryPackWithDerivatives::<S, K, I, R, J, H> { simd, point, tables, out, kernel: PhantomData });
}

struct EveryPack<'a, S, K, const I: usize, const R: usize> {
    simd: S,
    point: Lanes<'a>,
    tables: &'a [Table],
    out: &'a mut [f64],
    kernel: PhantomData<K>,
}

impl<S: Simd, K: Values<I, R>, const I: usize, const R: usize> Work for EveryPack<'_, S, K, I, R> {
    #[inline(always)]
    fn run(self) {
        let Self { simd, point, tables, out, .. } = self;
        let lanes = point.lanes;
        // Made once: every pack writes all of them again.
        let zero = Pack::splat(simd, 0.0);
        let (mut u, mut results) = ([zero; I], [zero; R]);
        for from in packs::<S>(lanes) {
            gather(point.inputs, lanes, from, &mut u);
            K::at(simd, tables, &u, &mut results);
            scatter(&results, lanes, from, out);
        }
    }
}

struct EveryPackWithDerivatives<'a, S, K, const I: usize, const R: usize, const J: usize, const H: usize> {
    simd: S,
    point: Lanes<'a>,
    tables: &'a [Table],
    out: Derivatives<'a>,
    kernel: PhantomData<K>,
}

impl<S: Simd, K, const I: usize, const R: usize, const J: usize, const H: usize> Work
    for EveryPackWithDerivatives<'_, S, K, I, R, J, H>
where
    K: ValuesAndDerivatives<I, R, J, H>,
{
    #[inline(always)]
    fn run(self) {
        let Self { simd, point, tables, out, .. } = self;
        let lanes = point.lanes;
        // Made once: every pack writes all of them again.
        let zero = Pack::splat(simd, 0.0);
        let (mut u, mut w) = ([zero; I], [zero; R]);
        let (mut values, mut jacobian, mut hessian) = ([zero; R], [zero; J], [zero; H]);
        for from in packs::<S>(lanes) {
            gather(point.inputs, lanes, from, &mut u);
            gather(point.weights, lanes, from, &mut w);
            K::at(simd, tables, &u, &w, &mut values, &mut jacobian, &mut hessian);
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

/// One pack of each row of an array; where there are fewer lanes than a pack has, the last one fills it.
///
/// A loop, since a closure of the standard library's `from_fn` is not certain to be compiled into it.
#[inline(always)]
fn gather<S: Simd, const N: usize>(array: &[f64], lanes: usize, from: usize, packs: &mut [Pack<S>; N]) {
    for (pack, row) in packs.iter_mut().zip(array.chunks_exact(lanes)) {
        let (simd, row) = (pack.simd(), &row[from..]);
        *pack = if row.len() >= S::LANES { Pack::load(simd, row) } else { Pack::load(simd, &padded(row)) };
    }
}

#[cold]
fn padded(row: &[f64]) -> [f64; MOST_LANES] {
    std::array::from_fn(|lane| row[lane.min(row.len() - 1)])
}

/// Stores one pack of each row.
#[inline(always)]
fn scatter<S: Simd, const N: usize>(entries: &[Pack<S>; N], lanes: usize, from: usize, out: &mut [f64]) {
    for (row, entry) in out.chunks_exact_mut(lanes).zip(entries) {
        let row = &mut row[from..];
        if row.len() >= S::LANES {
            entry.store(row);
        } else {
            row.copy_from_slice(&entry.to_array()[..row.len()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two kernels: sum and product of two inputs; twice a weight without inputs.
    struct Two;

    struct SumAndProduct;

    impl Values<2, 2> for SumAndProduct {
        fn at<S: Simd>(_: S, _: &[Table], u: &[Pack<S>; 2], out: &mut [Pack<S>; 2]) {
            *out = [u[0] + u[1], u[0] * u[1]];
        }
    }

    struct Twice;

    impl ValuesAndDerivatives<0, 1, 0, 0> for Twice {
        fn at<S: Simd>(
            _: S,
            _: &[Table],
            _: &[Pack<S>; 0],
            w: &[Pack<S>; 1],
            v: &mut [Pack<S>; 1],
            _: &mut [Pack<S>; 0],
            _: &mut [Pack<S>; 0],
        ) {
            v[0] = w[0] * 2.0;
        }
    }

    impl Kernels for Two {
        fn structure(&self) -> &'static constant::Structure {
            &constant::Structure::DEFAULT
        }

        fn update(&self, _: &mut Structure) {}

        fn values<S: Simd>(&self, simd: S, _: usize, point: Lanes<'_>, tables: &[Table], out: &mut [f64]) {
            values(simd, SumAndProduct, point, tables, out);
        }

        fn derivatives<S: Simd>(&self, simd: S, _: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
            derivatives(simd, Twice, point, tables, out);
        }

        fn undifferentiated(&self, _: usize, point: Lanes<'_>, tables: &[Table], out: &mut [f64]) {
            undifferentiated(SumAndProduct, point, tables, out);
        }

        fn probes(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: &mut [f64]) {
            Kernels::undifferentiated(self, kernel, point, tables, out);
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
