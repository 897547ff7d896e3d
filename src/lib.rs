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
//! # Features
//!
//! `sensitivity`: solutions of `ntg!` and `ntg_file!` can be differentiated by the parameters of their problem. The
//! program then holds its specs' texts, and the compiler that reads them again when a derivative is asked for.
//!
//! ```
//! # #[cfg(feature = "sensitivity")]
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use ntg::prelude::*;
//!
//! ntg! {
//!     problem Move {
//!         duration T = 2 [s];
//!         param distance = 3 [m];
//!         output x [m]: spline(order = 6, intervals = 1);
//!         minimize effort: integral(der(x, 2)^2);
//!         initial { x == 0;  der(x) == 0; }
//!         final   { x == distance;  der(x) == 0; }
//!     }
//! }
//!
//! let problem = Move::default();
//! let solution = problem.solve(&Settings::default())?;
//! let by = solution.report().sensitivity(&problem)?;
//! // By hand: the cost is 12 distance^2 / T^3, the middle is distance / 2.
//! assert!((by.objective().values[0] - 9.0).abs() < 1e-6);
//! assert!((by.at("x", 1.0).unwrap().values[0] - 0.5).abs() < 1e-6);
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "sensitivity"))]
//! # fn main() {}
//! ```
//!
//! The language is described in docs/language.md, the mathematics in docs/maths.md, and every
//! message of the compiler in docs/errors.md.

// The macros write `::ntg::...`, which must mean this crate here too.
extern crate self as ntg;

pub use ntg_macros::{ntg, ntg_file};
pub use ntg_runtime as runtime;

/// What `ntg!` and `ntg_file!` make of the texts that they have read.
#[cfg(feature = "sensitivity")]
#[doc(hidden)]
pub use ntg_interp as interp;

/// Lets the solutions of a problem be differentiated: `ntg!` and `ntg_file!` call it.
#[cfg(feature = "sensitivity")]
#[doc(hidden)]
#[macro_export]
macro_rules! parametric {
    ($problem:ident, $name:literal, $text:literal, $files:tt, $given:tt) => {
        impl $crate::runtime::problem::Parametric for $problem {
            fn parametric(
                &self,
            ) -> ::std::sync::Arc<dyn $crate::runtime::problem::Problem + ::core::marker::Send + ::core::marker::Sync>
            {
                static SPEC: $crate::interp::Embedded = $crate::interp::Embedded::new($crate::interp::Spec {
                    name: $name,
                    text: $text,
                    files: &$files,
                    given: &$given,
                });
                SPEC.parametric($crate::runtime::problem::Problem::structure(self))
            }
        }
    };
}

/// Without the feature `sensitivity` the texts are left out.
#[cfg(not(feature = "sensitivity"))]
#[doc(hidden)]
#[macro_export]
macro_rules! parametric {
    ($($read:tt)*) => {};
}

/// What a program that solves problems names: `use ntg::prelude::*;`.
pub mod prelude {
    pub use crate::{ntg, ntg_file};
    pub use ntg_runtime::prelude::*;
}
