//! What a solve leaves behind: saved runs, plots and reports.
//!
//! ```text
//! (source, problem, report) -> Run -> Figure -> SVG -> PNG
//!                               |
//!                               +---> one HTML page
//! ```
//!
//! A [`Run`] is plain data that is written to a file and read back (docs/solution-format.md), so
//! that plots and reports of a saved run need neither spec nor solver.
//! The crate does no input or output.

pub mod draw;
pub mod figure;
pub mod html;
pub mod png;
pub mod run;
mod scene;

pub use run::Run;
