//! From text to what was written.

pub mod ast;
mod expression;
