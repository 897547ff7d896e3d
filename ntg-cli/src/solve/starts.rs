//! `--starts N`: which starts are wanted, progress while they are solved, and what they found.

use std::sync::Arc;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use ntg_runtime::multistart::{MultiReport, StartKind, StartProgress, Starts};
use ntg_runtime::settings::Control;
use serde_json::{Value, json};

use crate::arguments::{Kind, Solve};
use crate::watch::Interrupt;

/// The starts that were asked for, with a line of progress on a terminal; Ctrl-C stops them.
pub(super) fn wanted(arguments: &Solve, interrupt: &Interrupt) -> Option<Starts> {
    let kind = match arguments.start_kind {
        Kind::Mixed => StartKind::Mixed,
        Kind::Routes => StartKind::Routes,
        Kind::Perturbed => StartKind::Perturbed,
        Kind::Search => StartKind::Search,
    };
    let line = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    // The template is a constant; if it were wrong the default line would show.
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        line.set_style(style);
    }
    let interrupt = interrupt.clone();
    let on_start = move |progress: &StartProgress| {
        let StartProgress { done, count, solved, best, .. } = *progress;
        line.set_message(format!("{done} of {count} starts, {solved} solved, best {best:.9}"));
        line.tick();
        if done == count {
            line.finish_and_clear();
        }
        if interrupt.is_pressed() { Control::Cancel } else { Control::Continue }
    };
    let (count, seed) = (arguments.starts? as usize, arguments.seed);
    Some(Starts { count, seed, kind, on_start: Some(Arc::new(on_start)) })
}

/// What the starts found, for programs.
pub(super) fn document(found: &MultiReport) -> Value {
    let minima = found.minima.iter().map(|minimum| {
        json!({
            "objective": minimum.report.objective,
            "count": minimum.count,
            "from": found.starts[minimum.first].origin.to_string(),
            "violation_between": minimum.report.violation.between,
        })
    });
    let each = found.starts.iter().map(|start| {
        json!({
            "from": start.origin.to_string(),
            "status": start.status,
            "objective": start.objective,
            "minimum": start.minimum,
            "iterations": start.iterations,
            "seconds": start.seconds,
        })
    });
    json!({
        "tried": found.tried(),
        "solved": found.solved(),
        "minima": minima.collect::<Vec<_>>(),
        "each": each.collect::<Vec<_>>(),
        "notes": found.notes,
        "seconds": found.seconds,
    })
}
