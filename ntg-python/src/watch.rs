//! Watches a solve for Python: progress, Ctrl-C, a callback that may stop it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use ntg_runtime::settings::{Control, Progress, Settings};
use pyo3::prelude::*;

/// How often Python is asked for Ctrl-C: seldom enough to cost nothing, soon enough for a person.
const ASK: Duration = Duration::from_millis(20);

/// What one watch has seen.
#[derive(Clone, Default)]
pub(crate) struct Watch(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    callback: Option<Py<PyAny>>,
    asked: Option<Instant>,
    seen: Vec<Progress>,
    /// What Python raised meanwhile: Ctrl-C, or the callback's exception.
    raised: Option<PyErr>,
}

impl Watch {
    /// A watch that tells a callback of every iteration.
    pub(crate) fn new(callback: Option<Py<PyAny>>) -> Self {
        Self(Arc::new(Mutex::new(State { callback, ..State::default() })))
    }

    /// Lets it see a solve with these settings.
    pub(crate) fn over(&self, settings: &mut Settings) {
        let watch = self.clone();
        settings.on_iteration = Some(Arc::new(move |progress| watch.see(progress)));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn see(&self, progress: &Progress) -> Control {
        let callback = {
            let mut state = self.state();
            state.seen.push(*progress);
            let due = state.asked.is_none_or(|asked| asked.elapsed() >= ASK);
            if state.callback.is_none() && !due {
                return Control::Continue;
            }
            state.asked = Some(Instant::now());
            // Cloning a reference needs Python, which may want this lock: so not here.
            state.callback.take()
        };
        let (asked, callback) = Python::attach(|py| (ask(py, callback.as_ref(), progress), callback));
        let mut state = self.state();
        state.callback = callback;
        match asked {
            Ok(control) => control,
            Err(error) => {
                state.raised = Some(error);
                Control::Cancel
            }
        }
    }

    /// All iterations; or what Python raised meanwhile.
    pub(crate) fn end(self) -> PyResult<Vec<Progress>> {
        let mut state = self.state();
        match state.raised.take() {
            Some(error) => Err(error),
            None => Ok(std::mem::take(&mut state.seen)),
        }
    }
}

/// Asks for Ctrl-C, and the callback whether to go on: it says `False` to stop.
fn ask(py: Python<'_>, callback: Option<&Py<PyAny>>, progress: &Progress) -> PyResult<Control> {
    py.check_signals()?;
    let Some(callback) = callback else { return Ok(Control::Continue) };
    let Progress { iteration, objective, primal, dual, step, seconds } = *progress;
    let answer = callback.bind(py).call1((iteration, objective, primal, dual, step, seconds))?;
    let stop = !answer.is_none() && answer.extract::<bool>().is_ok_and(|goes_on| !goes_on);
    Ok(if stop { Control::Cancel } else { Control::Continue })
}
