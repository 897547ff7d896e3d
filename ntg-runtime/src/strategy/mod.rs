//! From a problem to a report: which program is solved from where, and what is tried where a solve fails
//! (docs/maths.md, sections 8.4, 11.9 and 11.10).
//!
//! ```text
//! Problem -> Transcription -> (guess, scales) -> solver -> Report
//! ```
//!
//! [`Session`] keeps everything that one solve leaves to the next. `solve` goes through the steps of a continuation,
//! `coarse_start` finds starts on fewer knots, `simulated_start` by simulation, `fallback` is the sequence of attempts where
//! a solve fails, `feasible_guess` looks whether a guess was better, `tips` whether a solution at the tip of a corner is a
//! minimum, `plateaus` whether one that does not feel some variables is, `way_down` where either leads; `least_durations`
//! whether one ends where only the transcription holds it; `relaxation` looks whether one with helpers in the place of corners
//! meets the equations as they are written; `corner_sides` and `held_sides` say on which
//! sides of their corners helpers are held where it does not.

mod beside;
mod budget;
mod carried;
mod coarse_start;
mod continuation;
mod corner_sides;
mod fallback;
mod feasible_guess;
mod held_sides;
mod least_durations;
mod one_sided;
mod open_durations;
mod plateaus;
mod relaxation;
mod session;
mod simulated_start;
mod slopes;
mod solve;
mod tips;
mod turns;
mod way_down;
mod winding;

pub(crate) use session::{Session, Task};
pub use solve::Tracked;
pub(crate) use solve::warm;
