//! Parameter studies: many solves of one problem, a row each.
//!
//! ```text
//! ranges, designs, CSV, Parquet -> Study --solves on all cores--> Journal -> Results -> CSV, Parquet
//! ```
//!
//! A study survives its process: every finished row goes to an append-only [`journal`] before it
//! counts, so that an interrupted study goes on where it was, without losing or repeating a row.
//! A study may be cut into shards, each with a journal of its own, which [`merge()`] puts together.
//! A row that fails, in whatever way, is a row that says so. What a row holds does not depend on the number of
//! cores, on shards or interruptions, see [`blocks()`]; the exceptions are `seconds`, and rows that end by a time limit.

mod blocks;
mod csv;
mod design;
mod hilbert;
pub mod journal;
mod merge;
#[cfg(feature = "parquet")]
mod parquet;
mod quantile;
mod range;
mod rows;
mod run;
mod shard;
mod sobol;
mod study;
mod summary;
mod table;
mod value;

pub use blocks::{Block, blocks, usual_block};
pub use design::{Design, Distribution};
pub use merge::merge;
pub use range::{Range, grid};
pub use rows::{Rows, Set};
pub use run::{Ended, Plan, Solve, Watcher, run, solve_all};
pub use shard::Shard;
pub use study::{Results, Row, SOLVED, Study};
pub use summary::{Spread, Summary};
pub use table::{Column, Format, Named, Table, bytes, columns, read, write};
pub use value::Wanted;
