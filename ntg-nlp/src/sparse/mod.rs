//! The derivatives of a whole program as sparse matrices.

mod assembly;
mod csc;
mod pattern;

pub use assembly::Assembly;
pub use csc::Csc;
pub use pattern::Pattern;
