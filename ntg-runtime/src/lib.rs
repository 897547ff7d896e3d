//! The runtime of ntg: what a compiled problem needs in order to be solved.
//!
//! ```text
//! Problem -> transcribe -> Nlp -> strategy over ntg_nlp -> Solution, Report
//! ```
//!
//! [`problem::Problem`] is the contract with every back end, [`nlp::Nlp`] the one with the solver, the crate `ntg-nlp`:
//! a structured interior-point method, and sequential quadratic programming where it fails. [`solve()`] goes the whole
//! way. The mathematics is in docs/maths.md, sections 3 to 9 and 11 to 14.

pub mod digits;
mod error;
pub mod explain;
pub mod guess;
pub mod lanes;
pub mod math;
pub mod multistart;
pub mod problem;
pub mod refine;
pub mod report;
pub mod sensitivity;
pub mod settings;
pub mod solution;
mod solve;
mod solver;
pub mod status;
mod strategy;
pub mod transcribe;

pub use error::Error;
pub use ntg_nlp as nlp;
pub use ntg_splines as splines;
pub use ntg_structure as structure;
pub use solve::{solve, solve_from};
pub use solver::Solver;
pub use strategy::Tracked;

/// What a program that solves problems names.
pub mod prelude {
    pub use crate::guess::Guess;
    pub use crate::multistart::{Minima, MultiReport, StartKind, Starts};
    pub use crate::problem::Problem;
    pub use crate::report::Report;
    pub use crate::settings::{Control, Method, Progress, Settings};
    pub use crate::solution::{Family, Signal, Solution, Trajectory};
    pub use crate::status::Status;
    pub use crate::{Error, Solver, Tracked, solve, solve_from};
}
