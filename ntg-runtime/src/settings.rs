//! What a user may decide about a solve.
//!
//! Settings are plain data with defaults that suit most problems; [`Settings::validate`] says in
//! words which field is out of its range. They can be cloned and sent to other threads.

pub use ntg_nlp::options::{Control, InertiaCorrection, Method, OnIteration, Progress, Scaling, Violations};

use ntg_nlp::Options;
use ntg_nlp::options::ROUGH_TOLERANCE;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How to solve. `Settings::default()` suits most problems.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let settings = Settings {
///     tolerance: 1e-9,
///     time_limit: Some(std::time::Duration::from_secs(60)),
///     // Watches every iteration, and gives up after three.
///     on_iteration: Some(std::sync::Arc::new(|progress| match progress.iteration {
///         0..3 => Control::Continue,
///         _ => Control::Cancel,
///     })),
///     ..Settings::default()
/// };
/// settings.validate()?;
/// assert!(Move::default().solve(&settings)?.report().iterations <= 3);
/// assert!(Settings { tolerance: -1.0, ..settings }.validate().is_err());
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Settings {
    /// Which method solves the problem. Default [`Method::Auto`].
    pub method: Method,
    /// Largest scaled stationarity and complementarity residual of a solution
    /// (docs/maths.md, section 6); between 1e-12 and 0.1. Default 1e-8.
    pub tolerance: f64,
    /// Largest scaled violation of a constraint at a solution; between 1e-12 and 0.1. Default 1e-8.
    pub constraint_tolerance: f64,
    /// Most iterations of everything that a solve does: starts on coarser knots, steps of a continuation, further
    /// attempts where one fails, of at most 500 iterations each; at least 1. Default 2000.
    pub max_iterations: usize,
    /// Most wall-clock time, checked once an iteration and while the problem is set up; greater than zero. Default none.
    pub time_limit: Option<Duration>,
    /// Called once an iteration; may cancel. Default none.
    pub on_iteration: Option<OnIteration>,
    /// Whether to scale automatically. Default [`Scaling::Automatic`].
    pub scaling: Scaling,
    /// Typical sizes of outputs and variables, by name, each in its declared unit and positive;
    /// they take precedence over automatic ones. Default none.
    pub scales: Vec<(String, f64)>,
    /// After a solve, constraints and cost are checked on a grid with this many points for each
    /// point of the transcription; at least 1. Default 20.
    pub samples: usize,
    /// Whether a solve is followed by others on finer meshes, and how far
    /// (docs/maths.md, section 14). Default none.
    pub refine: Option<Refinement>,
    /// What becomes of a solution that violates constraints between the points of the transcription by more than
    /// `between_tolerance`. Default [`Between::Report`].
    pub between: Between,
    /// The largest violation between the points, relative to the constraint's bound (docs/maths.md, equation 9.3), of
    /// which nothing is said; positive. Default 0.01.
    pub between_tolerance: f64,
    /// Whether steps are corrected for the curvature of the constraints
    /// (docs/maths.md, section 6, second-order correction). Default true.
    pub second_order_correction: bool,
    /// Whether sequential quadratic programming ([`Method::Sqp`]) tries Newton's step with the exact Hessian once the
    /// set of active constraints has settled; without it, the last digits come slowly. The interior-point method always
    /// has the exact Hessian. Default true.
    pub exact_hessian: bool,
    /// What the interior-point method makes small where it restores feasibility. [`Method::Auto`] tries the other one where
    /// the first attempt fails. Default [`Violations::Absolute`].
    pub restoration: Violations,
    /// How the interior-point method corrects the inertia of its matrix. [`Method::Auto`] tries the other way where the
    /// first attempt fails. Default [`InertiaCorrection::ByElement`].
    pub inertia_correction: InertiaCorrection,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            tolerance: 1e-8,
            constraint_tolerance: 1e-8,
            max_iterations: 2000,
            time_limit: None,
            on_iteration: None,
            scaling: Scaling::Automatic,
            scales: Vec::new(),
            samples: 20,
            refine: None,
            between: Between::default(),
            between_tolerance: 0.01,
            second_order_correction: true,
            exact_hessian: true,
            restoration: Violations::Absolute,
            inertia_correction: InertiaCorrection::ByElement,
        }
    }
}

impl fmt::Debug for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Settings")
            .field("method", &self.method)
            .field("tolerance", &self.tolerance)
            .field("constraint_tolerance", &self.constraint_tolerance)
            .field("max_iterations", &self.max_iterations)
            .field("time_limit", &self.time_limit)
            .field("on_iteration", &self.on_iteration.as_ref().map(|_| "a function"))
            .field("scaling", &self.scaling)
            .field("scales", &self.scales)
            .field("samples", &self.samples)
            .field("refine", &self.refine)
            .field("between", &self.between)
            .field("between_tolerance", &self.between_tolerance)
            .field("second_order_correction", &self.second_order_correction)
            .field("exact_hessian", &self.exact_hessian)
            .field("restoration", &self.restoration)
            .field("inertia_correction", &self.inertia_correction)
            .finish()
    }
}

/// A setting that is out of its range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidSetting {
    /// The field.
    pub field: &'static str,
    /// What is wrong with it and what it must be.
    pub message: String,
}

impl fmt::Display for InvalidSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "setting `{}`: {}", self.field, self.message)
    }
}

impl std::error::Error for InvalidSetting {}

impl Settings {
    /// What of these settings concerns the solver of nonlinear programs.
    pub fn solver_options(&self) -> Options {
        Options {
            method: self.method,
            tolerance: self.tolerance,
            constraint_tolerance: self.constraint_tolerance,
            max_iterations: self.max_iterations,
            max_subproblems: usize::MAX,
            time_limit: self.time_limit,
            on_iteration: self.on_iteration.clone(),
            scaling: self.scaling,
            second_order_correction: self.second_order_correction,
            exact_hessian: self.exact_hessian,
            restoration: self.restoration,
            inertia_correction: self.inertia_correction,
        }
    }

    /// The same for a solution that only serves as a guess: of coarser knots, or of a step of a continuation.
    pub(crate) fn rough(&self) -> Self {
        let tolerance = self.tolerance.max(ROUGH_TOLERANCE);
        let constraint_tolerance = self.constraint_tolerance.max(ROUGH_TOLERANCE);
        Self { tolerance, constraint_tolerance, ..self.clone() }
    }

    /// The same with a callback that, once it has asked to stop, is not asked again: a problem may be
    /// solved in several parts, and none may go on after one was cancelled.
    pub(crate) fn remembering(&self) -> Self {
        let Some(watch) = self.on_iteration.clone() else { return self.clone() };
        let cancelled = AtomicBool::new(false);
        let remember: OnIteration = Arc::new(move |progress| {
            if cancelled.load(Ordering::Relaxed) || watch(progress) == Control::Cancel {
                cancelled.store(true, Ordering::Relaxed);
                return Control::Cancel;
            }
            Control::Continue
        });
        Self { on_iteration: Some(remember), ..self.clone() }
    }

    /// The same with what is left of the time limit after some time.
    #[must_use]
    pub fn after(&self, elapsed: Duration) -> Self {
        let time_limit = self.time_limit.map(|limit| limit.saturating_sub(elapsed).max(Duration::from_nanos(1)));
        Self { time_limit, ..self.clone() }
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub fn validate(&self) -> Result<(), InvalidSetting> {
        let invalid = |field, message| Err(InvalidSetting { field, message });
        for (field, value) in [("tolerance", self.tolerance), ("constraint_tolerance", self.constraint_tolerance)] {
            if !(1e-12..=0.1).contains(&value) {
                return invalid(field, format!("{value} is not between 1e-12 and 0.1"));
            }
        }
        if self.max_iterations == 0 {
            return invalid("max_iterations", "0 leaves nothing to do; it must be at least 1".into());
        }
        if self.time_limit == Some(Duration::ZERO) {
            return invalid("time_limit", "it must be greater than zero; leave it out for no limit".into());
        }
        if self.samples == 0 {
            return invalid("samples", "it must be at least 1".into());
        }
        if !(self.between_tolerance > 0.0 && self.between_tolerance.is_finite()) {
            return invalid("between_tolerance", format!("{} is not positive and finite", self.between_tolerance));
        }
        if let Some(refinement) = &self.refine {
            refinement.validate()?;
        }
        match self.scales.iter().find(|(_, size)| !(size.is_finite() && *size > 0.0)) {
            Some((name, size)) => {
                invalid("scales", format!("the typical size of `{name}` is {size}; it must be positive and finite"))
            }
            None => Ok(()),
        }
    }
}

/// What becomes of a solution that violates constraints between the points of the transcription.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// It is a solution, and [`Report::warnings`](crate::report::Report::warnings) names the constraints.
    #[default]
    Report,
    /// It is no solution: the status is [`Status::ViolatedBetween`](crate::status::Status).
    Refuse,
    /// The mesh is refined until cost and constraints are exact to the tolerance, as [`Settings::refine`] does.
    Refine,
}

/// How far meshes are refined (docs/maths.md, section 14).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// The relative error of the cost, and the relative violation between points, that are wanted;
    /// between 1e-12 and 0.1.
    pub tolerance: f64,
    /// Rounds at most, the first solve included. Default 12.
    pub rounds: usize,
    /// A round that would have more variables is not begun. Default 20 000.
    pub variables: usize,
}

impl Refinement {
    /// As far as a tolerance asks, with the usual limits.
    pub fn to(tolerance: f64) -> Self {
        Self { tolerance, rounds: 12, variables: 20_000 }
    }

    /// Checks the tolerance and the limits.
    pub(crate) fn validate(&self) -> Result<(), InvalidSetting> {
        let invalid = |message| Err(InvalidSetting { field: "refine", message });
        if !(1e-12..=0.1).contains(&self.tolerance) {
            return invalid(format!("the tolerance {} is not between 1e-12 and 0.1", self.tolerance));
        }
        if self.rounds == 0 {
            return invalid("0 rounds leave nothing to do; it must be at least 1".into());
        }
        Ok(())
    }
}
