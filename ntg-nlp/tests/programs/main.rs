//! Programs whose answers are known, and laws that hold for all programs: one binary, because every binary would compile
//! both methods again.

#[macro_use]
mod support;

mod durations;
mod hs;
mod laws;
mod norms;
mod saddles;
mod sensitivity;

// Tests of both methods.
#[cfg(feature = "sqp")]
mod angles;
mod definitions;
mod degenerate;
#[cfg(feature = "sqp")]
mod elements;
#[cfg(feature = "sqp")]
mod endings;
#[cfg(feature = "sqp")]
mod hock_schittkowski;
#[cfg(feature = "sqp")]
mod known_programs;
#[cfg(feature = "sqp")]
mod vehicles;
