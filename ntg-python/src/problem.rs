//! A compiled spec with values of its parameters.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use ntg_compiler::diagnostic::Diagnostic;
use ntg_compiler::model::{self, Loader, loading};
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::guess::Guess;
use ntg_runtime::problem::Problem;
use ntg_runtime::sensitivity::Differentiator;
use ntg_runtime::solve_from;
use ntg_runtime::structure::Structure;
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString};

use crate::errors;
use crate::found::Found;
use crate::settings::Given;
use crate::solver::KeptSolver;
use crate::watch::Watch;

/// The text of a spec and what the compiler had to say.
pub(crate) struct Spec {
    pub(crate) source: Source,
    pub(crate) notes: Vec<Diagnostic>,
    /// The tables that it names, by path: with these it compiles anywhere.
    tables: BTreeMap<String, String>,
    /// The constants that were set, as text.
    constants: BTreeMap<String, String>,
    /// What derivatives of its solutions share; none while somebody differentiates.
    pub(crate) differentiator: Mutex<Option<Differentiator>>,
}

/// A compiled spec.
#[pyclass(frozen, module = "ntg._ntg")]
pub(crate) struct Compiled {
    pub(crate) spec: Arc<Spec>,
    pub(crate) problem: Arc<Interpreted>,
}

/// Finds tables in memory and then in a folder, and remembers them.
struct Tables {
    folder: Option<PathBuf>,
    found: Mutex<BTreeMap<String, String>>,
}

impl Loader for Tables {
    fn load(&self, path: &str) -> Result<String, String> {
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(text) = found.get(path) {
            return Ok(text.clone());
        }
        let Some(folder) = &self.folder else {
            return Err(format!("`{path}`: a spec given as text reads no files; give `folder` or `tables`"));
        };
        let place = folder.join(path);
        let about = std::fs::metadata(&place).map(|about| (about.is_file(), about.len()));
        let failed = |error: std::io::Error| format!("cannot read `{}`: {error}", place.display());
        let text = loading::text(about, || std::fs::read_to_string(&place), failed)?;
        found.insert(path.to_owned(), text.clone());
        Ok(text)
    }
}

/// Compiles a spec.
#[pyfunction]
pub(crate) fn compile(
    py: Python<'_>,
    name: String,
    text: String,
    folder: Option<PathBuf>,
    tables: BTreeMap<String, String>,
    constants: BTreeMap<String, String>,
) -> PyResult<Compiled> {
    let source = Source::new(name, text);
    let loader = Tables { folder, found: Mutex::new(tables) };
    let given =
        constants.iter().map(|(name, text)| model::Given { name: name.clone(), text: ntg_interp::bracketed(text) });
    let given: Vec<model::Given> = given.collect();
    match py.detach(|| ntg_compiler::compile_with(&source, &loader, &given)) {
        Ok(compiled) => {
            let problem = Arc::new(Interpreted::new(&compiled.program));
            let tables = loader.found.into_inner().unwrap_or_else(PoisonError::into_inner);
            Ok(Compiled {
                spec: Arc::new(Spec {
                    source,
                    notes: compiled.notes,
                    tables,
                    constants,
                    differentiator: Mutex::default(),
                }),
                problem,
            })
        }
        Err(found) => {
            let data = errors::findings(py, found.iter(), &source)?;
            Err(errors::raise(py, "SpecError", &found.render(&source), data))
        }
    }
}

/// The names of the constants of a spec that can be set where it is compiled.
#[pyfunction]
pub(crate) fn constants(text: String) -> Vec<String> {
    model::constants(&Source::new("spec", text))
}

/// The guess that a solution is. It may be one of another problem, but not one without any output of this problem.
pub(crate) fn start(py: Python<'_>, problem: &Interpreted, found: &Found) -> PyResult<Guess> {
    let (own, other) = (problem.structure(), found.problem.structure());
    let names = |structure: &Structure| -> Vec<String> {
        let outputs = structure.phases.iter().flat_map(|phase| &phase.outputs);
        outputs.map(|output| output.name.clone()).collect()
    };
    let known = names(&other);
    if !names(&own).iter().any(|name| known.contains(name)) {
        let words = format!("the guess is a solution of `{}`, which has no output of `{}`", other.name, own.name);
        return Err(errors::plain(py, "ParameterError", &words));
    }
    Ok(Guess::from(&found.report.solution))
}

/// Name, documentation, unit, values in that unit, and how many there are by each index.
type ParameterData = (String, String, String, Vec<f64>, Vec<usize>);

/// Sets parameters: numbers and sequences in declared units, or text with a unit.
pub(crate) fn assign(problem: &mut Interpreted, parameters: &Bound<'_, PyDict>) -> PyResult<()> {
    let py = parameters.py();
    for (name, value) in parameters {
        let Ok(name) = name.extract::<String>() else {
            let words = format!("the names of parameters are texts, not {}", kind(&name));
            return Err(PyTypeError::new_err(words));
        };
        set(problem, &name, &value)
            .map_err(|message| errors::plain(py, "ParameterError", &format!("parameter `{name}`: {message}")))?;
    }
    Ok(())
}

fn set(problem: &mut Interpreted, name: &str, value: &Bound<'_, PyAny>) -> Result<(), String> {
    if let Ok(text) = value.extract::<String>() {
        return problem.assign(name, &text);
    }
    let numbers = match number(value)? {
        Some(number) => vec![number],
        None => {
            let parts = elements(problem, name, value.extract().map_err(|_| wrong(value))?)?;
            let of = |(index, part): (usize, &Bound<'_, PyAny>)| {
                let found = number(part).and_then(|found| found.ok_or_else(|| wrong(part)));
                found.map_err(|words| format!("member {index}: {words}"))
            };
            if parts.iter().any(|part| part.extract::<String>().is_ok()) {
                let text = |(index, part): (usize, &Bound<'_, PyAny>)| match part.extract::<String>() {
                    Ok(text) => Ok(text),
                    Err(_) => of((index, part)).map(|number| number.to_string()),
                };
                let parts = (1..).zip(&parts).map(text).collect::<Result<Vec<_>, _>>()?;
                return members(problem, name, &parts);
            }
            (1..).zip(&parts).map(of).collect::<Result<_, _>>()?
        }
    };
    // Names that are none, counts and bounds are found by the same code as those of text.
    let text: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    if let Some(bad) = numbers.iter().find(|number| !number.is_finite()) {
        return Err(format!("{bad} is no finite number"));
    }
    // One number, the usual case, needs no parser.
    let place = ntg_interp::target(name).ok().and_then(|(base, indices)| problem.place(base, &indices).ok());
    match (place, &numbers[..]) {
        (Some(place), [number]) => problem.put(place, *number).map_err(|error| error.to_string()),
        _ => problem.assign(name, &text.join(", ")),
    }
}

/// The members of an array that is given whole: of a matrix those of its rows, one after the other.
fn elements<'py>(
    problem: &Interpreted,
    name: &str,
    parts: Vec<Bound<'py, PyAny>>,
) -> Result<Vec<Bound<'py, PyAny>>, String> {
    let shape = problem.structure().parameters.iter().find(|parameter| parameter.name == name).map(|p| p.shape());
    let row = |part: &Bound<'py, PyAny>| -> Option<Vec<Bound<'py, PyAny>>> {
        if part.is_instance_of::<PyString>() || part.is_instance_of::<PyBytes>() { None } else { part.extract().ok() }
    };
    let (Some([rows, columns]), Some(given)) =
        (shape.as_deref(), parts.iter().map(row).collect::<Option<Vec<_>>>().filter(|rows| !rows.is_empty()))
    else {
        return Ok(parts);
    };
    match given.len() == *rows && given.iter().all(|row| row.len() == *columns) {
        true => Ok(given.into_iter().flatten().collect()),
        false => Err(format!("it is a matrix of {rows} x {columns}, and other rows are given")),
    }
}

/// Members of an array as text, each with its own unit.
fn members(problem: &mut Interpreted, name: &str, parts: &[String]) -> Result<(), String> {
    let structure = problem.structure();
    let held = structure.parameters.iter().find(|parameter| parameter.name == name);
    let count = held.map_or(parts.len(), |parameter| parameter.value.len());
    if count != parts.len() {
        return Err(format!("it holds {count} values, but {} are given", parts.len()));
    }
    let element = |member: usize| held.map_or_else(|| format!("{name}[{}]", member + 1), |held| held.element(member));
    (0..).zip(parts).try_for_each(|(member, part)| problem.assign(&element(member), part))
}

/// A number; none for what is something else.
fn number(value: &Bound<'_, PyAny>) -> Result<Option<f64>, String> {
    if value.is_instance_of::<PyBytes>() {
        return Err(format!("{}; bytes are decoded first", wrong(value)));
    }
    match value.extract::<f64>() {
        Ok(number) => Ok(Some(number)),
        Err(error) if error.is_instance_of::<PyOverflowError>(value.py()) => Err("the number is too large".to_owned()),
        Err(_) => Ok(None),
    }
}

/// What a value is, in one word.
fn kind(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "this".to_owned(), |name| name.to_string())
}

fn wrong(value: &Bound<'_, PyAny>) -> String {
    format!("{} is neither a number, a text such as \"240 m/s\", nor a sequence of them", kind(value))
}

#[pymethods]
impl Compiled {
    #[getter]
    fn name(&self) -> String {
        self.problem.structure().name
    }

    #[getter]
    fn doc(&self) -> String {
        self.problem.structure().doc
    }

    #[getter]
    fn source(&self) -> (String, String) {
        (self.spec.source.name.clone(), self.spec.source.text.clone())
    }

    #[getter]
    fn tables(&self) -> BTreeMap<String, String> {
        self.spec.tables.clone()
    }

    #[getter]
    fn constants(&self) -> BTreeMap<String, String> {
        self.spec.constants.clone()
    }

    #[getter]
    fn objective_unit(&self) -> String {
        self.problem.structure().objective_unit.symbol
    }

    /// Warnings and notes of the compiler.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        errors::findings(py, self.spec.notes.iter(), &self.spec.source)
    }

    /// What every parameter is.
    #[getter]
    fn parameters(&self) -> Vec<ParameterData> {
        let parameters = self.problem.structure().parameters;
        let plain = parameters.into_iter().map(|p| {
            let (values, shape) = (p.value.iter().map(|value| p.unit.typed(*value)).collect(), p.shape());
            (p.name, p.doc, p.unit.symbol, values, shape)
        });
        plain.collect()
    }

    /// The values of all parameters in SI units, to the last bit.
    #[getter]
    fn state(&self) -> Vec<(String, Vec<f64>)> {
        self.problem.structure().parameters.into_iter().map(|parameter| (parameter.name, parameter.value)).collect()
    }

    /// The same problem with values that [`Compiled::state`] gave.
    fn with_state(&self, py: Python<'_>, state: Vec<(String, Vec<f64>)>) -> PyResult<Self> {
        let mut problem = (*self.problem).clone();
        for (name, values) in state {
            let set = problem.set(&name, &values);
            set.map_err(|error| errors::plain(py, "ParameterError", &error.to_string()))?;
        }
        Ok(Self { spec: self.spec.clone(), problem: Arc::new(problem) })
    }

    /// The same problem with other values of parameters.
    fn with_parameters(&self, parameters: &Bound<'_, PyDict>) -> PyResult<Self> {
        if parameters.is_empty() {
            return Ok(Self { spec: self.spec.clone(), problem: self.problem.clone() });
        }
        let mut problem = (*self.problem).clone();
        assign(&mut problem, parameters)?;
        Ok(Self { spec: self.spec.clone(), problem: Arc::new(problem) })
    }

    /// Solves once, from the guess of the spec or from a solution.
    fn solve(
        &self,
        py: Python<'_>,
        settings: Given,
        guess: Option<Bound<'_, Found>>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Found> {
        let mut settings = settings.settings(py)?;
        let watch = Watch::new(callback);
        watch.over(&mut settings);
        let problem = &*self.problem;
        let guess = guess.map(|found| start(py, problem, found.get())).transpose()?.unwrap_or_default();
        let solved = py.detach(|| solve_from(problem, &guess, &settings));
        let iterations = watch.end()?;
        let report = solved.map_err(|error| errors::of(py, &error, &self.spec.source))?;
        Ok(Found::new(self.spec.clone(), self.problem.clone(), report, iterations))
    }

    /// A solver that keeps what does not change between solves.
    fn solver(&self, py: Python<'_>, settings: Given) -> PyResult<KeptSolver> {
        Ok(KeptSolver::new(self.spec.clone(), (*self.problem).clone(), &settings.settings(py)?))
    }

    /// The number in the declared unit of a parameter that a text such as `240 m/s` stands for.
    fn number(&self, py: Python<'_>, name: &str, text: &str) -> PyResult<f64> {
        let invalid = |message: String| errors::plain(py, "ParameterError", &format!("`{name}`: {message}"));
        let (base, _) = ntg_interp::target(name).map_err(invalid)?;
        let structure = self.problem.structure();
        let declared = structure.parameters.iter().find(|parameter| parameter.name == base);
        let unit = declared.map(|parameter| parameter.unit.clone()).unwrap_or_default();
        match ntg_interp::quantity(text, &unit).map_err(invalid)?[..] {
            [value] => Ok(unit.typed(value)),
            _ => Err(invalid(format!("`{text}` is not one number"))),
        }
    }
}
