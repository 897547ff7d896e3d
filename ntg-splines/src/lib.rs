//! B-splines, quadrature and interpolation tables: the pure mathematics of ntg.
//!
//! - [`Knots`] is the knot vector of one output over scaled time `0 ..= 1`; [`Knots::basis`]
//!   gives values and derivatives of the B-splines that act at a point, [`Spline`] joins them
//!   with coefficients.
//! - [`gauss`], [`trapezoid`] and [`equidistant`] are quadrature rules on `0 ..= 1`.
//! - [`fit()`] finds the coefficients that follow samples, with exact ends, whatever the samples.
//! - [`Table`] interpolates data over rectangular nodes, with exact partial derivatives.
//!
//! Nothing here knows what a trajectory is, does input or output, or keeps state. Evaluation
//! ([`Knots::basis`], [`Spline`], [`Table::eval`]) allocates nothing and can be shared between
//! threads. The mathematics is in docs/maths.md, sections 1 (B-splines) and 7 (tables).
//!
//! ```
//! use ntg_splines::{Axis, Extrapolation, Knots, Method, Spline, Table};
//!
//! let knots = Knots::uniform(5, 2, 3)?;
//! let coefficients = knots.greville(); // The straight line through the origin with slope 1.
//! let spline = Spline::new(&knots, &coefficients).expect("one coefficient for each abscissa");
//! assert!((spline.at(0.3) - 0.3).abs() < 1e-15);
//!
//! let nodes = Axis::even(vec![0.0, 30.0, 60.0]);
//! let table = Table::new(vec![nodes], vec![1.0, 2.0, 5.0], Method::Monotone, Extrapolation::Clamp)?;
//! assert_eq!(table.eval(&[-30.0], &[0]), 2.0);
//! assert_eq!(table.eval(&[0.0], &[1]), 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod banded;
pub mod basis;
mod fit;
mod knots;
mod quadrature;
mod table;

pub use basis::Spline;
pub use fit::{Ends, Place, Sample, Sampled, fit, fit_all, fit_places};
pub use knots::{KnotError, Knots, MAX_INTERVALS, MAX_ORDER, Side};
pub use quadrature::{Rule, equidistant, gauss, trapezoid};
pub use table::{
    Axis, AxisParts, Cells, Extrapolation, FitReport, MAX_ARGUMENTS, MAX_TABLE_ORDER, Method, Symmetry, Table,
    TableError,
};
