//! A solver for nonlinear programs made of element functions.
//!
//! ```text
//! minimise    f(x) = sum over elements and rows with target Objective of  weight * phi(u_e)
//! subject to  row_lower <= c(x) <= row_upper,  c_i = the same sum over rows with target Row(i)
//!             lower <= x <= upper
//! where       u_e = E_e x[variables_e] + offset_e
//! ```
//!
//! Such programs are *partially separable* (A. Griewank and Ph. L. Toint, 1982): every element function
//! `phi` depends on a few *internal variables* `u`, which a linear *range transformation* `E` makes of the
//! program's variables. Discretised optimal control problems, finite elements and sums of squares have this form.
//! A program hands over derivatives by internal variables, where they are small and dense; the
//! solver condenses them element by element into a matrix whose factors cost what the coupling asks for.
//!
//! [`Nlp`] is the contract. [`closures::Program`] implements it for functions written as closures:
//!
//! ```
//! use ntg_nlp::closures::Program;
//! use ntg_nlp::{Options, solve};
//!
//! // Problem 35 of Hock and Schittkowski: a convex quadratic over a simplex.
//! let bounds = [(0.0, f64::INFINITY); 3];
//! let constraints = [(f64::NEG_INFINITY, 3.0)];
//! let program = Program::dense(&bounds, &constraints, |x, out| {
//!     let [a, b, c] = [x[0], x[1], x[2]];
//!     // Function 0 is the objective, function 1 the first constraint.
//!     let squares = 2.0 * a * a + 2.0 * b * b + c * c + 2.0 * a * b + 2.0 * a * c;
//!     out.set_value(0, 9.0 - 8.0 * a - 6.0 * b - 4.0 * c + squares);
//!     out.set_gradient(0, &[4.0 * a + 2.0 * b + 2.0 * c - 8.0, 2.0 * a + 4.0 * b - 6.0, 2.0 * a + 2.0 * c - 4.0]);
//!     out.set_hessian(0, &[4.0, 2.0, 2.0, 2.0, 4.0, 0.0, 2.0, 0.0, 2.0]);
//!     out.set_value(1, a + b + 2.0 * c);
//!     out.set_gradient(1, &[1.0, 1.0, 2.0]);
//! });
//! let outcome = solve(&program, &[0.5; 3], &Options::default());
//! assert!(outcome.status.is_solved());
//! assert!((outcome.objective - 1.0 / 9.0).abs() < 1e-7);
//! // What another unit of the constraint's bound would change: 2/9 less for each.
//! assert!((outcome.row_multipliers[0] + 2.0 / 9.0).abs() < 1e-6);
//! ```
//!
//! Two methods end by the same test of optimality ([`residuals`]): [`ipm`], a primal-dual interior-point method with
//! exact second derivatives, and `sqp`, sequential quadratic programming on Clarabel (feature `sqp`). [`solve`]
//! chooses. The mathematics is in docs/maths.md, sections 5, 6 and 11.
//!
//! The crate knows variables, rows, blocks and elements by their indices. Names are the caller's.

mod check;
pub mod closures;
pub mod contract;
mod erased;
pub mod ipm;
mod kkt;
pub mod method;
pub mod options;
pub mod outcome;
mod posed;
mod reductions;
mod remeasure;
pub mod residuals;
pub mod scaling;
pub mod sensitivity;
mod sizes;
pub mod sparse;
#[cfg(feature = "sqp")]
pub mod sqp;
pub mod status;
mod stopping;

pub use contract::{Block, BlockValues, Definition, Entry, Evaluation, Limits, Nlp, NotFinite, Shrinking, Target};
pub use method::{solve, solve_from};
pub use options::{Control, InertiaCorrection, Method, OnIteration, Options, Progress, Scaling, Violations};
pub use outcome::{IterationRecord, Multipliers, Outcome, Start};
pub use remeasure::is_solution_by;
pub use scaling::Scales;
pub use sizes::multiples;
pub use sparse::{Assembly, Csc, Pattern};
pub use status::Status;
