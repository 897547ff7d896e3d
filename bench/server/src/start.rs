//! What the program is and where it starts, so that another transcription can be held against it.

use ntg::prelude::Guess;
use ntg::runtime::guess::start;
use ntg::runtime::nlp::Nlp;
use ntg::runtime::problem::WithStructure;
use ntg::runtime::transcribe::Transcription;
use ntg_bench_program::adapted;
use serde_json::{Value, json};

/// Size, first point (SI) and objective there, for each step of the continuation (all of them
/// at the first step's point).
pub fn describe(problem: &WithStructure<'_>, guess: Option<&Guess>) -> Result<Value, String> {
    let mut steps = vec![];
    for step in &adapted::steps(problem) {
        let nlp = Transcription::new(step).map_err(|error| error.to_string())?;
        let first = start(&nlp, guess).map_err(|error| error.to_string())?;
        let (mut work, mut at) = nlp.workspace();
        nlp.values(&first, &mut work, &mut at).map_err(|error| error.to_string())?;
        steps.push(json!({
            "variables": nlp.variables(),
            "rows": nlp.rows(),
            "objective": adapted::in_its_unit(problem, at.objective),
            "start": first,
        }));
    }
    Ok(Value::Array(steps))
}
