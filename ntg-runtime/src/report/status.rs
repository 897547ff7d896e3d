//! A solver's status in the user's words: rows, variables and expressions by their names.

use crate::status::{Crossing, Status, Violation};
use crate::transcribe::Transcription;
use ntg_nlp::Outcome;
use ntg_nlp::status::Bounded;
use ntg_structure::{Place, Structure, Unit};

/// What a person may try next; where a solve came to no end or to no minimum, the places at which gradients jump.
pub(super) fn advice(status: &Status, structure: &Structure) -> String {
    /// More of them are counted only.
    const NAMED: usize = 3;
    let advice = status.advice().to_owned();
    let no_end =
        matches!(status, Status::IterationLimit | Status::TimeLimit | Status::StepTooSmall | Status::Acceptable);
    let corners: Vec<&Place> = structure.corners_posed().collect();
    if !(no_end || *status == Status::Stationary) || corners.is_empty() {
        return advice;
    }
    let named = corners.iter().take(NAMED).map(|place| format!("`{}` (line {})", place.text, place.line));
    let mut named: Vec<String> = named.collect();
    if let Some(more) = corners.len().checked_sub(NAMED).filter(|more| *more > 0) {
        named.push(format!("{more} more"));
    }
    let named = named.join(", ");
    match no_end {
        true => format!("{advice} Gradients jump at {named}: a smooth form may be needed there."),
        false => format!(
            "{advice} Gradients jump at {named}: where the solution is at the tip of such a corner, begin on the side on \
             which the objective is better."
        ),
    }
}

/// The status of an outcome of this transcription.
pub(crate) fn of_outcome(nlp: &Transcription, outcome: &Outcome) -> Status {
    of_end(nlp, outcome.status.clone(), outcome.is_saddle)
}

/// As [`of_outcome`], of the solver's status and of whether the end is a saddle.
pub(super) fn of_end(nlp: &Transcription, status: ntg_nlp::Status, is_saddle: bool) -> Status {
    match in_words(nlp, status) {
        Status::Solved if is_saddle => Status::Stationary,
        status => status,
    }
}

/// A solver's status.
fn in_words(nlp: &Transcription, status: ntg_nlp::Status) -> Status {
    use ntg_nlp::Status as Solver;
    match status {
        Solver::Solved => Status::Solved,
        Solver::Acceptable => Status::Acceptable,
        Solver::Infeasible { rows } => Status::Infeasible {
            rows: rows
                .into_iter()
                .map(|ntg_nlp::status::Violation { of, value, bound, violation }| Violation {
                    of,
                    name: name(nlp, of),
                    value,
                    bound,
                    violation,
                    unit: unit(nlp, of),
                })
                .collect(),
        },
        Solver::IterationLimit => Status::IterationLimit,
        Solver::TimeLimit => Status::TimeLimit,
        Solver::Cancelled => Status::Cancelled,
        Solver::StepTooSmall => Status::StepTooSmall,
        Solver::Unbounded => Status::Unbounded,
        Solver::NotFinite { what, x } => Status::NotFinite(nlp.in_words(what, &x)),
        Solver::Contradiction { bounds } => Status::Contradiction {
            bounds: bounds
                .into_iter()
                .map(|ntg_nlp::status::Crossing { of, lower, upper }| Crossing {
                    of,
                    name: name(nlp, of),
                    lower,
                    upper,
                    unit: unit(nlp, of),
                })
                .collect(),
        },
        Solver::SubproblemFailed => Status::SubproblemFailed,
    }
}

fn unit(nlp: &Transcription, of: Bounded) -> Unit {
    match of {
        Bounded::Row(row) => nlp.row_unit(row),
        Bounded::Variable(variable) => nlp.variable_unit(variable),
    }
}

fn name(nlp: &Transcription, of: Bounded) -> String {
    match of {
        Bounded::Row(row) => nlp.row_name(row),
        Bounded::Variable(variable) => nlp.variable_name(variable),
    }
}
