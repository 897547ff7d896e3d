//! What a solve found.

use std::collections::BTreeMap;
use std::sync::Arc;

use ntg_interp::Interpreted;
use ntg_report::html::{self, Page};
use ntg_report::run::Recording;
use ntg_runtime::report::{ConstraintReport, Report, Worst};
use ntg_runtime::settings::{Progress, Settings};
use ntg_runtime::status::Status;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::curves::{self, CurveData};
use crate::errors;
use crate::problem::{Compiled, Spec};
use crate::sensitivity::Derivatives;
use crate::watch::Watch;

/// A report with its problem.
#[pyclass(frozen, module = "ntg._ntg")]
pub(crate) struct Found {
    spec: Arc<Spec>,
    pub(crate) problem: Arc<Interpreted>,
    pub(crate) report: Report,
    iterations: Vec<Progress>,
}

/// Name, value and unit.
type NumberData = (String, f64, String);

impl Found {
    pub(crate) fn new(spec: Arc<Spec>, problem: Arc<Interpreted>, report: Report, iterations: Vec<Progress>) -> Self {
        Self { spec, problem, report, iterations }
    }

    fn record<T>(&self, py: Python<'_>, make: impl FnOnce(&ntg_report::Run) -> T + Send) -> PyResult<T>
    where
        T: Send,
    {
        let mut settings = Settings::default();
        let watch = Watch::new(None);
        watch.over(&mut settings);
        let made = py.detach(|| {
            let explanation = self.report.explain(&*self.problem, &settings).ok().flatten();
            let recording = Recording {
                problem: &*self.problem,
                report: &self.report,
                explanation: explanation.as_ref(),
                starts: None,
                source: &self.spec.source,
                notes: &self.spec.notes,
                iterations: &self.iterations,
            };
            make(&recording.run())
        });
        watch.end()?;
        Ok(made)
    }
}

/// The status as one word: the name of the runtime's variant, `IterationLimit` as `iteration_limit`.
fn word(status: &Status) -> String {
    let shown = format!("{status:?}");
    let name = shown.split(|letter: char| !letter.is_alphanumeric()).next().unwrap_or_default();
    let mut word = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !word.is_empty() {
            word.push('_');
        }
        word.extend(letter.to_lowercase());
    }
    word
}

#[pymethods]
impl Found {
    #[getter]
    fn status(&self) -> String {
        word(&self.report.status)
    }

    #[getter]
    fn message(&self) -> String {
        self.report.status.to_string()
    }

    #[getter]
    fn advice(&self) -> &str {
        &self.report.advice
    }

    #[getter]
    fn resolution(&self) -> Option<&'static str> {
        Some(self.report.resolution()?.word())
    }

    #[getter]
    fn is_solved(&self) -> bool {
        self.report.is_solved()
    }

    #[getter]
    fn objective(&self) -> f64 {
        self.report.objective
    }

    #[getter]
    fn objective_fine(&self) -> f64 {
        self.report.objective_fine
    }

    #[getter]
    fn objective_correction(&self) -> f64 {
        self.report.objective_correction
    }

    #[getter]
    fn objective_unit(&self) -> &str {
        &self.report.objective_unit.symbol
    }

    #[getter]
    fn violation(&self) -> (f64, f64) {
        (self.report.violation.points, self.report.violation.between)
    }

    #[getter]
    fn iterations(&self) -> usize {
        self.report.iterations
    }

    #[getter]
    fn seconds(&self) -> f64 {
        self.report.seconds
    }

    /// Name, unit and SI units in one unit of the independent variable.
    #[getter]
    fn independent(&self) -> (String, String, f64) {
        let independent = &self.report.solution.structure().independent;
        (independent.name.clone(), independent.unit.symbol.clone(), independent.unit.factor)
    }

    #[getter]
    fn span(&self) -> (f64, f64) {
        (self.report.solution.start(), self.report.solution.end())
    }

    /// Name, value in its unit and unit of every term of the objective.
    #[getter]
    fn terms(&self) -> Vec<NumberData> {
        self.report.terms.iter().map(|term| (term.name.clone(), term.value, term.unit.symbol.clone())).collect()
    }

    /// Iteration, objective, violation, stationarity, step and seconds of every iteration that was made.
    #[getter]
    fn history(&self) -> Vec<(usize, f64, f64, f64, f64, f64)> {
        let seen = self.iterations.iter();
        seen.map(|p| (p.iteration, p.objective, p.primal, p.dual, p.step, p.seconds)).collect()
    }

    /// The problem with the parameters that were solved.
    #[getter]
    fn problem(&self) -> Compiled {
        Compiled { spec: self.spec.clone(), problem: self.problem.clone() }
    }

    /// Durations and event times in seconds.
    #[getter]
    fn times(&self) -> Vec<(String, f64)> {
        self.report.solution.event_times()
    }

    /// Declared variables in their units.
    #[getter]
    fn variables(&self) -> Vec<NumberData> {
        let variables = self.report.solution.variables().into_iter();
        variables.map(|value| (value.name, value.value, value.unit.symbol)).collect()
    }

    /// Name, start and end of every phase.
    #[getter]
    fn phases(&self) -> Vec<(String, f64, f64)> {
        self.report.phases().into_iter().map(|phase| (phase.name, phase.start, phase.end)).collect()
    }

    /// The flat outputs, element by element, and as the vectors and matrices that they are.
    #[getter]
    fn outputs(&self) -> (Vec<CurveData>, Vec<CurveData>) {
        let elements = curves::outputs(&self.report.solution);
        (elements.clone(), curves::gathered(elements))
    }

    /// The named expressions that are functions of time, likewise, and those that are numbers.
    #[getter]
    fn expressions(&self) -> (Vec<CurveData>, Vec<CurveData>, Vec<NumberData>) {
        let elements = curves::signals(&self.report.solution, &self.problem);
        let signals = self.report.solution.signals(&*self.problem).into_iter();
        let numbers = signals.filter(|signal| signal.span().is_none());
        let numbers = numbers.map(|signal| (signal.name().to_owned(), signal.at(0.0), signal.unit().symbol.clone()));
        (elements.clone(), curves::gathered(elements), numbers.collect())
    }

    /// Which of these names are elements of vectors and matrices: the name, how many elements there are by each index, and
    /// where the first one stands among the names. A name that is of none has no index.
    #[staticmethod]
    #[expect(clippy::needless_pass_by_value, reason = "what Python gives is owned")]
    fn arrays(names: Vec<String>) -> Vec<(String, Vec<usize>, usize)> {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let found = ntg_report::run::arrays(&names).into_iter();
        found.map(|array| (array.name, array.shape, array.elements.start)).collect()
    }

    /// The function of time of any name, also in one phase alone: unit, documentation, start and end.
    fn curve(&self, name: &str) -> Option<CurveData> {
        curves::curve(&self.report.solution, &self.problem, name)
    }

    /// Values of an output or named expression at mission times in seconds; of an output also a derivative with
    /// respect to time.
    fn values<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        times: PyReadonlyArray1<'py, f64>,
        order: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        curves::values(py, (&self.report.solution, &self.problem), name, times.as_slice()?, order)
    }

    /// Derivatives by parameters: by those of these names, or by all.
    fn sensitivity(&self, py: Python<'_>, names: Option<Vec<String>>) -> PyResult<Derivatives> {
        Derivatives::new(py, (&self.spec, &self.problem), &self.report, names)
    }

    /// Everything about every constraint.
    #[getter]
    fn constraints<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.report.constraints.iter().map(|constraint| data(py, constraint)).collect()
    }

    /// The report in words.
    fn text(&self) -> String {
        self.report.to_string()
    }

    /// Why there is no solution, in words; empty for a solution.
    fn explain(&self, py: Python<'_>) -> PyResult<String> {
        let mut settings = Settings::default();
        let watch = Watch::new(None);
        watch.over(&mut settings);
        let explained = py.detach(|| self.report.explain(&*self.problem, &settings));
        watch.end()?;
        Ok(explained.ok().flatten().map_or_else(String::new, |explanation| explanation.to_string()))
    }

    /// What the measurements say, as JSON with the fields of the saved form; none where nothing was measured.
    #[getter]
    fn estimate(&self) -> Option<String> {
        self.report.estimate.as_ref().map(|found| ntg_report::run::Estimate::from(found).text())
    }

    /// The saved form: what `ntg solve --save` writes.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        self.record(py, ntg_report::Run::text)
    }

    /// The report as one HTML page that needs no network.
    fn html(&self, py: Python<'_>, tracks: Vec<(String, String)>) -> PyResult<String> {
        let name = self.report.problem.clone();
        let page = self.record(py, |run| html::page(&[(name, run)], &Page { tracks, ..Page::default() }))?;
        page.map_err(|message| errors::plain(py, "Error", &message))
    }
}

fn data<'py>(py: Python<'py>, constraint: &ConstraintReport) -> PyResult<Bound<'py, PyDict>> {
    let worst = |worst: &Option<Worst>| -> Option<BTreeMap<&'static str, Option<f64>>> {
        worst.as_ref().map(|worst| {
            let parts = [("violation", Some(worst.violation)), ("relative", Some(worst.relative))];
            parts.into_iter().chain([("value", Some(worst.value)), ("time", worst.time)]).collect()
        })
    };
    let data = PyDict::new(py);
    data.set_item("name", &constraint.name)?;
    data.set_item("text", &constraint.place.text)?;
    data.set_item("line", constraint.place.line)?;
    data.set_item("block", format!("{:?}", constraint.block).to_lowercase())?;
    data.set_item("unit", &constraint.unit.symbol)?;
    data.set_item("points", worst(&constraint.points))?;
    data.set_item("between", worst(&constraint.between))?;
    data.set_item("multiplier", constraint.multiplier.as_ref().map(|multiplier| multiplier.value))?;
    data.set_item("multiplier_time", constraint.multiplier.as_ref().and_then(|multiplier| multiplier.time))?;
    data.set_item("sensitivity", constraint.sensitivity)?;
    Ok(data)
}
