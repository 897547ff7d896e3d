//! A simulation first: where a spec has no objective, so that there is one motion to find, which is mostly the simulation
//! itself (docs/maths.md, section 8.6).

use super::budget::Budget;
use super::session::{FirstPoint, Session, Task};
use crate::guess::{Guess, simulated};
use crate::settings::{Method, Settings};
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::{Outcome, Start};

impl Session {
    /// An attempt from a simulation for the guess `x`, where there is no objective; none elsewhere. Scales are those of the simulation afterwards.
    pub(super) fn solve_simulated(
        &mut self,
        nlp: &mut Transcription,
        (task, x): (Task<'_>, &[f64]),
        settings: &Settings,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Outcome>, SetupError> {
        if !is_only_motion(nlp) || settings.method != Method::Auto || !task.guess.is_none_or(Guess::is_empty) {
            return Ok(None);
        }
        let Some((limits, simulated)) = budget.near().zip(simulated(nlp, x)) else { return Ok(None) };
        nlp.set_scales(&simulated, &limits)?;
        let outcome = self.solve_measured(nlp, FirstPoint { x: &simulated, from: Start::Cold }, &limits);
        budget.spend(outcome.iterations);
        Ok(Some(outcome))
    }
}

/// Whether there is no objective: one motion is to be found.
fn is_only_motion(nlp: &Transcription) -> bool {
    nlp.model.structure.terms.is_empty()
}

/// Whether a simulation follows the motion that is to be found; `x` has its inputs, times and variables.
pub(super) fn can_be_simulated(nlp: &Transcription, x: &[f64]) -> bool {
    is_only_motion(nlp) && simulated(nlp, x).is_some()
}
