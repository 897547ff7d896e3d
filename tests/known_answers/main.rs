//! Problems whose answers are known: on paper, published, or from independent solvers.
//!
//! A module holds one family of problems. Compiling a spec into a test costs seconds, so each
//! shipped spec is generated code in one test at most; the others run it through the interpreter
//! (`support::Shipped`), which agrees with it bit for bit (`tests/contract/`).

mod angles;
mod car;
mod clamps;
mod constrained;
mod constructs;
mod corners;
mod curved_corners;
mod data;
mod decades;
mod degenerate;
mod derivatives;
mod durations;
mod equation_corners;
mod estimates;
mod few_iterations;
mod fine_meshes;
mod flat_limits;
mod flat_optima;
mod fleet;
mod flight;
mod flight_phases;
mod free_ends;
mod gates;
mod headings;
mod integrals;
mod invariants;
mod jumped;
mod least_bodies;
mod least_durations;
mod least_of_zero;
mod limits;
mod missile;
mod norms;
mod objective_sizes;
mod offsets;
mod oscillator;
mod out_of_reach;
mod phases;
mod piecewise_linear;
mod places;
mod plateaus;
mod poles;
mod quotients;
mod resolve;
mod saddles;
mod scenarios;
mod simulations;
mod sizes;
mod soft_limits;
mod support;
mod through_the_centre;
mod tips;
mod unbounded;
mod unresolved;
mod vanishing;
mod vectors;
mod vehicles;
mod winding;
mod windows;
