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
mod error;
mod grid;
mod linear;
mod monotone;
mod piece;
mod report;
mod spline;

pub use axis::{Axis, Symmetry};
pub use error::TableError;
pub use report::FitReport;

use grid::Grid;
use piece::{Piece, Place, Weights};

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

/// An interpolation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    axes: Vec<Axis>,
    values: Grid,
    method: Method,
    extrapolation: Extrapolation,
    pieces: Vec<Piece>,
    strides: Vec<usize>,
    coefficients: Vec<f64>,
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
        let (pieces, grid) = match &method {
            Method::Monotone => monotone::monotone(&axes, &values),
            Method::Bspline { order } => spline::interpolate(&axes, &values, *order)?,
            Method::Fit { order, intervals } => spline::fit(&axes, &values, *order, intervals)?,
            Method::Linear => linear::linear(&axes, &values),
        };
        if !grid.values.iter().all(|c| c.is_finite()) || !pieces.iter().all(Piece::is_finite) {
            return Err(TableError::NotRepresentable);
        }
        let strides = (0..axes.len()).map(|axis| grid.shape[axis + 1..].iter().product()).collect();
        Ok(Self { axes, values, method, extrapolation, pieces, strides, coefficients: grid.values })
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

    /// A partial derivative of the interpolant: `derivative[i]` is the order in argument `i`.
    ///
    /// Derivatives beyond the interpolant's smoothness are those of its pieces, from the right
    /// at a node (at the last one from the left). Not a number if an argument is, or if `args`
    /// or `derivative` has not one entry for each argument.
    pub fn eval(&self, args: &[f64], derivative: &[u8]) -> f64 {
        self.at(args).derivative(derivative)
    }

    /// A place in the table, where derivatives are taken without searching again. Where an argument
    /// is not a number, or their number is wrong, no derivative is one.
    #[inline]
    pub fn at(&self, args: &[f64]) -> At<'_> {
        let count = self.pieces.len();
        let valid = args.len() == count && !args.iter().any(|x| x.is_nan());
        let mut places = [Place::default(); MAX_ARGUMENTS];
        if valid {
            for ((place, piece), x) in places.iter_mut().zip(&self.pieces).zip(args) {
                *place = piece.place(*x);
            }
        }
        At { table: self, places, valid }
    }

    /// Several partial derivatives at the same place: `orders[k][i]` times with respect to argument
    /// `i`. The bits are those of [`Table::eval`].
    #[inline]
    pub fn jet<const N: usize, const K: usize>(&self, args: &[f64; N], orders: &[[u8; N]; K]) -> [f64; K] {
        if N != self.pieces.len() || args.iter().any(|x| x.is_nan()) {
            return [f64::NAN; K];
        }
        let places = std::array::from_fn::<_, N, _>(|axis| self.pieces[axis].place(args[axis]));
        orders.map(|derivative| self.derivative(&places, &derivative))
    }

    /// A partial derivative at a place in `N` arguments.
    #[inline]
    fn derivative<const N: usize>(&self, places: &[Place; N], derivative: &[u8]) -> f64 {
        let mut weights = [[0.0; MAX_TABLE_ORDER]; N];
        let mut first = 0;
        for (axis, piece) in self.pieces.iter().enumerate() {
            let order = usize::from(derivative[axis]);
            if !piece.weights(&places[axis], order, self.extrapolation, &mut weights[axis]) {
                return 0.0;
            }
            first += places[axis].start * self.strides[axis];
        }
        self.contract(0, first, &weights)
    }

    /// The sum over the coefficients that act in arguments `axis ..`, the first of them at `first`.
    fn contract(&self, axis: usize, first: usize, weights: &[Weights]) -> f64 {
        let order = self.pieces[axis].order();
        let stride = self.strides[axis];
        if let ([four], 4) | ([_, four], 4) = (weights, order)
            && axis + 1 == self.pieces.len()
        {
            // The common order as a number, so that its loop is unrolled.
            return dot::<4>(four, &self.coefficients[first..]);
        }
        let weights_here = &weights[axis][..order];
        if axis + 1 == self.pieces.len() {
            let active = &self.coefficients[first..first + weights_here.len()];
            return weights_here.iter().zip(active).map(|(w, c)| w * c).sum();
        }
        let inner = weights_here.iter().enumerate();
        inner.map(|(j, w)| w * self.contract(axis + 1, first + j * stride, weights)).sum()
    }

    /// How well the interpolant meets its values and keeps to their range.
    ///
    /// With one or two arguments each cell is sampled at 20 steps in each; with more the steps
    /// are fewer, down to 2, so that about two million samples suffice.
    pub fn fit_report(&self) -> FitReport {
        report::fit_report(self)
    }
}

/// A place in a table.
#[derive(Clone, Debug)]
pub struct At<'a> {
    table: &'a Table,
    places: [Place; MAX_ARGUMENTS],
    valid: bool,
}

impl At<'_> {
    /// A partial derivative there, as [`Table::eval`] has it.
    #[inline]
    pub fn derivative(&self, derivative: &[u8]) -> f64 {
        if !self.valid || derivative.len() != self.table.pieces.len() {
            return f64::NAN;
        }
        // Room for eight arguments would cost as much as a table of one.
        match self.places {
            [a, ..] if derivative.len() == 1 => self.table.derivative(&[a], derivative),
            [a, b, ..] if derivative.len() == 2 => self.table.derivative(&[a, b], derivative),
            _ => self.table.derivative(&self.places, derivative),
        }
    }
}

/// The sum of the first `N` products.
#[inline]
fn dot<const N: usize>(weights: &Weights, coefficients: &[f64]) -> f64 {
    weights[..N].iter().zip(&coefficients[..N]).map(|(w, c)| w * c).sum()
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
