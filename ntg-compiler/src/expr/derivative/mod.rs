//! Exact derivatives of expressions, as expressions of the same graph.
//!
//! `gradient` is the reverse mode, `forward` the chain rule for a direction (or for
//! time), `hessian` the second derivatives of a weighted sum. What one operation
//! contributes is in `rules.rs` alone; the modes only decide in which order the
//! contributions are joined. Derivatives are written in terms of the value nodes
//! (`exp' = exp`, `hypot' = x / hypot`), so evaluating them together shares the work.
//!
//! Equations: docs/maths.md, section 2.

mod forward;
mod hessian;
mod local;
mod mask;
mod pushing;
mod reverse;
mod rules;

use std::fmt;

use super::node::NodeId;

pub use forward::{Again, Rates, SecondIndex, forward, forward_from};
pub use hessian::{Entry, hessian};
pub use reverse::gradient;

/// Why an expression has no derivative here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DerivativeError {
    /// The reverse mode and Hessians stop at a reduction that depends on the variables;
    /// its members have to be differentiated one by one.
    Reduction(NodeId),
}

impl fmt::Display for DerivativeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reduction(_) => write!(f, "a reduction over an index cannot be differentiated in reverse"),
        }
    }
}

impl std::error::Error for DerivativeError {}
