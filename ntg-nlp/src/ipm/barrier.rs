//! The barrier parameter: when it falls, and how far (docs/maths.md, section 11.4; lines 6 and 8 of Algorithm 11).

use super::mode::Mode;
use super::state::State;
use crate::contract::Nlp;
use crate::status::Status;

/// The last barrier parameter as a fraction of the tolerance. WB: 1/10 of the tolerance.
const LAST: f64 = 0.1;
/// A barrier problem is solved well enough when its error is below this multiple of the parameter: kappa_epsilon of WB
/// (6).
const KAPPA_EPSILON: f64 = 10.0;
/// Or when the step promises less than this for each inequality, as a multiple of the parameter. A fit to the flights
/// of `examples/robustness.rs`.
const PROMISE: f64 = 0.1;
/// Slacks of more than this multiple of the parameter feel a residual by the part of them that it is, equation (11.6b). A fit to
/// swarms of 6 to 16 vehicles: with 1e5 most of what is gained is lost, with 100 nothing more is gained.
const FAR: f64 = 1e3;
/// Linear and superlinear decrease: kappa_mu and theta_mu of WB (7).
const KAPPA_MU: f64 = 0.2;
const THETA_MU: f64 = 1.5;

impl<N: Nlp> State<'_, N> {
    /// The barrier parameter that ends the sequence.
    pub(super) fn last_barrier(&self) -> f64 {
        self.last.factor
            * self.polish_factor()
            * LAST
            * self.options.tolerance.min(self.options.constraint_tolerance)
            * self.barrier_unit
    }

    /// Lowers the barrier parameter as long as its problem is solved well enough, equation (11.6). A status where the
    /// penalty parameter would have to rise and cannot.
    pub(super) fn lower_barrier(&mut self) -> Option<Status> {
        let dual = self.record.residuals.scaled.dual;
        let (before, last) = (self.mu, self.last_barrier());
        let estimates = matches!(self.mode, Mode::Augmented(_));
        while self.mu > last || estimates {
            let enough = KAPPA_EPSILON * self.mu;
            if dual > enough || self.error_to_lower() > enough {
                break;
            }
            if let Some(status) = self.update_price() {
                return Some(status);
            }
            if self.mu > last {
                self.decrease_mu(last);
            }
            if estimates {
                break; // New estimates are another problem.
            }
        }
        if self.mu != before {
            self.filter.clear();
        }
        None
    }

    /// Lowers the barrier parameter as long as the step promises little beside what the barrier costs (11.6a), and
    /// solves for the step of the new parameter with the same factors: the matrix does not depend on it. False where
    /// that step is not finite.
    pub(super) fn lower_barrier_along_step(&mut self) -> bool {
        let last = self.last_barrier();
        let inequalities = self.slacks.inequalities.len() as f64;
        // Steps that a shift has shortened promise little wherever they are.
        let is_short = self.record.shift > 0.0 && !self.record.convexified;
        if inequalities == 0.0 || is_short {
            return true;
        }
        while self.mu > last {
            let promised = -self.slope();
            if promised > PROMISE * self.mu * inequalities || self.error_to_lower() > KAPPA_EPSILON * self.mu {
                break;
            }
            self.decrease_mu(last);
            self.filter.clear();
            if !self.solve_for_step() {
                return false;
            }
        }
        true
    }

    /// The error of the barrier problem's optimality conditions without the gradient of the Lagrangian: residuals (in
    /// penalty mode the relaxations' centrality) and centrality. Residuals count as in (11.6b) with slacks that exceed `far`.
    fn barrier_error(&self, far: f64) -> f64 {
        let residual = match self.mode.relaxed() {
            Some(relaxed) => relaxed.centrality(&self.slacks, self.mu) / self.s_d,
            None => self.slacks.residual_beside_slacks(&self.values, far),
        };
        residual.max(self.slacks.centrality(self.mu) / self.s_d)
    }

    /// The error by which the barrier parameter is lowered. Beside a known solution residuals fall with the squares of steps, and
    /// nothing is gained by (11.6b).
    fn error_to_lower(&self) -> f64 {
        let is_near = !self.is_warm && self.record.residuals.scaled.dual <= FAR * self.mu;
        self.barrier_error(if is_near { FAR * self.mu } else { f64::INFINITY })
    }

    /// The largest residual of the barrier problem's optimality conditions.
    pub(super) fn barrier_problem_error(&self) -> f64 {
        self.record.residuals.scaled.dual.max(self.barrier_error(f64::INFINITY))
    }

    /// Whether the problem of the last barrier parameter is solved well enough.
    pub(super) fn last_barrier_problem_is_solved(&self) -> bool {
        self.mu <= self.last_barrier()
            && self.barrier_problem_error() <= (KAPPA_EPSILON * self.mu).max(self.options.tolerance)
    }

    /// Lowers the barrier parameter although its problem is not solved well enough; false where it is the last one.
    pub(super) fn force_lower_barrier(&mut self) -> bool {
        let last = self.last_barrier();
        let can_fall = self.mu > last;
        if can_fall {
            self.decrease_mu(last);
            self.filter.clear();
        }
        can_fall
    }

    fn decrease_mu(&mut self, last: f64) {
        let relative = self.mu / self.barrier_unit;
        self.mu = (self.barrier_unit * (KAPPA_MU * relative).min(relative.powf(THETA_MU))).max(last);
    }
}
