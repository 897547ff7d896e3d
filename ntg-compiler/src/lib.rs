//! The ntg compiler: from the text of a spec to kernels with exact derivatives, and to Rust.
//!
//! It reads no files and no clock: a spec comes in as a [`Source`], tables through a [`Loader`].
//! Each stage is a folder, takes what the one before it gives, and knows nothing of those after it:
//!
//! ```text
//! Source --syntax--> ast::Spec --model--> Problem --program--> Program --codegen--> Rust
//! ```
//!
//! `expr` is the algebra that `model` and `program` share.

pub mod codegen;
pub mod diagnostic;
pub mod expr;
pub mod model;
pub mod program;
pub mod source;
pub mod standard;
pub mod syntax;

use diagnostic::{Diagnostic, Diagnostics, Severity};
use model::{Given, Loader};
use program::Program;
use source::Source;

/// A spec that has been compiled.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// What is computed.
    pub program: Program,
    /// What the user should know though nothing is wrong: gradients that may jump, fits of tables.
    pub notes: Vec<Diagnostic>,
}

/// Everything found in a library by itself; errors are among them where it cannot be used.
pub fn check_library(source: &Source, loader: &dyn Loader) -> Vec<Diagnostic> {
    model::check_library(source, loader)
}

/// Compiles a spec.
///
/// # Errors
/// Everything that is wrong with it, in source order.
pub fn compile(source: &Source, loader: &dyn Loader) -> Result<Compiled, Diagnostics> {
    compile_with(source, loader, &[])
}

/// As [`compile`], with other values of some constants.
///
/// # Errors
/// Everything that is wrong with the spec or with the values, in source order.
pub fn compile_with(source: &Source, loader: &dyn Loader, given: &[Given]) -> Result<Compiled, Diagnostics> {
    let (problem, notes) = meant(source, loader, given)?;
    Ok(Compiled { program: program::lower(problem, source), notes })
}

/// Everything that [`compile_with`] finds, without the derivatives, which take most of its time: the problem's name,
/// and what the user should know though nothing is wrong.
///
/// # Errors
/// As [`compile_with`].
pub fn check_with(
    source: &Source,
    loader: &dyn Loader,
    given: &[Given],
) -> Result<(String, Vec<Diagnostic>), Diagnostics> {
    meant(source, loader, given).map(|(problem, notes)| (problem.name, notes))
}

/// What a spec means, and the notes about it.
fn meant(
    source: &Source,
    loader: &dyn Loader,
    given: &[Given],
) -> Result<(model::problem::Problem, Vec<Diagnostic>), Diagnostics> {
    let spec = syntax::parse(source)?;
    let (problem, found) = model::build_with(&spec, source, loader, given);
    let (errors, notes) = found.into_iter().partition(|d: &Diagnostic| d.severity == Severity::Error);
    Diagnostics::or(errors)?;
    Ok((problem.expect("a problem is missing only where there are errors"), notes))
}
