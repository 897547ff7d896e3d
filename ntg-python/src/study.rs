//! Many parameter sets of one problem, on all cores.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use ntg_interp::{Interpreted, Place};
use ntg_runtime::problem::Problem;
use ntg_runtime::settings::{Control, Settings};
use ntg_sweep::{Block, Column, Ended, Plan, Results, Rows, Shard, Study, Wanted, Watcher};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors;
use crate::problem::Compiled;
use crate::settings::Given;

/// How often Python is asked for Ctrl-C, and told how far it is.
const ASK: Duration = Duration::from_millis(50);

/// How far a study is, and whether it is to stop.
#[derive(Default)]
struct State {
    done: AtomicUsize,
    stopped: AtomicBool,
}

impl Watcher for State {
    fn done(&self, rows: usize) {
        self.done.store(rows, Ordering::Relaxed);
    }

    fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

/// What decides how a study is run, beside the study.
#[derive(FromPyObject)]
pub(crate) struct How {
    values: Vec<String>,
    jobs: usize,
    /// Rows of a block; none for the usual number.
    block: Option<usize>,
    /// Rows of blocks that are given: each block's rows stand together, its first row first. Empty for a study whose
    /// blocks are to be found.
    lengths: Vec<usize>,
    /// A journal's file and the shard `(part, of)`.
    journal: Option<(PathBuf, (usize, usize))>,
}

/// The rows of each block of a study, the block's first row first.
#[pyfunction]
pub(crate) fn blocks<'py>(
    py: Python<'py>,
    sets: PyReadonlyArray2<'py, f64>,
    size: Option<usize>,
) -> Vec<Bound<'py, PyArray1<i64>>> {
    let sets = vectors(&sets);
    let size = size.unwrap_or_else(|| ntg_sweep::usual_block(sets.len()));
    let rows =
        |block: Block| -> Vec<i64> { std::iter::once(block.first).chain(block.rest).map(|row| row as i64).collect() };
    ntg_sweep::blocks(&sets, size).into_iter().map(|block| rows(block).into_pyarray(py)).collect()
}

fn vectors(sets: &PyReadonlyArray2<'_, f64>) -> Vec<Vec<f64>> {
    sets.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
}

/// Solves all sets; gives the columns of the table, each as text or as numbers.
#[pyfunction]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    compiled: &Bound<'py, Compiled>,
    inputs: Vec<String>,
    sets: PyReadonlyArray2<'py, f64>,
    settings: Given,
    how: How,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let compiled = compiled.get();
    let problem = (*compiled.problem).clone();
    let structure = problem.structure();
    let invalid = |class, message: &str| errors::plain(py, class, message);
    let places = inputs.iter().map(|name| place(&problem, name)).collect::<Result<Vec<_>, _>>();
    let places = places.map_err(|message| invalid("ParameterError", &message))?;
    let mut settings = settings.settings(py)?;
    let mut about = vec![compiled.spec.source.text.clone(), format!("{structure:?}"), format!("{settings:?}")];
    about.extend(how.values.iter().cloned());
    let sets = vectors(&sets);
    let mut first = problem.clone();
    // What is wrong with a set is told by its row.
    _ = sets.first().map(|set| put(&mut first, &places, set));
    let wanted = Wanted::all(&how.values, &first).map_err(|message| invalid("ParameterError", &message))?;
    let block = how.block.unwrap_or_else(|| ntg_sweep::usual_block(sets.len()));
    let study = Study { inputs, sets, block, about };
    let state = std::sync::Arc::new(State::default());
    stoppable(&mut settings, &state);
    let rows = Rows::new(problem, Box::new(move |problem, set| put(problem, &places, set)), wanted, settings);
    let run = || match &how.journal {
        Some((journal, (part, of))) => {
            let shard = Shard::new(*part, *of)?;
            ntg_sweep::run(&study, Plan { jobs: how.jobs, shard, journal }, &*state, &rows)
        }
        None => ntg_sweep::solve_all(&study, given_blocks(&study, &how.lengths), how.jobs, &*state, &rows),
    };
    let ended = watched(py, run, &state, progress, study.sets.len())?;
    match ended.map_err(|message| invalid("Error", &message))? {
        Ended::Finished(results) => Ok(columns(py, &results)),
        Ended::Stopped(rows) => Err(invalid("Error", &format!("stopped after {rows} rows"))),
    }
}

/// Lets the state stop solves with these settings.
fn stoppable(settings: &mut Settings, state: &std::sync::Arc<State>) {
    let state = state.clone();
    let watch = move |_: &_| if state.stopped() { Control::Cancel } else { Control::Continue };
    settings.on_iteration = Some(std::sync::Arc::new(watch));
}

/// Runs in another thread, while this one asks Python for Ctrl-C and tells it how far it is.
fn watched<T: Send>(
    py: Python<'_>,
    run: impl FnOnce() -> T + Send,
    state: &State,
    progress: Option<Py<PyAny>>,
    all: usize,
) -> PyResult<T> {
    let ended = py.detach(|| {
        std::thread::scope(|scope| {
            let (send, receive) = channel();
            let work = scope.spawn(move || {
                let result = run();
                let _ = send.send(());
                result
            });
            let mut raised = None;
            while let Err(RecvTimeoutError::Timeout) = receive.recv_timeout(ASK) {
                if raised.is_none()
                    && let Err(error) = Python::attach(|py| ask(py, progress.as_ref(), state, all))
                {
                    raised = Some(error);
                    state.stopped.store(true, Ordering::Relaxed);
                }
            }
            (work.join(), raised)
        })
    });
    match ended {
        (_, Some(error)) => Err(error),
        (Ok(result), None) => {
            ask(py, progress.as_ref(), state, all)?;
            Ok(result)
        }
        (Err(panic), None) => std::panic::resume_unwind(panic),
    }
}

fn ask(py: Python<'_>, progress: Option<&Py<PyAny>>, state: &State, all: usize) -> PyResult<()> {
    py.check_signals()?;
    if let Some(callback) = progress {
        callback.bind(py).call1((state.done.load(Ordering::Relaxed), all))?;
    }
    Ok(())
}

fn given_blocks(study: &Study, lengths: &[usize]) -> Vec<Block> {
    if lengths.is_empty() {
        return ntg_sweep::blocks(&study.sets, study.block);
    }
    let mut at = 0;
    let block = lengths.iter().map(|length| {
        let first = at;
        at += length;
        Block { first, rest: (first + 1..at).collect() }
    });
    block.collect()
}

fn place(problem: &Interpreted, name: &str) -> Result<Place, String> {
    let (base, indices) = ntg_interp::target(name)?;
    problem.place(base, &indices).map_err(|error| error.to_string())
}

fn put(problem: &mut Interpreted, places: &[Place], set: &[f64]) -> Result<(), String> {
    for (place, value) in places.iter().zip(set) {
        problem.put(*place, *value).map_err(|error| error.to_string())?;
    }
    Ok(())
}

fn columns<'py>(py: Python<'py>, results: &Results) -> Vec<(String, Bound<'py, PyAny>)> {
    let columns = ntg_sweep::columns(results).into_iter();
    let data = columns.map(|(name, column)| {
        let values = match column {
            Column::Count(values) => values.into_pyarray(py).into_any(),
            Column::Number(values) => {
                let values: Vec<f64> = values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                values.into_pyarray(py).into_any()
            }
            Column::Words(values) => match pyo3::types::PyList::new(py, values) {
                Ok(list) => list.into_any(),
                Err(_) => py.None().into_bound(py),
            },
        };
        (name, values)
    });
    data.collect()
}
