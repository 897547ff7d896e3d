//! The Sobol sequence, shifted at random.
//!
//! Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
//! SIAM Journal on Scientific Computing 30, 2635 (2008), the set new-joe-kuo-6. The shift is added bit by bit
//! (P. L'Ecuyer and C. Lemieux, "Recent advances in randomized quasi-Monte Carlo methods", section 3.3, 2002): it keeps
//! every interval of every axis with its one point.

/// Bits of a coordinate: as many points may be drawn before the sequence repeats itself.
const BITS: usize = 32;

/// Degree and inner coefficients of the primitive polynomial, and the initial numbers, of the dimensions from the second.
const DIRECTIONS: [(u32, &[u32]); 20] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
    (19, &[1, 1, 1, 15, 7, 5]),
    (22, &[1, 3, 1, 15, 13, 25]),
    (25, &[1, 1, 5, 5, 19, 61]),
    (1, &[1, 3, 7, 11, 23, 15, 103]),
    (4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Dimensions that there are numbers for.
const MOST: usize = DIRECTIONS.len() + 1;

/// `count` points.
pub(crate) fn points(count: usize, dimensions: usize, random: &mut fastrand::Rng) -> Result<Vec<Vec<f64>>, String> {
    if dimensions > MOST {
        return Err(format!(
            "the Sobol sequence is known here for {MOST} dispersed parameters, not for {dimensions}; take the design \
             latin-hypercube"
        ));
    }
    if count as u64 >= 1 << BITS {
        return Err(format!("the Sobol sequence has 2^{BITS} points"));
    }
    let directions: Vec<[u32; BITS]> = (0..dimensions).map(directions).collect();
    let shifts: Vec<u32> = (0..dimensions).map(|_| random.u32(..)).collect();
    let point = |index: usize| -> Vec<f64> {
        let gray = index ^ index >> 1;
        let coordinate = |(directions, shift): (&[u32; BITS], &u32)| {
            let bits = (0..BITS).filter(|bit| gray >> bit & 1 == 1);
            let word = bits.fold(*shift, |word, bit| word ^ directions[bit]);
            (f64::from(word) + 0.5) / 2_f64.powi(BITS as i32)
        };
        directions.iter().zip(&shifts).map(coordinate).collect()
    };
    Ok((0..count).map(point).collect())
}

/// The direction numbers of one dimension, as fractions of 2^32.
fn directions(dimension: usize) -> [u32; BITS] {
    let mut v = [0; BITS];
    let Some((inner, first)) = dimension.checked_sub(1).map(|d| DIRECTIONS[d]) else {
        return std::array::from_fn(|i| 1 << (BITS - 1 - i));
    };
    let degree = first.len();
    for i in 0..BITS {
        v[i] = match i.checked_sub(degree) {
            None => first[i] << (BITS - 1 - i),
            Some(back) => (1..degree).fold(v[back] ^ v[back] >> degree, |word, k| {
                if inner >> (degree - 1 - k) & 1 == 1 { word ^ v[i - k] } else { word }
            }),
        };
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_of_the_published_sequence() {
        // Without the shift; the first points of the set new-joe-kuo-6 in Gray code's order.
        let unshifted = |index: usize, dimension: usize| {
            let gray = index ^ index >> 1;
            let word = (0..BITS).filter(|bit| gray >> bit & 1 == 1).fold(0, |w, bit| w ^ directions(dimension)[bit]);
            f64::from(word) / 2_f64.powi(32)
        };
        let wanted = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25, 0.25],
            [0.25, 0.75, 0.75, 0.75],
            [0.375, 0.375, 0.625, 0.875],
        ];
        for (index, point) in wanted.iter().enumerate() {
            for (dimension, value) in point.iter().enumerate() {
                assert_eq!(unshifted(index, dimension), *value, "point {index}, dimension {dimension}");
            }
        }
    }

    #[test]
    fn every_axis_has_one_point_in_every_interval_in_all_dimensions() {
        let points = points(1024, MOST, &mut fastrand::Rng::with_seed(9)).expect("points");
        for axis in 0..MOST {
            let mut cells: Vec<usize> = points.iter().map(|point| (point[axis] * 1024.0) as usize).collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..1024).collect::<Vec<_>>(), "axis {axis}");
        }
    }
}
