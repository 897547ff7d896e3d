//! A declarative language for optimal control and trajectory generation, compiled to Rust.
//!
//! A *spec* states outputs, dynamics, limits and cost, with units. It lives in a file that
//! [`ntg_file!`] takes in, or inline in [`ntg!`]; either way the compiler checks it,
//! differentiates it exactly, and writes a Rust type with a `solve` method. The outputs are
//! B-splines, so for flat systems there is nothing to integrate: a trajectory is a few dozen
//! coefficients, and a structured interior-point method finds them.
//!
//! ```
//! use ntg::prelude::*;
//!
//! ntg! {
//!     /// From rest to rest with the least effort.
//!     problem RestToRest {
//!         duration T = 2 [s];
//!         param distance = 3 [m];
//!         output x [m]: spline(order = 6, intervals = 1);
//!         let speed [m/s] = der(x);
//!         minimize integral(der(x, 2)^2);
//!         initial { x == 0;  speed == 0; }
//!         final   { x == distance;  speed == 0; }
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let problem = RestToRest { distance: 1.0 }; // Parameters are fields, in their declared units.
//! let solution = problem.solve(&Settings::default())?;
//!
//! // By hand: a cubic, with cost 12 distance^2 / T^3.
//! assert!((solution.objective() - 1.5).abs() < 1e-6);
//! assert!((solution.x.at(1.0) - 0.5).abs() < 1e-6); // Outputs are fields,
//! assert!((solution.speed().at(1.0) - 0.75).abs() < 1e-6); // what follows from them are methods.
//! # Ok(())
//! # }
//! ```
//!
//! The language is described in docs/language.md, the mathematics in docs/maths.md, and every
//! message of the compiler in docs/errors.md.

// The macros write `::ntg::...`, which must mean this crate here too.
extern crate self as ntg;

pub use ntg_macros::{ntg, ntg_file};
pub use ntg_runtime as runtime;

/// What a program that solves problems names: `use ntg::prelude::*;`.
pub mod prelude {
    pub use crate::{ntg, ntg_file};
    pub use ntg_runtime::prelude::*;
}
