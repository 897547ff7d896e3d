//! The filter: which pairs of infeasibility and barrier objective are progress
//! (docs/maths.md, section 11.5).
//!
//! Reference: WB, section 2.3.

/// Progress asked for in infeasibility, and in the objective per infeasibility: gamma_theta and gamma_phi of WB.
const MARGIN: f64 = 1e-5;

/// No point is accepted whose infeasibility exceeds the first one, or 1, this many times. WB: 1e4. There the
/// step is that of a shifted Hessian and short; here it may be long, and a point that far away is no progress.
/// Infeasibility is a sum: of thousands of residuals 1 each is no more than 1 of one.
pub(super) const LARGEST_THETA: f64 = 1e2;

/// Pairs that a new point must improve on.
#[derive(Clone, Debug, Default)]
pub(super) struct Filter {
    /// Infeasibility and barrier objective, each less its margin.
    pairs: Vec<(f64, f64)>,
    /// No point is accepted above this infeasibility, or 1 for each residual where that is more.
    pub(super) theta_max: f64,
    /// How many residuals of inequalities infeasibility is the sum of.
    pub(super) residuals: usize,
}

impl Filter {
    /// An empty filter with memory for one pair an iteration.
    pub(super) fn with_capacity(iterations: usize) -> Self {
        Self { pairs: Vec::with_capacity(iterations + 1), theta_max: 0.0, residuals: 0 }
    }

    /// Removes all pairs.
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Whether a pair is acceptable to all that are held.
    pub(super) fn accepts(&self, theta: f64, phi: f64) -> bool {
        theta <= self.theta_max.max(self.residuals as f64) && self.pairs.iter().all(|(t, p)| theta < *t || phi < *p)
    }

    /// Whether a pair improves on the pair of the present point by the margin, WB (18).
    pub(super) fn improves(theta: f64, phi: f64, on: (f64, f64)) -> bool {
        // The comparison allows for rounding in the objective.
        let rounding = 10.0 * f64::EPSILON * on.1.abs();
        theta <= (1.0 - MARGIN) * on.0 || phi - rounding <= on.1 - MARGIN * on.0
    }

    /// Adds a pair with its margin, WB (22), and removes the pairs that it dominates.
    pub(super) fn add(&mut self, theta: f64, phi: f64) {
        let pair = ((1.0 - MARGIN) * theta, phi - MARGIN * theta);
        self.pairs.retain(|(t, p)| *t < pair.0 || *p < pair.1);
        self.pairs.push(pair);
    }
}
