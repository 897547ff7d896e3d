//! What many starts found, for programs.

use ntg_runtime::multistart::MultiReport;
use serde_json::{Value, json};

/// The minima and what became of every start.
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
