//! The runtime of ntg: what a compiled problem needs in order to be solved.

pub mod lanes;
pub mod math;
pub mod nlp;
pub mod problem;
pub mod settings;
pub mod sqp;
pub mod status;
pub mod transcribe;

pub use ntg_splines as splines;
pub use ntg_structure as structure;
