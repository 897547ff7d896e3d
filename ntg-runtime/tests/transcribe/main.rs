//! What transcription makes of hand-made problems. One binary, because every binary would compile the solver, optimised,
//! again.

mod derivatives;
mod errors;
mod guess;
mod solve;
mod support;
