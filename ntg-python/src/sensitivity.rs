//! Derivatives of a solution by parameters, and what it is predicted to be nearby.

use std::sync::{Arc, PoisonError};

use ntg_interp::Interpreted;
use ntg_runtime::report::Report;
use ntg_runtime::sensitivity::{Differentiator, Sensitivity, SensitivityError};
use ntg_runtime::solution::Solution;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::curves::{self, CurveData};
use crate::errors;
use crate::problem::{Spec, assign};

/// Derivatives of one solution.
#[pyclass(frozen, module = "ntg._ntg")]
pub(crate) struct Derivatives {
    spec: Arc<Spec>,
    problem: Arc<Interpreted>,
    sensitivity: Sensitivity,
}

/// What a solution is predicted to be.
#[pyclass(frozen, module = "ntg._ntg")]
pub(crate) struct Predicted {
    problem: Interpreted,
    solution: Solution,
}

impl Derivatives {
    /// By the parameters of these names, or by all.
    pub(crate) fn new(
        py: Python<'_>,
        (spec, problem): (&Arc<Spec>, &Arc<Interpreted>),
        report: &Report,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let found = py.detach(|| {
            if !report.has_solution() {
                return report.sensitivity(&**problem);
            }
            // Another thread that differentiates meanwhile makes what is kept for itself.
            let lock = || spec.differentiator.lock().unwrap_or_else(PoisonError::into_inner);
            let kept = lock().take();
            let mut differentiator = kept.unwrap_or_else(|| Differentiator::new(&**problem));
            let found = match &names {
                Some(names) => {
                    let names: Vec<&str> = names.iter().map(String::as_str).collect();
                    differentiator.differentiate_by(&report.solution, &names)
                }
                None => differentiator.differentiate(&report.solution),
            };
            *lock() = Some(differentiator);
            found
        });
        let sensitivity = found.map_err(|error| raised(py, &error))?;
        Ok(Self { spec: spec.clone(), problem: problem.clone(), sensitivity })
    }
}

fn raised(py: Python<'_>, error: &SensitivityError) -> PyErr {
    let class = match error {
        SensitivityError::UnknownParameter(..) => "ParameterError",
        _ => "SensitivityError",
    };
    errors::plain(py, class, &error.to_string())
}

#[pymethods]
impl Derivatives {
    /// Name, present value and unit of every parameter.
    #[getter]
    fn parameters(&self) -> Vec<(String, f64, String)> {
        let parameters = self.sensitivity.parameters().iter();
        parameters.map(|p| (p.name.clone(), p.value, p.unit.symbol.clone())).collect()
    }

    #[getter]
    fn is_strict(&self) -> bool {
        self.sensitivity.is_strict()
    }

    /// Name, first point and number of points of every weakly active constraint.
    #[getter]
    fn weak(&self) -> Vec<(String, String, usize)> {
        self.sensitivity.weak().iter().map(|weak| (weak.name.clone(), weak.point.clone(), weak.points)).collect()
    }

    /// Derivatives of a number: its unit, and one number a parameter.
    fn of<'py>(&self, py: Python<'py>, name: &str) -> Option<(String, Bound<'py, PyArray1<f64>>)> {
        let gradient = self.sensitivity.of(name)?;
        Some((gradient.unit.symbol, PyArray1::from_vec(py, gradient.values)))
    }

    /// Derivatives of a function of time: one row a time, one column a parameter.
    fn at<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        times: PyReadonlyArray1<'py, f64>,
        order: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let times = times.as_slice()?;
        let rows: Option<Vec<Vec<f64>>> = py.detach(|| {
            let at = |t: &f64| self.sensitivity.derivative_at(name, *t, order).map(|gradient| gradient.values);
            times.iter().map(at).collect()
        });
        let rows = rows.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// The solution for other values of the parameters, to first order.
    fn predict(&self, py: Python<'_>, parameters: &Bound<'_, PyDict>) -> PyResult<Predicted> {
        let mut problem = (*self.problem).clone();
        assign(&mut problem, parameters)?;
        let predicted = self.sensitivity.predict(&problem);
        let solution = predicted.map_err(|error| match &error {
            SensitivityError::Setup(setup) => {
                errors::of(py, &ntg_runtime::Error::Setup(setup.clone()), &self.spec.source)
            }
            other => raised(py, other),
        })?;
        Ok(Predicted { problem, solution })
    }
}

#[pymethods]
impl Predicted {
    /// The function of time of any name.
    fn curve(&self, name: &str) -> Option<CurveData> {
        curves::curve(&self.solution, &self.problem, name)
    }

    /// A time in seconds, or a variable or a named number in its unit.
    fn number(&self, name: &str) -> Option<f64> {
        let signal = || {
            let signal = self.solution.signal(&self.problem, name).filter(|signal| signal.is_constant())?;
            Some(signal.at(0.0))
        };
        self.solution.time(name).or_else(|| self.solution.variable(name)).or_else(signal)
    }

    /// Values of a function of time, as those of `Found`.
    fn values<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        times: PyReadonlyArray1<'py, f64>,
        order: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        curves::values(py, (&self.solution, &self.problem), name, times.as_slice()?, order)
    }
}
