//! Which cell is a number in?
//!
//! Cells are told apart by the breaks between them. A few breaks are all compared with all lanes at
//! once. More are cut into equal parts of the whole range: a part knows the cells that it touches,
//! and the search goes on between these, so that a look-up costs the same however many cells there are.
//!
//! Takes increasing breaks, finite; finds for every number the number of inner breaks that do not
//! exceed it. The part of a number never falls as the number grows, whatever rounding does, and the
//! parts of breaks are found by the same formula, so no cell is missed.

use ntg_math::{MOST_LANES, Pack, Scalar, Simd};

/// The most inner breaks that are compared one after the other: as many comparisons cost as much as
/// the other way.
const FEW: usize = 8;

/// How many parts a cell is on average cut into.
const PARTS: usize = 4;

/// The cells of one argument.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Search {
    inner: Vec<f64>, // Breaks between cells.
    first: f64,
    density: f64,         // Parts per unit of the argument.
    parts: Vec<[u32; 2]>, // The first and the last cell that each part touches; empty for few cells.
}

impl Search {
    pub(super) fn new(breaks: &[f64]) -> Self {
        let cells = breaks.len() - 1;
        let (first, inner) = (breaks[0], breaks[1..cells].to_vec());
        let density = (PARTS * cells) as f64 / (breaks[cells] - first);
        // Cells of no measurable width are all in one part.
        let density = if density.is_finite() { density } else { 0.0 };
        let mut search = Self { inner, first, density, parts: vec![] };
        if search.inner.len() > FEW {
            search.parts = vec![[0; 2]; PARTS * cells + 1];
            let parts: Vec<usize> = search.inner.iter().map(|b| search.part(Pack::splat(Scalar, *b))[0]).collect();
            let reached = |test: &dyn Fn(usize) -> bool| parts.partition_point(|part| test(*part)) as u32;
            for (number, touched) in search.parts.iter_mut().enumerate() {
                *touched = [reached(&|part| part < number), reached(&|part| part <= number)];
            }
        }
        search
    }

    /// The cells that an interval touches, in its inside; `from < to`.
    pub(super) fn between(&self, from: f64, to: f64) -> std::ops::RangeInclusive<usize> {
        self.inner.partition_point(|b| *b <= from)..=self.inner.partition_point(|b| *b < to)
    }

    /// The cell of each lane: how many inner breaks are not above it.
    #[inline(always)]
    pub(super) fn cells<S: Simd>(&self, x: Pack<S>) -> [usize; MOST_LANES] {
        let simd = x.simd();
        if self.parts.is_empty() {
            let mut passed = Pack::splat(simd, 0.0);
            for b in &self.inner {
                passed = passed + Pack::splat(simd, *b).less_eq(x).choose(1.0, 0.0);
            }
            return passed.indices();
        }
        let (mut cells, lanes) = (self.part(x), x.to_array());
        for (cell, x) in cells.iter_mut().zip(lanes).take(S::LANES) {
            let [from, to] = self.parts[*cell].map(|touched| touched as usize);
            *cell = from + self.inner[from..to].partition_point(|b| *b <= x);
        }
        cells
    }

    /// The part of each lane; any of them for what is not a number.
    #[inline(always)]
    fn part<S: Simd>(&self, x: Pack<S>) -> [usize; MOST_LANES] {
        let (zero, last) = (Pack::splat(x.simd(), 0.0), Pack::splat(x.simd(), (self.parts.len() - 1) as f64));
        let at = (x - self.first) * self.density;
        let at = zero.less(at).select(at, zero);
        at.less(last).select(at, last).indices()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_in_the_cell_that_holds_it_however_uneven_the_breaks() {
        let uneven = |n: i32, base: f64| (0..n).map(|i| base.powi(i)).collect::<Vec<_>>();
        let equal: Vec<f64> = (0..40).map(|i| 1e6 + 1e-9 * f64::from(i)).collect();
        let tiny: Vec<f64> = (0..20).map(|i| f64::from(i) * 5e-324).collect();
        for breaks in [uneven(60, 3.0), uneven(30, 1e10), uneven(9, 2.0), uneven(2, 2.0), equal, tiny] {
            let search = Search::new(&breaks);
            let inner = &breaks[1..breaks.len() - 1];
            let between = breaks.windows(2).map(|pair| 0.5 * pair[0] + 0.5 * pair[1]);
            for b in breaks.iter().copied().chain(between) {
                for x in [b.next_down(), b, b.next_up()] {
                    let expected = inner.partition_point(|b| *b <= x);
                    assert_eq!(search.cells(Pack::splat(Scalar, x))[0], expected, "{x:e} in {breaks:?}");
                }
            }
        }
    }
}
