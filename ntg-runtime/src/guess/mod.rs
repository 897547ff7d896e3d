//! Where a solve starts (docs/maths.md, section 8).
//!
//! Takes the `guess` statements of the spec and what a program says beside them; gives the first
//! point. Statements of a program come after those of the spec, and the last one about a thing
//! holds. What nobody guesses is guessed from bounds and boundary conditions.
//!
//! Finds: names that nothing bears, values that are not finite, wrong numbers of coefficients.

mod aside;
mod earlier;
mod equations;
mod heading;
mod perturbed;
mod program;
mod route;
mod simulate;
mod start;
mod statements;

pub(crate) use perturbed::{between, perturbed, perturbed_variables};
pub use program::Guess;
pub(crate) use route::Route;
pub(crate) use simulate::{Defect, defect, simulated};
pub use start::start;
pub(crate) use start::{Curve, apply, finish, guessed, pointwise, set};
