//! Watches solves: a line of progress on a terminal, what every iteration was, and Ctrl-C.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use ntg_runtime::settings::{Control, Progress, Settings};

/// How often a line of progress is drawn again.
pub(crate) const REDRAW: Duration = Duration::from_millis(100);

/// Whether someone has pressed Ctrl-C. The first press stops solves at their next iteration, so
/// that everything ends in order; the second ends the process.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Takes over Ctrl-C. Where that is impossible the system's own way remains: the process ends.
    pub(crate) fn install() -> Self {
        let interrupt = Self::default();
        let pressed = interrupt.clone();
        let _ = ctrlc::set_handler(move || {
            if pressed.0.swap(true, Ordering::SeqCst) {
                std::process::exit(crate::Exit::Interrupted.status());
            }
        });
        interrupt
    }

    /// Whether it was pressed.
    pub(crate) fn is_pressed(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }

    /// Lets it end solves with these settings, without a line of progress.
    pub(crate) fn over(&self, settings: &mut Settings) {
        let interrupt = self.clone();
        let watch = move |_: &_| if interrupt.is_pressed() { Control::Cancel } else { Control::Continue };
        settings.on_iteration = Some(Arc::new(watch));
    }
}

/// What one watch has seen of a solve.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    interrupt: Interrupt,
    line: ProgressBar,
    seen: Arc<Mutex<Vec<Progress>>>,
}

impl Watch {
    /// A watch whose line goes to standard error if that is a terminal, and nowhere otherwise.
    pub(crate) fn new(interrupt: &Interrupt) -> Self {
        let line = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        // The template is a constant; if it were wrong the default line would show.
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            line.set_style(style);
        }
        if std::io::stderr().is_terminal() {
            line.enable_steady_tick(REDRAW);
        }
        Self { interrupt: interrupt.clone(), line, seen: Arc::default() }
    }

    /// Lets the watch see a solve with these settings.
    pub(crate) fn over(&self, settings: &mut Settings) {
        let watch = self.clone();
        settings.on_iteration = Some(Arc::new(move |progress| watch.see(progress)));
    }

    fn see(&self, progress: &Progress) -> Control {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.push(*progress);
        drop(seen);
        self.line.set_message(words(progress));
        if self.interrupt.is_pressed() { Control::Cancel } else { Control::Continue }
    }

    /// Takes the line away; gives all iterations seen. Says where a solve was stopped that would have
    /// gone on: one that came to its end in spite of Ctrl-C was not.
    pub(crate) fn end(&self, cancelled: bool) -> Vec<Progress> {
        self.line.finish_and_clear();
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if let (true, Some(last)) = (cancelled && self.interrupt.is_pressed(), seen.last()) {
            tell!("stopped by Ctrl-C after {}", words(last));
        }
        seen
    }
}

/// "iteration 12: objective 1.234567e0, violation 1.0e-3, stationarity 2.0e-2".
fn words(progress: &Progress) -> String {
    let Progress { iteration, objective, primal, dual, .. } = progress;
    format!("iteration {iteration}: objective {objective:.6e}, violation {primal:.1e}, stationarity {dual:.1e}")
}
