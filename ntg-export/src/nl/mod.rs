//! AMPL's .nl files, and the .sol files that solvers answer with.
//!
//! The format wants an order: variables that are nonlinear in rows and objective, in rows only, in the objective only, then
//! the others; nonlinear rows before linear ones. [`Order`] says which of ntg's variables and rows stand where; the name files
//! have the same order, so that a solver's answer can be read by names.

mod order;
mod sol;
mod write;

pub use order::Order;
pub use sol::{Solution, SolutionError};
pub use write::{Files, write};
