//! Exceptions: those of `ntg._errors`, with the compiler's findings.

use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::source::Source;
use ntg_runtime::Error;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// An exception of the package by the name of its class; whatever goes wrong on the way is raised instead.
pub(crate) fn raise(py: Python<'_>, class: &str, message: &str, findings: Vec<Bound<'_, PyDict>>) -> PyErr {
    let made = || {
        let class = py.import("ntg._errors")?.getattr(class)?;
        class.call1((message, PyList::new(py, findings)?))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// An exception without findings.
pub(crate) fn plain(py: Python<'_>, class: &str, message: &str) -> PyErr {
    raise(py, class, message, vec![])
}

/// A finding as plain data.
pub(crate) fn finding<'py>(py: Python<'py>, found: &Diagnostic, source: &Source) -> PyResult<Bound<'py, PyDict>> {
    let severity = match found.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let (start, end) = (source.place(found.span.start), source.place(found.span.end));
    let data = PyDict::new(py);
    data.set_item("code", found.code.text())?;
    data.set_item("severity", severity)?;
    data.set_item("message", &found.message)?;
    data.set_item("help", found.help.as_deref().unwrap_or_default())?;
    data.set_item("line", start.line)?;
    data.set_item("column", start.column)?;
    data.set_item("end_line", end.line)?;
    data.set_item("end_column", end.column)?;
    data.set_item("rendered", found.render(source))?;
    Ok(data)
}

/// All findings as plain data.
pub(crate) fn findings<'a, 'py>(
    py: Python<'py>,
    found: impl Iterator<Item = &'a Diagnostic>,
    source: &Source,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    found.map(|one| finding(py, one, source)).collect()
}

/// The exception for a problem that cannot be set up, or a setting out of its range.
pub(crate) fn of(py: Python<'_>, error: &Error, source: &Source) -> PyErr {
    let Error::Setup(setup) = error else { return plain(py, "SettingsError", &error.to_string()) };
    match ntg_interp::finding(setup, source) {
        Some(found) => match finding(py, &found, source) {
            Ok(data) => raise(py, "SetupError", &found.render(source), vec![data]),
            Err(error) => error,
        },
        None => plain(py, "SetupError", &error.to_string()),
    }
}
