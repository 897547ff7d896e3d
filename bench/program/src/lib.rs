//! ntg's own nonlinear programs, as other solvers want them.
//!
//! ```text
//! spec, mesh, start  ->  Transcription  ->  Program: bounds, start, f, g, gradient, Jacobian, Hessian, sparse
//! ```
//!
//! [`program`] is the one file that knows how ntg assembles a program from its elements; whatever compares solvers
//! on the same program stands on it. [`adapted`] gives problems other meshes and splits a continuation into steps.

pub mod adapted;
pub mod program;
pub mod specs;

pub use program::{Bounds, Pattern, Program, RowSizes};
