//! Functions of time of a solution, by name.

use ntg_interp::Interpreted;
use ntg_report::run::{NamedArray, arrays};
use ntg_runtime::solution::Solution;
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use crate::errors;

/// Name, unit, documentation, start and end in seconds of a function of time; of a vector or matrix also how many elements it
/// has by each index, and their names.
pub(crate) type CurveData = (String, String, String, f64, f64, Vec<usize>, Vec<String>);

/// Elements put together to vectors and matrices.
pub(crate) fn gathered(curves: Vec<CurveData>) -> Vec<CurveData> {
    let names: Vec<&str> = curves.iter().map(|curve| &curve.0[..]).collect();
    let array = |array: NamedArray| {
        let elements = &curves[array.elements];
        let (_, unit, doc, start, end, ..) = elements.first()?.clone();
        let names = match array.shape.is_empty() {
            true => vec![],
            false => elements.iter().map(|element| element.0.clone()).collect(),
        };
        Some((array.name, unit, doc, start, end, array.shape, names))
    };
    arrays(&names).into_iter().filter_map(array).collect()
}

/// The flat outputs, element by element.
pub(crate) fn outputs(solution: &Solution) -> Vec<CurveData> {
    let structure = solution.structure();
    let doc = |name: &str| {
        let last = name.rsplit('.').next().unwrap_or(name);
        let base = last.split('[').next().unwrap_or(last);
        let mut outputs = structure.phases.iter().flat_map(|phase| &phase.outputs);
        outputs.find(|output| output.name == base).map(|output| output.doc.clone()).unwrap_or_default()
    };
    let trajectories = solution.trajectories().into_iter();
    let data = trajectories.map(|t| {
        let (name, unit) = (t.name().to_owned(), t.unit().symbol.clone());
        (name, unit, doc(t.name()), t.start(), t.end(), vec![], vec![])
    });
    data.collect()
}

/// The named expressions that are functions of time, element by element.
pub(crate) fn signals(solution: &Solution, problem: &Interpreted) -> Vec<CurveData> {
    let data = solution.signals(problem).into_iter().filter_map(|signal| {
        let (start, end) = signal.span()?;
        let (name, unit) = (signal.name().to_owned(), signal.unit().symbol.clone());
        Some((name, unit, signal.doc().to_owned(), start, end, vec![], vec![]))
    });
    data.collect()
}

/// The function of time of any name, that of a vector too, also in one phase alone.
pub(crate) fn curve(solution: &Solution, problem: &Interpreted, name: &str) -> Option<CurveData> {
    if let Some(output) = solution.output(name) {
        let doc = outputs(solution).into_iter().find(|known| known.0 == name).map(|known| known.2);
        let (unit, doc) = (output.unit().symbol.clone(), doc.unwrap_or_default());
        return Some((name.to_owned(), unit, doc, output.start(), output.end(), vec![], vec![]));
    }
    if let Some(signal) = solution.signal(problem, name) {
        let (start, end) = signal.span()?;
        let (unit, doc) = (signal.unit().symbol.clone(), signal.doc().to_owned());
        return Some((name.to_owned(), unit, doc, start, end, vec![], vec![]));
    }
    let arrays = || gathered(outputs(solution)).into_iter().chain(gathered(signals(solution, problem)));
    arrays().find(|curve| curve.0 == name)
}

/// Values of an output or named expression at mission times in seconds; of an output also a derivative with respect to
/// time.
pub(crate) fn values<'py>(
    py: Python<'py>,
    (solution, problem): (&Solution, &Interpreted),
    name: &str,
    times: &[f64],
    order: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let values: Option<Vec<f64>> = match (solution.output(name), order) {
        (Some(output), _) => Some(times.iter().map(|t| output.derivative(*t, order)).collect()),
        (None, 0) => solution.signal(problem, name).map(|signal| signal.values(times)),
        (None, _) => {
            let words = format!("`{name}` is no output: only outputs have derivatives; name it by a `let` of the spec");
            return Err(errors::plain(py, "Error", &words));
        }
    };
    let values = values.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
    Ok(values.into_pyarray(py))
}
