//! The knot vector of one output: order, breakpoints and smoothness.
//!
//! A spline of order `k` (degree `k - 1`) on `l` intervals of scaled time `0 ..= 1`,
//! with `m` smoothness conditions at each interior breakpoint (so it is `C^(m-1)`),
//! has knots of multiplicity `k` at both ends and `k - m` inside, and therefore
//! `l (k - m) + m` coefficients (docs/maths.md, section 1, equations 1.1 and 1.2).
//!
//! Takes order, breakpoints and smoothness; finds impossible ones ([`KnotError`]).
//! Afterwards: every interval has positive length and at most [`MAX_ORDER`]
//! B-splines, so that evaluation needs no checks and no allocation.

use std::fmt;

/// Largest order of a spline. Higher ones are never useful in double precision.
pub const MAX_ORDER: usize = 32;

/// Largest number of intervals: a guard against a slip of the keyboard that would exhaust memory.
pub const MAX_INTERVALS: usize = 100_000;

/// From which side a value is taken where a derivative may jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The limit from smaller arguments.
    Left,
    /// The limit from larger arguments; at the end of the domain, where there are none, from the left.
    Right,
}

/// The knots of one spline over scaled time `0 ..= 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    order: usize,
    smoothness: usize,
    breakpoints: Vec<f64>,
    knots: Vec<f64>,
}

/// Why no spline has the order, breakpoints and smoothness that were asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum KnotError {
    /// The order is 0 or above [`MAX_ORDER`].
    Order {
        /// The order that was asked for.
        order: usize,
    },
    /// More smoothness conditions than `order - 1`: they would leave a single polynomial.
    Smoothness {
        /// The order that was asked for.
        order: usize,
        /// The number of smoothness conditions that was asked for.
        smoothness: usize,
    },
    /// No interval at all, or more than [`MAX_INTERVALS`].
    Intervals {
        /// The number of intervals that was asked for.
        intervals: usize,
    },
    /// A breakpoint is infinite or not a number.
    NotFinite {
        /// Which breakpoint, counted from 0.
        index: usize,
    },
    /// A breakpoint does not exceed the one before it.
    NotIncreasing {
        /// Which breakpoint, counted from 0.
        index: usize,
    },
    /// The breakpoints do not begin at 0 and end at 1.
    Ends {
        /// The first breakpoint.
        first: f64,
        /// The last breakpoint.
        last: f64,
    },
}

impl fmt::Display for KnotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Order { order } => {
                write!(f, "the order of a spline must be between 1 and {MAX_ORDER}, but it is {order}")
            }
            Self::Smoothness { order, smoothness } => write!(
                f,
                "a spline of order {order} can have at most {} smoothness conditions at a breakpoint, but {smoothness} are asked for",
                order.saturating_sub(1)
            ),
            Self::Intervals { intervals } => {
                write!(f, "a spline needs between 1 and {MAX_INTERVALS} intervals, but it has {intervals}")
            }
            Self::NotFinite { index } => write!(f, "breakpoint {} is not a finite number", index + 1),
            Self::NotIncreasing { index } => {
                write!(f, "breakpoint {} is not larger than the one before it", index + 1)
            }
            Self::Ends { first, last } => {
                write!(f, "the breakpoints must begin at 0 and end at 1, but they begin at {first} and end at {last}")
            }
        }
    }
}

impl std::error::Error for KnotError {}

impl Knots {
    /// Knots on `intervals` equal intervals.
    ///
    /// # Errors
    /// [`KnotError`] if the order, the smoothness or the number of intervals is impossible.
    pub fn uniform(order: usize, intervals: usize, smoothness: usize) -> Result<Self, KnotError> {
        if !(1..=MAX_INTERVALS).contains(&intervals) {
            return Err(KnotError::Intervals { intervals });
        }
        let breakpoints = (0..=intervals).map(|i| i as f64 / intervals as f64).collect();
        Self::new(order, breakpoints, smoothness)
    }

    /// Knots on given breakpoints, which increase from 0 to 1 (scaled time, dimensionless).
    ///
    /// # Errors
    /// [`KnotError`] if no spline has this order, these breakpoints and this smoothness.
    pub fn new(order: usize, breakpoints: Vec<f64>, smoothness: usize) -> Result<Self, KnotError> {
        check(order, &breakpoints, smoothness)?;
        let last = breakpoints.len() - 1;
        let mut knots = vec![];
        for (i, breakpoint) in breakpoints.iter().enumerate() {
            let multiplicity = if i == 0 || i == last { order } else { order - smoothness };
            knots.extend(std::iter::repeat_n(*breakpoint, multiplicity));
        }
        Ok(Self { order, smoothness, breakpoints, knots })
    }

    /// The order `k`: one more than the degree.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The number `m` of smoothness conditions at each interior breakpoint.
    pub fn smoothness(&self) -> usize {
        self.smoothness
    }

    /// The breakpoints, from 0 to 1; one more than there are intervals.
    pub fn breakpoints(&self) -> &[f64] {
        &self.breakpoints
    }

    /// The knots, breakpoints repeated by their multiplicity; `coefficients() + order()` of them.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The number `l` of intervals.
    pub fn intervals(&self) -> usize {
        self.breakpoints.len() - 1
    }

    /// The number of coefficients, `l (k - m) + m` (equation 1.2).
    pub fn coefficients(&self) -> usize {
        self.intervals() * (self.order - self.smoothness) + self.smoothness
    }

    /// The interval that holds `tau`; at a breakpoint the one on the given side.
    ///
    /// Beyond the ends it is the first or the last interval, whose polynomial goes on there.
    pub fn interval(&self, tau: f64, side: Side) -> usize {
        // Where breakpoints are equally spaced, as they mostly are, this is the interval, or one beside it.
        let likely = ((tau * self.intervals() as f64) as usize).min(self.intervals() - 1);
        if self.breakpoints[likely] < tau && tau < self.breakpoints[likely + 1] {
            return likely;
        }
        let inner = &self.breakpoints[1..self.intervals()];
        match side {
            Side::Left => inner.partition_point(|b| *b < tau),
            Side::Right => inner.partition_point(|b| *b <= tau),
        }
    }

    /// Index of the first of the `order()` coefficients that act on an interval.
    pub fn support_start(&self, interval: usize) -> usize {
        interval * (self.order - self.smoothness)
    }

    /// Index of the last knot at the beginning of an interval.
    pub fn span(&self, interval: usize) -> usize {
        self.support_start(interval) + self.order - 1
    }

    /// The Greville abscissae, one for each coefficient (equation 1.7).
    ///
    /// A spline whose coefficients are the values of a straight line there *is* that line
    /// (for order 1, whose splines are steps, they are the middles of the intervals).
    pub fn greville(&self) -> Vec<f64> {
        greville(&self.knots, self.order)
    }
}

/// The Greville abscissae of any knot vector (equation 1.7).
pub(crate) fn greville(knots: &[f64], order: usize) -> Vec<f64> {
    let abscissa = |i: usize| match order {
        1 => 0.5 * (knots[i] + knots[i + 1]),
        _ => {
            let inner = &knots[i + 1..i + order];
            let mean = inner.iter().sum::<f64>() / inner.len() as f64;
            // Rounding must not carry the mean of equal knots past them.
            mean.clamp(inner[0], inner[inner.len() - 1])
        }
    };
    (0..knots.len() - order).map(abscissa).collect()
}

fn check(order: usize, breakpoints: &[f64], smoothness: usize) -> Result<(), KnotError> {
    if !(1..=MAX_ORDER).contains(&order) {
        return Err(KnotError::Order { order });
    }
    if smoothness >= order {
        return Err(KnotError::Smoothness { order, smoothness });
    }
    let intervals = breakpoints.len().saturating_sub(1);
    if !(1..=MAX_INTERVALS).contains(&intervals) {
        return Err(KnotError::Intervals { intervals });
    }
    if let Some(index) = breakpoints.iter().position(|b| !b.is_finite()) {
        return Err(KnotError::NotFinite { index });
    }
    if let Some(before) = breakpoints.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(KnotError::NotIncreasing { index: before + 1 });
    }
    let (first, last) = (breakpoints[0], breakpoints[intervals]);
    if first != 0.0 || last != 1.0 {
        return Err(KnotError::Ends { first, last });
    }
    Ok(())
}
