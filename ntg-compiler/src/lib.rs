//! (see Cargo.toml)
pub mod diagnostic;
pub mod expr;
pub mod source;
pub mod syntax;
