//! Looking a table up, for every lane of a pack.
//!
//! Derivatives at the same place share one search and one reading of coefficients. Tables of one and two
//! arguments are evaluated for all lanes together ([`Joined`]); what that does not serve (more arguments,
//! very large tables, derivatives beyond the third) goes lane by lane through the weights of (7.1). Which way
//! is taken depends on table and derivative alone, so a number has the same bits in any company.

use ntg_math::{MOST_LANES, Pack, Scalar, Simd, Task, dispatch};

use super::joined::Joined;
use super::piece::Weights;
use super::place::{AT_ONCE, Place};
use super::{MAX_ARGUMENTS, MAX_TABLE_ORDER, Table};

impl Table {
    /// A partial derivative of the interpolant: `derivative[i]` is the order in argument `i`.
    ///
    /// Derivatives beyond the interpolant's smoothness are those of its pieces, from the right
    /// at a node (at the last one from the left). Not a number if an argument is, or if `args`
    /// or `derivative` has not one entry for each argument.
    pub fn eval(&self, args: &[f64], derivative: &[u8]) -> f64 {
        let mut lanes = [[0.0; MOST_LANES]; MAX_ARGUMENTS];
        let Some(lanes) = lanes.get_mut(..args.len()) else { return f64::NAN };
        lanes.iter_mut().zip(args).for_each(|(lane, x)| lane[0] = *x);
        let mut out = [[f64::NAN; MOST_LANES]];
        self.look_up(1, lanes, derivative, &mut out);
        out[0][0]
    }

    /// Several partial derivatives at the same place, for each of `lanes` places: `out[k]` is `orders[k * n + i]` times
    /// with respect to argument `i` of `n`. A lane has the bits that [`Table::eval`] gives.
    ///
    /// Lanes come as numbers and not as packs, so that this is compiled once and not with every kernel.
    #[inline(never)]
    pub fn look_up(&self, lanes: usize, args: &[[f64; MOST_LANES]], orders: &[u8], out: &mut [[f64; MOST_LANES]]) {
        if args.len() != self.pieces.len() || orders.len() != args.len() * out.len() {
            out.fill([f64::NAN; MOST_LANES]);
            return;
        }
        let task = Lanes { table: self, lanes: lanes.min(MOST_LANES), args, orders, out };
        match lanes {
            1 => task.run(Scalar),
            _ => dispatch(task),
        }
    }

    /// A partial derivative at one place, by the weights of (7.1).
    fn weighted(&self, args: &[f64], derivative: &[u8]) -> f64 {
        if args.iter().any(|x| x.is_nan()) {
            return f64::NAN;
        }
        let mut weights = [[0.0; MAX_TABLE_ORDER]; MAX_ARGUMENTS];
        let mut first = 0;
        for (axis, piece) in self.pieces.iter().enumerate() {
            let place: Place<Scalar> = piece.place(Pack::splat(Scalar, args[axis]));
            if !piece.weights(&place, usize::from(derivative[axis]), self.extrapolation, &mut weights[axis]) {
                return 0.0;
            }
            first += piece.start(place.cell[0]) * self.strides[axis];
        }
        self.contract(0, first, &weights)
    }

    /// The sum over the coefficients that act in arguments `axis ..`, the first of them at `first`.
    fn contract(&self, axis: usize, first: usize, weights: &[Weights]) -> f64 {
        let weights_here = &weights[axis][..self.pieces[axis].order()];
        if axis + 1 == self.pieces.len() {
            let active = &self.coefficients.values[first..][..weights_here.len()];
            return weights_here.iter().zip(active).map(|(w, c)| w * c).sum();
        }
        let inner = weights_here.iter().enumerate();
        inner.map(|(j, w)| w * self.contract(axis + 1, first + j * self.strides[axis], weights)).sum()
    }
}

/// A look-up of some lanes, to be compiled for the processor's instructions.
struct Lanes<'a> {
    table: &'a Table,
    lanes: usize,
    args: &'a [[f64; MOST_LANES]],
    orders: &'a [u8],
    out: &'a mut [[f64; MOST_LANES]],
}

impl Task for Lanes<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { table, lanes, args, orders, out } = self;
        let mut packs = [Pack::splat(simd, 0.0); MAX_ARGUMENTS];
        for from in (0..lanes).step_by(S::LANES) {
            for (pack, lanes) in packs.iter_mut().zip(args) {
                *pack = Pack::load(simd, &lanes[from..]);
            }
            LookUp { simd, table, args: &packs[..args.len()], orders, out: &mut *out, from }.run();
        }
    }
}

/// A look-up of the lanes of one pack.
struct LookUp<'a, S: Simd> {
    simd: S,
    table: &'a Table,
    args: &'a [Pack<S>],
    orders: &'a [u8],
    out: &'a mut [[f64; MOST_LANES]],
    /// The first of the lanes.
    from: usize,
}

impl<S: Simd> LookUp<'_, S> {
    #[inline(always)]
    fn run(self) {
        match (&self.table.joined, self.args) {
            (Some(joined), [x]) => self.one(joined, *x),
            (Some(joined), [x, y]) => self.two(joined, [*x, *y]),
            _ => {
                for (out, derivative) in self.out.iter_mut().zip(self.orders.chunks_exact(self.args.len())) {
                    each_lane(self.simd, self.table, self.args, derivative).store(&mut out[self.from..]);
                }
            }
        }
    }
}

impl<S: Simd> LookUp<'_, S> {
    #[inline(always)]
    fn one(self, joined: &Joined, x: Pack<S>) {
        let (table, piece) = (self.table, &self.table.pieces[0]);
        let most = self.orders.iter().copied().filter(|d| usize::from(*d) < AT_ONCE).max().unwrap_or(0);
        let count = usize::from(most) + 1;
        // The common orders are written as numbers so that their loops are unrolled.
        let jet = match piece.order() {
            2 => joined.one::<S, 2>(piece, x, count, table.extrapolation),
            4 => joined.one::<S, 4>(piece, x, count, table.extrapolation),
            _ => joined.one::<S, MAX_TABLE_ORDER>(piece, x, count, table.extrapolation),
        };
        let (valid, none) = (x.is_number(), Pack::splat(self.simd, f64::NAN));
        for (out, d) in self.out.iter_mut().zip(self.orders) {
            let derivative = match jet.get(usize::from(*d)) {
                Some(derivative) => valid.select(*derivative, none),
                None => each_lane(self.simd, table, self.args, &[*d]),
            };
            derivative.store(&mut out[self.from..]);
        }
    }

    #[inline(always)]
    fn two(self, joined: &Joined, args: [Pack<S>; 2]) {
        let (table, beyond) = (self.table, self.table.extrapolation);
        let pieces = [&table.pieces[0], &table.pieces[1]];
        let (pairs, _) = self.orders.as_chunks::<2>();
        let altogether = |[i, j]: [u8; 2]| usize::from(i) + usize::from(j);
        let most = pairs.iter().map(|pair| altogether(*pair)).filter(|d| *d < AT_ONCE).max().unwrap_or(0);
        let jet = match pieces.map(super::piece::Piece::order) {
            [2, 2] => joined.two::<S, 2>(pieces, args, most + 1, beyond),
            [4, 4] => joined.two::<S, 4>(pieces, args, most + 1, beyond),
            _ => joined.two::<S, MAX_TABLE_ORDER>(pieces, args, most + 1, beyond),
        };
        let valid = args[0].is_number().both(args[1].is_number());
        let none = Pack::splat(self.simd, f64::NAN);
        for (out, pair) in self.out.iter_mut().zip(pairs) {
            let derivative = if altogether(*pair) < AT_ONCE {
                valid.select(jet[usize::from(pair[0])][usize::from(pair[1])], none)
            } else {
                each_lane(self.simd, table, self.args, pair)
            };
            derivative.store(&mut out[self.from..]);
        }
    }
}

/// A partial derivative, one lane after the other.
#[inline(never)]
fn each_lane<S: Simd>(simd: S, table: &Table, args: &[Pack<S>], derivative: &[u8]) -> Pack<S> {
    let mut lanes = [[0.0; MAX_ARGUMENTS]; MOST_LANES];
    for (i, arg) in args.iter().enumerate() {
        for (lane, x) in lanes.iter_mut().zip(arg.to_array()) {
            lane[i] = x;
        }
    }
    let mut result = [0.0; MOST_LANES];
    for (result, args_here) in result.iter_mut().zip(&lanes).take(S::LANES) {
        *result = table.weighted(&args_here[..args.len()], derivative);
    }
    Pack::load(simd, &result)
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Extrapolation, Method, Symmetry};
    use super::*;

    /// Tables of every method and symmetry, of one to three arguments, with few and many nodes.
    fn tables() -> Vec<Table> {
        let sizes = [(1, 4), (1, 30), (2, 5), (2, 14), (3, 4)];
        let symmetries = [Symmetry::Plain, Symmetry::Even, Symmetry::Periodic];
        sizes.into_iter().flat_map(|size| symmetries.into_iter().flat_map(move |s| tables_of(size, s))).collect()
    }

    fn tables_of((arguments, count): (usize, usize), symmetry: Symmetry) -> Vec<Table> {
        let nodes: Vec<f64> = (0..count).map(|i| (i * i) as f64 * 0.1 + i as f64 * 0.05).collect();
        let axes = vec![Axis { nodes, symmetry }; arguments];
        // The first and the last node of an argument have the same value, as a period asks.
        let value = |i: usize| (1.7 * (i % (count - 1)) as f64).sin() + 0.2 * (i % (count - 1)) as f64;
        let product = |at: usize| (0..arguments).map(|k| value(at / count.pow(k as u32) % count)).product();
        let values: Vec<f64> = (0..count.pow(arguments as u32)).map(product).collect();
        let spline = |order| Method::Bspline { order };
        let methods = [Method::Monotone, Method::Linear, spline(3), spline(4), spline(6)];
        let served = methods.into_iter().filter(|method| arguments < 3 || *method != Method::Monotone);
        let both = served.flat_map(|method| [Extrapolation::Clamp, Extrapolation::Linear].map(|e| (method.clone(), e)));
        both.map(|(method, beyond)| Table::new(axes.clone(), values.clone(), method, beyond).expect("sound")).collect()
    }

    /// Orders of derivatives up to the fourth, in one argument and mixed.
    fn orders(arguments: usize) -> Vec<u8> {
        let mut all = vec![0; arguments];
        for i in 0..arguments {
            for d in 1..=4 {
                let mut order = vec![0; arguments];
                order[i] = d;
                all.extend(&order);
                order[(i + 1) % arguments] += 1;
                all.extend(&order);
            }
        }
        all
    }

    /// Places inside, outside, at nodes, at 0, and what is no place.
    fn places() -> Vec<f64> {
        let mut all: Vec<f64> = (-40..40).map(|i| 0.37 * f64::from(i)).collect();
        all.extend([0.0, -0.0, 0.15, -0.15, 0.5, 1.05, -1.05, 1e9, -1e60, f64::INFINITY, f64::NAN, 88.0]);
        all
    }

    /// Looks up as many places at once as there are at most.
    fn look_up_all(table: &Table, args: &[Vec<f64>], orders: &[u8], results: &mut [Vec<f64>]) {
        for at in (0..args[0].len()).step_by(MOST_LANES) {
            let count = MOST_LANES.min(args[0].len() - at);
            let lanes = |x: &Vec<f64>| std::array::from_fn(|lane| x[at + lane.min(count - 1)]);
            let args: Vec<[f64; MOST_LANES]> = args.iter().map(lanes).collect();
            let mut out = vec![[0.0; MOST_LANES]; results.len()];
            table.look_up(MOST_LANES, &args, orders, &mut out);
            for (result, derivative) in results.iter_mut().zip(out) {
                result[at..at + count].copy_from_slice(&derivative[..count]);
            }
        }
    }

    #[test]
    fn a_lane_has_the_bits_that_the_number_has_alone() {
        let places = places();
        for table in tables() {
            let n = table.arguments();
            let args: Vec<Vec<f64>> = (0..n)
                .map(|i| (0..places.len()).map(|at| places[(at * (2 * i + 1)) % places.len()]).collect())
                .collect();
            let orders = orders(n);
            let mut results = vec![vec![0.0; places.len()]; orders.len() / n];
            look_up_all(&table, &args, &orders, &mut results);
            for (result, derivative) in results.iter().zip(orders.chunks_exact(n)) {
                for (at, found) in result.iter().enumerate() {
                    let point: Vec<f64> = args.iter().map(|x| x[at]).collect();
                    let alone = table.eval(&point, derivative);
                    assert_eq!(found.to_bits(), alone.to_bits(), "{derivative:?} at {point:?}: {found} {alone}");
                    let known = point.iter().all(|x| x.is_finite());
                    assert!(alone.is_finite() || !known, "{derivative:?} at {point:?}: {alone}");
                }
            }
        }
    }

    #[test]
    fn both_ways_give_the_same_function() {
        for table in tables().iter().filter(|table| table.joined.is_some()) {
            let n = table.arguments();
            for (i, x) in places().into_iter().filter(|x| x.abs() < 1e3).enumerate() {
                let point: Vec<f64> = (0..n).map(|k| x * (1.0 - 0.3 * k as f64) + 0.01 * i as f64).collect();
                for derivative in orders(n).chunks_exact(n) {
                    let (joined, weighted) = (table.eval(&point, derivative), table.weighted(&point, derivative));
                    // Rounding of the value, and of the largest coefficient (40), magnified by differences over the
                    // narrowest cell.
                    let d = derivative.iter().map(|d| i32::from(*d)).sum();
                    let bound = 1e-13 * (joined.abs() + 40.0 * 60_f64.powi(d) * (1.0 + x.abs()));
                    assert!((joined - weighted).abs() <= bound, "{derivative:?} at {point:?}: {joined} {weighted}");
                }
            }
        }
    }
}
