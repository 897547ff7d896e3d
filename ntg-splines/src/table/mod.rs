//! Interpolation tables of one or several arguments, with exact derivatives.
//!
//! A table is built once from nodes and values and then evaluated from many threads. Every
//! method becomes the same thing (docs/maths.md, equation 7.1): a grid of coefficients, and
//! in each argument a few piecewise polynomial weights. A partial derivative takes the
//! derivatives of the weights, so values, gradients and Hessians belong to one and the same
//! function, including its symmetry and its continuation outside the nodes.
//!
//! Takes nodes, values and a method; finds whatever is wrong with them ([`TableError`]).
//! Afterwards: evaluation cannot fail and allocates nothing.

mod axis;
mod bicubic;
mod cells;
mod error;
mod grid;
mod joined;
mod linear;
mod look_up;
mod monotone;
mod piece;
mod place;
mod report;
mod search;
mod spline;

pub use axis::{Axis, Symmetry};
pub use cells::Cells;
pub use error::TableError;
pub use report::FitReport;

use grid::Grid;
use joined::Joined;
use piece::Piece;

/// Largest number of arguments of a table.
pub const MAX_ARGUMENTS: usize = 8;

/// Largest order of a table's splines.
pub const MAX_TABLE_ORDER: usize = 12;

/// Largest number of coefficients (128 MiB): a guard against exhausting memory by a slip.
const MAX_COEFFICIENTS: usize = 1 << 24;

/// How a table passes through, or near, its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Method {
    /// Shape-preserving cubics, C1, exact at the nodes, never outside the values of the
    /// surrounding nodes. One or two arguments.
    Monotone,
    /// Tensor-product spline interpolation with not-a-knot ends, C^(order - 2). The order is
    /// lowered for arguments with fewer nodes.
    Bspline {
        /// One more than the degree: 4 is cubic.
        order: usize,
    },
    /// Tensor-product spline on equal intervals, least squares: does not meet the values and
    /// may leave their range; see [`Table::fit_report`].
    Fit {
        /// One more than the degree: 4 is cubic.
        order: usize,
        /// Number of intervals for each argument, over the range of its nodes.
        intervals: Vec<usize>,
    },
    /// Multilinear interpolation: continuous, with gradients that jump at the nodes.
    Linear,
}

/// What a table is outside its nodes. Periodic arguments have no outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extrapolation {
    /// It keeps its end value.
    #[default]
    Clamp,
    /// It goes on with its end slope.
    Linear,
}

/// One argument of an interpolant (docs/maths.md, equations 7.1 and 7.17).
#[derive(Clone, Debug, PartialEq)]
pub struct AxisParts {
    /// What holds beyond the nodes.
    pub symmetry: Symmetry,
    /// The first and the last node; of an even argument the last one, mirrored and as it is.
    pub ends: (f64, f64),
    /// Where each cell begins, and its width; cells follow one another.
    pub cells: Vec<(f64, f64)>,
    /// Coefficients that act on a cell, as many as its weights have Bernstein coefficients.
    pub order: usize,
    /// From the first coefficient of one cell to that of the next.
    pub step: usize,
    /// For each cell, the `order` by `order` Bernstein coefficients of its weights: first that of all weights where
    /// the cell begins, last where it ends.
    pub weights: Vec<f64>,
    /// How many coefficients the argument has.
    pub coefficients: usize,
}

/// An interpolation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    axes: Vec<Axis>,
    values: Grid,
    method: Method,
    extrapolation: Extrapolation,
    pieces: Vec<Piece>,
    strides: Vec<usize>,
    coefficients: Grid,
    joined: Option<Joined>,
}

impl Table {
    /// Builds a table. `values` holds one value for each combination of nodes, row-major, the
    /// last argument fastest.
    ///
    /// # Errors
    /// [`TableError`] says what is wrong with the nodes, the values or the method.
    pub fn new(
        axes: Vec<Axis>,
        values: Vec<f64>,
        method: Method,
        extrapolation: Extrapolation,
    ) -> Result<Self, TableError> {
        check_nodes(&axes)?;
        check_method(&axes, &method)?;
        let values = Grid { shape: axes.iter().map(|axis| axis.nodes.len()).collect(), values };
        check_values(&axes, &values)?;
        let (pieces, coefficients) = match &method {
            Method::Monotone => monotone::monotone(&axes, &values),
            Method::Bspline { order } => spline::interpolate(&axes, &values, *order)?,
            Method::Fit { order, intervals } => spline::fit(&axes, &values, *order, intervals)?,
            Method::Linear => linear::linear(&axes, &values),
        };
        if !coefficients.values.iter().all(|c| c.is_finite()) || !pieces.iter().all(Piece::is_finite) {
            return Err(TableError::NotRepresentable);
        }
        let joined = Joined::new(&pieces, &coefficients);
        if !joined.as_ref().is_none_or(Joined::is_finite) {
            return Err(TableError::NotRepresentable);
        }
        let strides = (0..axes.len()).map(|axis| coefficients.shape[axis + 1..].iter().product()).collect();
        Ok(Self { axes, values, method, extrapolation, pieces, strides, coefficients, joined })
    }

    /// The number of arguments.
    pub fn arguments(&self) -> usize {
        self.axes.len()
    }

    /// The arguments.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The values at the nodes, row-major, the last argument fastest.
    pub fn values(&self) -> &[f64] {
        &self.values.values
    }

    /// How the table is interpolated.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// What the table is outside its nodes.
    pub fn extrapolation(&self) -> Extrapolation {
        self.extrapolation
    }

    /// Replaces nodes and values; their numbers, the symmetry and the method stay.
    ///
    /// # Errors
    /// [`TableError`] as in [`Table::new`], or if a number of nodes differs. The table is then
    /// what it was.
    pub fn set(&mut self, nodes: Vec<Vec<f64>>, values: Vec<f64>) -> Result<(), TableError> {
        if nodes.len() != self.axes.len() {
            return Err(TableError::Arguments { found: nodes.len() });
        }
        for (axis, (new, old)) in nodes.iter().zip(&self.axes).enumerate() {
            let (expected, found) = (old.nodes.len(), new.len());
            if expected != found {
                return Err(TableError::SizeChanged { axis, expected, found });
            }
        }
        let axes = nodes.into_iter().zip(&self.axes);
        let axes = axes.map(|(nodes, old)| Axis { nodes, symmetry: old.symmetry }).collect();
        *self = Self::new(axes, values, self.method.clone(), self.extrapolation)?;
        Ok(())
    }

    /// The interpolant as it is computed: for each argument the cells and the weights there, in order of arguments.
    pub fn parts(&self) -> Vec<AxisParts> {
        self.pieces.iter().map(Piece::parts).collect()
    }

    /// The coefficients that the weights of [`Table::parts`] multiply, row-major, the last argument fastest.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients.values
    }

    /// How well the interpolant meets its values and keeps to their range.
    ///
    /// With one or two arguments each cell is sampled at 20 steps in each; with more the steps
    /// are fewer, down to 2, so that about two million samples suffice.
    pub fn fit_report(&self) -> FitReport {
        report::fit_report(self)
    }
}

fn check_nodes(axes: &[Axis]) -> Result<(), TableError> {
    if !(1..=MAX_ARGUMENTS).contains(&axes.len()) {
        return Err(TableError::Arguments { found: axes.len() });
    }
    axes.iter().enumerate().try_for_each(|(number, axis)| axis.check(number))
}

fn check_method(axes: &[Axis], method: &Method) -> Result<(), TableError> {
    match method {
        Method::Monotone if axes.len() > 2 => Err(TableError::MonotoneArguments { found: axes.len() }),
        Method::Bspline { order } | Method::Fit { order, .. } if !(2..=MAX_TABLE_ORDER).contains(order) => {
            Err(TableError::Order { order: *order })
        }
        Method::Fit { intervals, .. } if intervals.len() != axes.len() => {
            Err(TableError::WrongNumberOfIntervals { expected: axes.len(), found: intervals.len() })
        }
        Method::Fit { intervals, .. } => match intervals.iter().position(|count| *count == 0) {
            Some(axis) => Err(TableError::NoIntervals { axis }),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

fn check_values(axes: &[Axis], grid: &Grid) -> Result<(), TableError> {
    let expected = grid.shape.iter().fold(1, |product: usize, count| product.saturating_mul(*count));
    let found = grid.values.len();
    if expected != found {
        return Err(TableError::WrongNumberOfValues { expected, found });
    }
    if let Some(index) = grid.values.iter().position(|value| !value.is_finite()) {
        return Err(TableError::ValueNotFinite { index });
    }
    for (axis, _) in axes.iter().enumerate().filter(|(_, axis)| axis.symmetry == Symmetry::Periodic) {
        let (count, inner) = (grid.shape[axis], grid.shape[axis + 1..].iter().product::<usize>());
        for block in grid.values.chunks_exact(count * inner) {
            let pairs = block[..inner].iter().zip(&block[(count - 1) * inner..]);
            if let Some((first, last)) = pairs.into_iter().find(|(first, last)| first != last) {
                return Err(TableError::PeriodicNotClosed { axis, first: *first, last: *last });
            }
        }
    }
    Ok(())
}
