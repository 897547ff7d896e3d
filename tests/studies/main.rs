//! What goes beyond one solve: many starts, why there is no solution, finer meshes, and whether
//! what is called solved is.

mod between;
mod infeasible;
mod multistart;
mod refine;
mod solved;
#[allow(dead_code, reason = "each binary of tests uses a part of this module")]
#[path = "../known_answers/support.rs"]
mod support;
