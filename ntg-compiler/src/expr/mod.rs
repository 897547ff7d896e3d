//! Pure algebra: expressions, their exact derivatives, their structure and their meaning.
//!
//! This folder imports nothing of ours but the functions of numbers (`ntg-math`), knows no language and no target: a leaf is an
//! [`InputId`], and what it stands for is the client's affair.
//! The mathematics is docs/maths.md, section 2.

pub mod derivative;
pub mod eval;
pub mod structure;

mod dag;
mod hash;
mod node;
mod rewrite;
mod scalar;
mod simplify;
mod strength;

#[cfg(test)]
mod tests;

pub use dag::Dag;
pub use derivative::{Again, DerivativeError, Entry, Rates, SecondIndex, forward, forward_from, gradient, hessian};
pub use eval::{Environment, EvalError, eval, eval_from, eval_in};
pub use hash::{Map, Set};
pub use node::{Binary, Fold, InputId, Node, NodeId, Number, Unary};
pub use scalar::Scalar;
pub use structure::{Degree, degree, hessian_pattern, kinks, singular_operations};
