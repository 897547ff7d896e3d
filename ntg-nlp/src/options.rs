//! What a caller may decide about a solve.
//!
//! [`Options`] are plain data with defaults that suit most programs. They can be cloned and sent to other threads.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What the callback answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Stop with [`Status::Cancelled`](crate::Status::Cancelled) and the present point.
    Cancel,
}

/// What the callback learns, once an iteration, before its step is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Iterations completed; 0 at the start.
    pub iteration: usize,
    /// The minimised objective, in the program's units.
    pub objective: f64,
    /// Largest scaled violation of a row or bound.
    pub primal: f64,
    /// Largest scaled component of the Lagrangian's gradient.
    pub dual: f64,
    /// Length of the last step, as a fraction of the one proposed; 0 at the start.
    pub step: f64,
    /// Seconds since the solve began.
    pub seconds: f64,
}

/// A function that watches a solve and may cancel it.
pub type OnIteration = Arc<dyn Fn(&Progress) -> Control + Send + Sync>;

/// Whether variables and rows are brought to comparable size (docs/maths.md, section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Scaling {
    /// By the sizes that the program gives ([`crate::Limits`]) and the first derivatives at the start; inequalities also by
    /// their bounds, where some are far steeper than these.
    #[default]
    Automatic,
    /// As [`Self::Automatic`], all rows by their derivatives alone.
    BySlopes,
    /// By the sizes of the variables alone.
    Off,
}

/// Which method solves a program (docs/maths.md, section 11.9).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// The structured interior-point method; where that fails, the same with elastic bounds; sequential
    /// quadratic programming last.
    #[default]
    Auto,
    /// Sequential quadratic programming on Clarabel (feature `sqp`).
    #[cfg(feature = "sqp")]
    Sqp,
    /// The structured interior-point method alone.
    InteriorPoint,
    /// The same on the augmented Lagrangian, with estimates of multipliers in place of the filter (docs/maths.md, section
    /// 11.11): slower as a rule, and it does not mind rows that depend on each other.
    AugmentedLagrangian,
}

/// What a restoration of feasibility makes small (docs/maths.md, section 11.6). Either solves programs that the other one
/// does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Violations {
    /// The sum of violations.
    #[default]
    Absolute,
    /// The sum of their squares.
    Squared,
}

/// How the matrix of a step is given the inertia of a minimum where it has another one (docs/maths.md, section 11.3).
/// Either solves programs that the other one does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum InertiaCorrection {
    /// The second derivatives of each element are made positive semidefinite: steps keep a measure of length along
    /// directions of negative curvature, and stay in the neighbourhood of a good guess.
    #[default]
    ByElement,
    /// The least multiple of the identity that is enough is added: steps keep Newton's curvature along all other
    /// directions, and large elements cost less.
    ByShift,
}

/// The loosest tolerance at which a solution is polished: with this tolerance and looser ones a solution serves as a
/// guess only.
pub const ROUGH_TOLERANCE: f64 = 1e-4;

/// How to solve. `Options::default()` suits most programs.
#[derive(Clone)]
pub struct Options {
    /// Which method solves the program. Default [`Method::Auto`].
    pub method: Method,
    /// Largest scaled stationarity and complementarity residual of a solution (docs/maths.md, section 6).
    /// Default 1e-8.
    pub tolerance: f64,
    /// Largest scaled violation of a constraint at a solution. Default 1e-8.
    pub constraint_tolerance: f64,
    /// Most iterations of one method. Default 500.
    pub max_iterations: usize,
    /// Most quadratic programs of sequential quadratic programming, of which an iteration may need several. Default
    /// unlimited.
    pub max_subproblems: usize,
    /// Most wall-clock time, checked once an iteration. Default none.
    pub time_limit: Option<Duration>,
    /// Called once an iteration; may cancel. Default none.
    pub on_iteration: Option<OnIteration>,
    /// Whether to scale automatically. Default [`Scaling::Automatic`].
    pub scaling: Scaling,
    /// Whether rejected steps are corrected for the curvature of the constraints
    /// (docs/maths.md, sections 6 and 11.5). Default true.
    pub second_order_correction: bool,
    /// Whether sequential quadratic programming tries Newton's step with the exact Hessian once the set of
    /// active constraints has settled. The interior-point method always has the exact Hessian. Default true.
    pub exact_hessian: bool,
    /// What the interior-point method makes small where it restores feasibility. Default [`Violations::Absolute`].
    pub restoration: Violations,
    /// How the interior-point method corrects the inertia of its matrix. Default [`InertiaCorrection::ByElement`].
    pub inertia_correction: InertiaCorrection,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            tolerance: 1e-8,
            constraint_tolerance: 1e-8,
            max_iterations: 500,
            max_subproblems: usize::MAX,
            time_limit: None,
            on_iteration: None,
            scaling: Scaling::Automatic,
            second_order_correction: true,
            exact_hessian: true,
            restoration: Violations::Absolute,
            inertia_correction: InertiaCorrection::ByElement,
        }
    }
}

impl fmt::Debug for Options {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Options")
            .field("method", &self.method)
            .field("tolerance", &self.tolerance)
            .field("constraint_tolerance", &self.constraint_tolerance)
            .field("max_iterations", &self.max_iterations)
            .field("max_subproblems", &self.max_subproblems)
            .field("time_limit", &self.time_limit)
            .field("on_iteration", &self.on_iteration.as_ref().map(|_| "a function"))
            .field("scaling", &self.scaling)
            .field("second_order_correction", &self.second_order_correction)
            .field("exact_hessian", &self.exact_hessian)
            .field("restoration", &self.restoration)
            .field("inertia_correction", &self.inertia_correction)
            .finish()
    }
}

impl Options {
    /// Whether the solution serves as a guess only and is not polished.
    pub(crate) fn is_rough(&self) -> bool {
        self.tolerance.min(self.constraint_tolerance) >= ROUGH_TOLERANCE
    }

    /// Whether the time limit was reached by more than a person notices, before the first iteration.
    pub(crate) fn is_overdue(&self, begin: Instant) -> bool {
        /// So long after its limit the first point may be looked at. A choice.
        const GRACE: Duration = Duration::from_millis(100);
        self.time_limit.is_some_and(|limit| begin.elapsed() >= limit.saturating_add(GRACE))
    }

    /// The same with what is left of the time limit after some time.
    #[must_use]
    pub fn after(&self, elapsed: Duration) -> Self {
        let time_limit = self.time_limit.map(|limit| limit.saturating_sub(elapsed).max(Duration::from_nanos(1)));
        Self { time_limit, ..self.clone() }
    }
}
