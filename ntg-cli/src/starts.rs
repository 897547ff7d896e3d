//! `--starts N`: which starts are wanted, and progress while they are solved.

use std::io::IsTerminal;
use std::sync::Arc;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use ntg_interp::Interpreted;
use ntg_runtime::Error;
use ntg_runtime::digits::decimals;
use ntg_runtime::guess::Guess;
use ntg_runtime::multistart::{MultiReport, StartKind, StartProgress, Starts, multistart_from};
use ntg_runtime::settings::{Control, Settings};

use crate::watch::{Interrupt, REDRAW};
use crate::{Exit, arguments};

/// Solves from as many starts as were asked for, with a line of progress on a terminal; Ctrl-C stops them.
/// None where nobody has asked.
pub(crate) fn solve(
    problem: &Interpreted,
    guess: &Guess,
    (wanted, interrupt): (&arguments::Starts, &Interrupt),
    settings: &Settings,
) -> Option<Result<MultiReport, Error>> {
    let count = wanted.count? as usize;
    let kind = match wanted.kind {
        arguments::Kind::Mixed => StartKind::Mixed,
        arguments::Kind::Routes => StartKind::Routes,
        arguments::Kind::Perturbed => StartKind::Perturbed,
        arguments::Kind::Search => StartKind::Search,
    };
    let line = line(count);
    let (shown, watching) = (line.clone(), interrupt.clone());
    let on_start = move |progress: &StartProgress| {
        shown.set_message(words(progress));
        if watching.is_pressed() { Control::Cancel } else { Control::Continue }
    };
    let starts = Starts { count, seed: wanted.seed, kind, on_start: Some(Arc::new(on_start)) };
    let mut settings = settings.clone();
    interrupt.over(&mut settings);
    let found = multistart_from(problem, guess, &starts, &settings);
    line.finish_and_clear();
    if let (true, Ok(found)) = (interrupt.is_pressed(), &found) {
        tell!("stopped by Ctrl-C after {} of {count} starts", found.tried());
    }
    Some(found)
}

/// Says why not a single start was tried: nothing is wrong with the problem.
pub(crate) fn none_tried(problem: &str, interrupt: &Interrupt) -> Exit {
    if interrupt.is_pressed() {
        return Exit::Interrupted;
    }
    tell!("{problem}: the time limit was reached before a start began; allow more time (`--time-limit`)");
    Exit::NotSolved
}

/// A line that goes to standard error if that is a terminal, and moves while starts are solved.
fn line(count: usize) -> ProgressBar {
    let line = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    // The template is a constant; if it were wrong the default line would show.
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        line.set_style(style);
    }
    line.set_message(format!("looking for {count} starts"));
    if std::io::stderr().is_terminal() {
        line.enable_steady_tick(REDRAW);
    }
    line
}

/// "3 of 50 starts, 2 solved, best 128.252905291".
fn words(progress: &StartProgress) -> String {
    let StartProgress { done, count, solved, best, .. } = *progress;
    let best = if best.is_nan() { String::new() } else { format!(", best {}", decimals(best, 9)) };
    format!("{done} of {count} starts, {solved} solved{best}")
}
