//! The condensed linear system of the interior-point method (docs/maths.md, sections 11.2 and 11.3).
//!
//! ```text
//! A dx = -grad L + J^T q,   A = H + J^T Sigma J
//! ```
//!
//! [`system`] holds the scaled program, the matrix `A` and its factors. `supports` finds which slots depend on the same
//! variables, `chains` what pairs connect, `unknowns` which rows are not condensed, `elements` condenses the others into
//! second derivatives element by element, `ordering` says in which order unknowns are eliminated, `storage` where the entries of that matrix and of its
//! factors are stored, `factor` factorises it with the products of `panel`, `substitution` solves for one right-hand side and
//! `columns` for several at a time.

mod chains;
mod columns;
mod elements;
mod factor;
mod ordering;
mod pack;
mod panel;
mod pattern;
mod storage;
mod substitution;
mod supports;
pub(crate) mod system;
mod unknowns;

pub(crate) use columns::{COLUMNS, Columns};
pub(crate) use elements::{Curvature, Held, Part, Refinement, Weights};
pub(crate) use system::System;
