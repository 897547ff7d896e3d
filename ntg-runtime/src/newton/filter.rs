//! The filter: which pairs of infeasibility and barrier objective are progress
//! (docs/maths.md, section 11.5).
//!
//! Reference: A. Wächter and L. T. Biegler, *Math. Prog.* 106 (2006), section 2.3.

/// Progress asked for in infeasibility, and in the objective per infeasibility.
const MARGIN: f64 = 1e-5;

/// No point is accepted whose infeasibility exceeds the first one, or 1, this many times. (Reference: 1e4. There the
/// direction is that of a shifted Hessian and short; here it may be long, and what is that far away is no progress.)
pub(super) const LARGEST_THETA: f64 = 1e2;

/// Pairs that a new point must improve on.
#[derive(Clone, Debug, Default)]
pub(super) struct Filter {
    pairs: Vec<(f64, f64)>,
    /// No point is accepted above this infeasibility.
    pub(super) limit: f64,
}

impl Filter {
    /// Room for one pair an iteration.
    pub(super) fn for_iterations(most: usize) -> Self {
        Self { pairs: Vec::with_capacity(most + 1), limit: 0.0 }
    }

    /// Forgets all pairs.
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Whether a pair is acceptable to all that are held.
    pub(super) fn accepts(&self, theta: f64, phi: f64) -> bool {
        theta <= self.limit && self.pairs.iter().all(|(t, p)| theta < *t || phi < *p)
    }

    /// Whether a pair improves on another by the margin.
    pub(super) fn improves(theta: f64, phi: f64, on: (f64, f64)) -> bool {
        // The comparison allows for rounding in the objective.
        let rounding = 10.0 * f64::EPSILON * on.1.abs();
        theta <= (1.0 - MARGIN) * on.0 || phi - rounding <= on.1 - MARGIN * on.0
    }

    /// Holds a pair from now on, with its margin.
    pub(super) fn add(&mut self, theta: f64, phi: f64) {
        let pair = ((1.0 - MARGIN) * theta, phi - MARGIN * theta);
        self.pairs.retain(|(t, p)| *t < pair.0 || *p < pair.1);
        self.pairs.push(pair);
    }
}
