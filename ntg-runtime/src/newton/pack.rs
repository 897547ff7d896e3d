//! Eight numbers side by side: the same entry of eight elements. The loops over them are written so
//! that the compiler turns each into a few vector instructions.

/// Elements that are worked on together.
pub(super) const LANES: usize = 8;

/// One number for each of eight elements.
pub(super) type Pack = [f64; LANES];

/// `sum += a b`.
#[inline(always)]
pub(super) fn add_product(sum: &mut Pack, a: &Pack, b: &Pack) {
    for lane in 0..LANES {
        sum[lane] += a[lane] * b[lane];
    }
}

/// `row += factor from`, pack by pack: both rows are equally long. Rows as long as splines have active
/// basis functions are written out, so that sums stay in registers.
#[inline(always)]
pub(super) fn add_row(row: &mut [Pack], factor: &Pack, from: &[Pack]) {
    #[inline(always)]
    fn fixed<const N: usize>(row: &mut [Pack], factor: &Pack, from: &[Pack]) {
        if let (Some(row), Some(from)) = (row.first_chunk_mut::<N>(), from.first_chunk::<N>()) {
            for i in 0..N {
                add_product(&mut row[i], factor, &from[i]);
            }
        }
    }
    match row.len() {
        1 => fixed::<1>(row, factor, from),
        2 => fixed::<2>(row, factor, from),
        3 => fixed::<3>(row, factor, from),
        4 => fixed::<4>(row, factor, from),
        5 => fixed::<5>(row, factor, from),
        6 => fixed::<6>(row, factor, from),
        _ => row.iter_mut().zip(from).for_each(|(to, from)| add_product(to, factor, from)),
    }
}

/// The sum of the products of two rows, pack by pack.
#[inline(always)]
pub(super) fn row_product(a: &[Pack], b: &[Pack]) -> Pack {
    let mut sum = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        add_product(&mut sum, a, b);
    }
    sum
}

/// `a b`.
#[inline(always)]
pub(super) fn product(a: &Pack, b: &Pack) -> Pack {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

/// `a - b`.
#[inline(always)]
pub(super) fn difference(a: &Pack, b: &Pack) -> Pack {
    std::array::from_fn(|lane| a[lane] - b[lane])
}

/// The numbers from `at` on, as far as there are any; zeros after them.
#[inline(always)]
pub(super) fn load(numbers: &[f64], at: usize, end: usize) -> Pack {
    if at + LANES <= end
        && let Some(whole) = numbers[at..].first_chunk::<LANES>()
    {
        return *whole;
    }
    let mut pack = [0.0; LANES];
    for (to, from) in pack.iter_mut().zip(&numbers[at..end]) {
        *to = *from;
    }
    pack
}
