//! ntg's nonlinear programs as files that other solvers read.
//!
//! ```text
//! Program (formulas) + Transcription (points, slots, weights, bounds) -> Expressions -> .nl, .row, .col
//! solver's .sol -> point and multipliers -> judge: objective, violations by name, residuals
//! ```
//!
//! [`Expressions`] is the transcribed program as one graph of expressions of the variables, with linear parts as numbers;
//! [`nl`] writes it as AMPL's .nl format (D. M. Gay, *Writing .nl Files*, Sandia 2005). The program in the file is the one
//! that `ntg solve` solves: same variables, rows, bounds and start, in SI units, before any scaling.
//! [`judge`] measures how far any point is from a solution, without a solver.

mod error;
mod expressions;
mod graph;
pub mod judge;
mod kernel;
pub mod nl;
mod table;
mod value;

pub use error::ExportError;
pub use expressions::Expressions;
