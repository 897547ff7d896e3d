//! Places along a Hilbert curve: points that are near each other on the curve are near each other in space.
//!
//! Source: J. Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 381 (2004): from coordinates
//! to the transposed index.

/// Bits of each coordinate, at most; 2^16 steps tell more sets apart than a study has along one parameter.
const BITS: u32 = 16;

/// The place of a set on the curve, its words in order of weight. `ends` are the columns that count, with their
/// least and greatest value; what is not finite is put at the end.
pub(crate) fn key(set: &[f64], ends: &[(usize, f64, f64)]) -> Vec<u32> {
    let steps = f64::from((1_u32 << BITS) - 1);
    let step = |&(column, least, most): &(usize, f64, f64)| {
        let share = (set[column] - least) / (most - least);
        // Saturates, and takes NaN for 0.
        (share * steps).round() as u32
    };
    let mut x: Vec<u32> = ends.iter().map(|end| step(end).min((1 << BITS) - 1)).collect();
    transpose(&mut x);
    words(&x)
}

/// From coordinates to the transposed Hilbert index: bit `b` of word `i` is bit `b * n + (n - 1 - i)` of the index.
fn transpose(x: &mut [u32]) {
    let n = x.len();
    if n == 0 {
        return;
    }
    let mut q = 1_u32 << (BITS - 1);
    while q > 1 {
        let p = q - 1;
        for i in 0..n {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    for i in 1..n {
        x[i] ^= x[i - 1];
    }
    let mut t = 0;
    let mut q = 1_u32 << (BITS - 1);
    while q > 1 {
        if x[n - 1] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    x.iter_mut().for_each(|word| *word ^= t);
}

/// The index as words that compare like it.
fn words(x: &[u32]) -> Vec<u32> {
    let bits = (0..BITS).rev().flat_map(|bit| x.iter().map(move |word| word >> bit & 1));
    let bits: Vec<u32> = bits.collect();
    bits.chunks(32).map(|chunk| chunk.iter().fold(0, |word, bit| word << 1 | bit) << (32 - chunk.len())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_points_of_the_curve_are_neighbours_in_two_and_three_dimensions() {
        // A grid of 2^k points a side: the curve goes through it in steps of one.
        for (dimensions, side) in [(2_usize, 16_u32), (3, 8)] {
            let count = side.pow(dimensions as u32);
            let point = |i: u32| (0..dimensions as u32).map(|d| i / side.pow(d) % side).collect::<Vec<u32>>();
            let mut points: Vec<Vec<u32>> = (0..count).map(point).collect();
            let key = |p: &Vec<u32>| {
                // The uppermost bits hold the coordinate.
                let mut x: Vec<u32> = p.iter().map(|c| c << (BITS - side.ilog2())).collect();
                transpose(&mut x);
                words(&x)
            };
            points.sort_by_key(key);
            for pair in points.windows(2) {
                let apart: u32 = pair[0].iter().zip(&pair[1]).map(|(a, b)| a.abs_diff(*b)).sum();
                assert_eq!(apart, 1, "{pair:?}");
            }
        }
    }
}
