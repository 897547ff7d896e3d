//! Pure algebra: expressions, their exact derivatives, their structure and their meaning.
//!
//! This folder imports nothing of ours, knows no language and no target: a leaf is an
//! [`InputId`], and what it stands for is the client's affair.
//! The mathematics is docs/maths.md, section 2.

mod dag;
mod node;
mod rewrite;
mod scalar;
mod simplify;

pub use dag::Dag;
pub use node::{Binary, Fold, InputId, Node, NodeId, Number, Unary};
pub use scalar::Scalar;
