//! Packs: the same number of several elements, side by side. The loops over packs are written so that
//! the compiler turns each into a few vector instructions: everything is read before anything is written, so that
//! inputs and outputs need not be checked for overlap.

/// One number for each of `L` elements.
pub(super) type Pack<const L: usize> = [f64; L];

/// Elements that are worked on side by side where there are many.
pub(super) const LANES: usize = 8;
/// No element.
pub(super) const NONE: u32 = u32::MAX;

/// `a b`.
#[inline(always)]
pub(super) fn product<const L: usize>(a: &Pack<L>, b: &Pack<L>) -> Pack<L> {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

/// `sum += a b`.
#[inline(always)]
pub(super) fn add_product<const L: usize>(sum: &mut Pack<L>, a: &Pack<L>, b: &Pack<L>) {
    let (a, b, mut total) = (*a, *b, *sum);
    for lane in 0..L {
        total[lane] += a[lane] * b[lane];
    }
    *sum = total;
}

/// The sum of the products of two rows.
#[inline(always)]
pub(super) fn row_product<const L: usize>(a: &[Pack<L>], b: &[Pack<L>]) -> Pack<L> {
    let mut sum = [0.0; L];
    for (a, b) in a.iter().zip(b) {
        add_product(&mut sum, a, b);
    }
    sum
}

/// The position of a factor, and of the row that it multiplies.
pub(super) type Term = (u32, u32);

/// `row += sum over terms of factors[f] rows[r ..]`. Rows as long as splines have active basis functions are
/// written out, so that their sums stay in registers.
#[inline(always)]
pub(super) fn combine<const L: usize>(row: &mut [Pack<L>], terms: &[Term], factors: &[Pack<L>], rows: &[Pack<L>]) {
    match row.len() {
        1 => written_out::<L, 1>(row, terms, factors, rows),
        2 => written_out::<L, 2>(row, terms, factors, rows),
        3 => written_out::<L, 3>(row, terms, factors, rows),
        4 => written_out::<L, 4>(row, terms, factors, rows),
        5 => written_out::<L, 5>(row, terms, factors, rows),
        6 => written_out::<L, 6>(row, terms, factors, rows),
        _ => {
            for &(factor, first) in terms {
                let factor = factors[factor as usize];
                for (sum, from) in row.iter_mut().zip(&rows[first as usize..]) {
                    add_product(sum, &factor, from);
                }
            }
        }
    }
}

#[inline(always)]
fn written_out<const L: usize, const N: usize>(
    row: &mut [Pack<L>],
    terms: &[Term],
    factors: &[Pack<L>],
    rows: &[Pack<L>],
) {
    let Some(row) = row.first_chunk_mut::<N>() else { return };
    let mut sum = *row;
    for &(factor, first) in terms {
        let factor = factors[factor as usize];
        let Some(from) = rows[first as usize..].first_chunk::<N>() else { return };
        for (sum, from) in sum.iter_mut().zip(from) {
            add_product(sum, &factor, from);
        }
    }
    *row = sum;
}
