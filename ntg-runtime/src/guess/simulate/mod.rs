//! A guess by simulation (docs/maths.md, section 8.6): the equations of motion integrated from the initial conditions, for
//! the inputs, times and variables of another guess.
//!
//! ```text
//! mod       phase by phase, and back to coefficients
//! defect    by how much a solution leaves its equations
//!   initial   where a phase begins
//!   motion    its equations at places in time
//!     call      a call of the structure with slots replaced
//!   radau     the integration
//! ```

mod call;
mod defect;
mod elimination;
mod initial;
mod motion;
mod radau;
#[cfg(test)]
mod tests;

pub(crate) use defect::{Defect, defect};

use super::start::{Curve, apply, finish, pointwise};
use crate::transcribe::Transcription;
use motion::{Along, Equations};
use radau::{Motion, integrate};
use std::rc::Rc;

/// A motion that becomes so many times as large as its outputs' sizes runs off. A law: the solve would be measured by it, and
/// of what has the size of the problem four digits would be left. Growth that has not begun at the guess (1e-11 of what it
/// comes to, in a fed-batch reactor) is no such motion.
const RUNS_OFF: f64 = 1e12;

/// A first point whose outputs satisfy the equations of motion for the inputs, times and variables of `x`. None where the
/// equations do not decide the motion in some phase, or the motion runs off or cannot be followed to its end.
pub(crate) fn simulated(nlp: &Transcription, x: &[f64]) -> Option<Vec<f64>> {
    let layout = &nlp.model.layout;
    let mut x = x.to_vec();
    let along = Along::of(nlp)?;
    for phase in 0..layout.phases.len() {
        let guess = x.clone();
        let mut equations = Equations::new(nlp, &along, phase, &guess)?;
        let sizes = equations.sizes().to_vec();
        let initial = initial::initial(nlp, &equations, &guess, &sizes);
        let track = Rc::new(integrate(&mut equations, initial, &layout.phases[phase].breakpoints)?);
        if sizes.iter().enumerate().any(|(moving, size)| track.largest(moving) > RUNS_OFF * size) {
            return None;
        }
        let curve = |(moving, output): (usize, &usize)| {
            let track = Rc::clone(&track);
            let function = pointwise(move |tau| Ok(track.at(moving, tau)));
            Curve { phase, output: *output, whole: false, function }
        };
        let curves: Vec<Curve> = equations.outputs.iter().enumerate().map(curve).collect();
        apply(layout, &curves, &mut x).ok()?;
    }
    finish(nlp, x).ok()
}
