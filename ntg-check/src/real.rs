//! Numbers `m 2^e` with integers `m` of 62 bits, and operations that are rounded down or up as asked.
//!
//! Only integer operations are used: sums and products are exact in 128 bits before they are cut, so the direction of
//! every rounding is certain, whatever the processor's floating-point unit does.

use std::cmp::Ordering;

/// Bits of a mantissa.
const BITS: u32 = 62;

/// Beyond this exponent a number counts as too large to be known.
const LARGEST: i32 = 1 << 20;

/// `m 2^e`, with `2^61 <= |m| < 2^62` or `m = 0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Real {
    m: i64,
    e: i32,
}

/// In which direction a result is rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum To {
    /// Not above the exact result.
    Below,
    /// Not below it.
    Above,
}

/// A shift to the right, rounded.
fn shifted(m: i128, by: u32, to: To) -> i128 {
    let floor = if by >= 127 { m >> 127 } else { m >> by };
    let exact = by < 127 && floor << by == m || m == 0;
    floor + i128::from(to == To::Above && !exact)
}

impl Real {
    /// 0.
    pub(crate) const ZERO: Self = Self { m: 0, e: 0 };

    /// `m 2^e`, rounded to as many bits as there are.
    fn rounded(m: i128, e: i32, to: To) -> Self {
        if m == 0 {
            return Self::ZERO;
        }
        let bits = 128 - m.unsigned_abs().leading_zeros();
        if bits <= BITS {
            let by = BITS - bits;
            return Self { m: (m << by) as i64, e: e - by as i32 };
        }
        let by = bits - BITS;
        let cut = shifted(m, by, to);
        // Rounding away from 0 may have made one bit more, and then all others are 0.
        if cut.unsigned_abs() >= 1 << BITS {
            return Self { m: (cut >> 1) as i64, e: e + by as i32 + 1 };
        }
        // Rounding towards 0 keeps the leading bit.
        Self { m: cut as i64, e: e + by as i32 }
    }

    /// A whole number.
    pub(crate) fn whole(n: i64) -> Self {
        Self::rounded(i128::from(n), 0, To::Below)
    }

    /// `n 2^e`, exactly, for numbers of up to 62 bits.
    pub(crate) fn dyadic(n: i64, e: i32) -> Self {
        Self::rounded(i128::from(n), e, To::Below)
    }

    /// Whether its size is beyond what is kept.
    pub(crate) fn is_huge(self) -> bool {
        self.m != 0 && self.e > LARGEST
    }

    /// -1, 0 or 1.
    pub(crate) fn sign(self) -> i64 {
        self.m.signum()
    }

    /// The sum.
    pub(crate) fn plus(self, other: Self, to: To) -> Self {
        if self.m == 0 || other.m == 0 {
            return if self.m == 0 { other } else { self };
        }
        let (a, b) = if self.e >= other.e { (self, other) } else { (other, self) };
        let distance = (i64::from(a.e) - i64::from(b.e)).min(1 << 20) as u32;
        if distance <= BITS {
            return Self::rounded((i128::from(a.m) << distance) + i128::from(b.m), b.e, to);
        }
        let rest = shifted(i128::from(b.m), distance - BITS, to);
        Self::rounded((i128::from(a.m) << BITS) + rest, a.e - BITS as i32, to)
    }

    /// The product.
    pub(crate) fn times(self, other: Self, to: To) -> Self {
        Self::rounded(i128::from(self.m) * i128::from(other.m), self.e.saturating_add(other.e), to)
    }

    /// The quotient by a number that is not 0.
    pub(crate) fn over(self, other: Self, to: To) -> Self {
        let sign = other.m.signum();
        let (n, d) = (i128::from(self.m * sign) << 64, i128::from(other.m * sign));
        let floor = n.div_euclid(d);
        let quotient = floor + i128::from(to == To::Above && floor * d != n);
        Self::rounded(quotient, self.e.saturating_sub(other.e).saturating_sub(64), to)
    }

    /// The square root of a number that is not negative.
    pub(crate) fn root(self, to: To) -> Self {
        if self.m <= 0 {
            return Self::ZERO;
        }
        let odd = self.e.rem_euclid(2);
        let n = u128::from(self.m.unsigned_abs()) << (62 + odd);
        let floor = n.isqrt();
        let root = floor + u128::from(to == To::Above && floor * floor != n);
        Self::rounded(root as i128, (self.e - odd - 62) / 2, to)
    }

    /// Times a power of two, exactly.
    pub(crate) fn scaled(self, power: i32) -> Self {
        if self.m == 0 { self } else { Self { m: self.m, e: self.e.saturating_add(power) } }
    }

    /// The largest whole number that is not above it, as long as it has less than 62 bits.
    pub(crate) fn floor(self) -> Option<i64> {
        match self.e {
            _ if self.m == 0 => Some(0),
            e if e > 0 => None,
            e => Some((i128::from(self.m) >> (-e).min(127)) as i64),
        }
    }

    /// `f` and `k` with the number `f 2^k` and `f` in ½ .. 1, for what is positive.
    pub(crate) fn fraction(self) -> (Self, i32) {
        (Self { m: self.m, e: -(BITS as i32) }, self.e + BITS as i32)
    }
}

impl std::ops::Neg for Real {
    type Output = Self;
    fn neg(self) -> Self {
        Self { m: -self.m, e: self.e }
    }
}

impl Ord for Real {
    fn cmp(&self, other: &Self) -> Ordering {
        self.plus(-*other, To::Below).m.cmp(&0)
    }
}

impl PartialOrd for Real {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_on_the_side_that_was_asked_for() {
        let third = [To::Below, To::Above].map(|to| Real::whole(1).over(Real::whole(3), to));
        assert!(third[0] < third[1]);
        for (value, to) in third.into_iter().zip([Ordering::Less, Ordering::Greater]) {
            // Three times it, exactly: 64 bits fit into a sum of three.
            let thrice =
                value.plus(value, To::Below).plus(value, if to == Ordering::Less { To::Above } else { To::Below });
            assert!(thrice.cmp(&Real::whole(1)) != to.reverse());
        }
        let roots = [To::Below, To::Above].map(|to| Real::whole(2).root(to));
        assert!(roots[0].times(roots[0], To::Above) <= Real::whole(2).plus(Real::dyadic(1, -59), To::Above));
        assert!(
            roots[0].times(roots[0], To::Below) < Real::whole(2)
                && roots[1].times(roots[1], To::Above) > Real::whole(2)
        );
        assert_eq!(Real::whole(9).root(To::Above), Real::whole(3));
    }

    #[test]
    fn far_smaller_summands_show_in_the_direction_only() {
        let tiny = Real::dyadic(1, -900);
        assert!(Real::whole(1).plus(tiny, To::Above) > Real::whole(1));
        assert_eq!(Real::whole(1).plus(tiny, To::Below), Real::whole(1));
        assert!(Real::whole(1).plus(-tiny, To::Below) < Real::whole(1));
        assert_eq!(Real::whole(-1).plus(tiny, To::Below), Real::whole(-1));
        assert_eq!(Real::dyadic(7, -1).floor(), Some(3));
        assert_eq!(Real::dyadic(-7, -1).floor(), Some(-4));
    }
}
