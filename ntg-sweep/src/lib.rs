//! Parameter studies: many solves of one problem, a row each.
//!
//! ```text
//! ranges, CSV, Parquet -> Study --solves on all cores--> Journal -> Table -> CSV, Parquet
//! ```
//!
//! A study survives its process: every finished row goes to an append-only [`journal`] before it
//! counts, so that an interrupted study goes on where it was, without losing or repeating a row.
//! A row that fails, in whatever way, is a row that says so.

mod csv;
pub mod journal;
#[cfg(feature = "parquet")]
mod parquet;
mod range;
mod run;
mod study;
mod table;
mod value;

pub use range::{Range, grid};
pub use run::{Ended, Watcher, run};
pub use study::{Row, Study};
pub use table::{Format, Table, read, write};
pub use value::Value;
