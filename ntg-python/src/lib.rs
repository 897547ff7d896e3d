//! The extension module `ntg._ntg`: what the Python package `ntg` is made of.
//!
//! One file a class. Values go in and out as plain Python objects and NumPy arrays; names, units and errors are those
//! of the spec. Everything a person sees (documentation, types, tables, plots) is in `python/ntg/`.

mod curves;
mod errors;
mod found;
mod problem;
mod sensitivity;
mod settings;
mod solver;
mod study;
mod watch;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command `ntg` with the words of a command line, its own name first; gives its exit status.
#[pyfunction]
fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| ntg_cli::run(words))
}

/// The module `ntg._ntg`.
#[pymodule]
mod _ntg {
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::found::Found;
    #[pymodule_export]
    use super::problem::{Compiled, compile, constants};
    #[pymodule_export]
    use super::sensitivity::{Derivatives, Predicted};
    #[pymodule_export]
    use super::solver::KeptSolver;
    #[pymodule_export]
    use super::study::{blocks, sweep};

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
