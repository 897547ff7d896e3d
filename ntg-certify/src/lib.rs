//! Proofs.
pub mod elementary;
pub mod interval;
pub mod jet;
pub mod spline;
