//! Interpolants of the problem's tables (docs/maths.md, section 7).
//!
//! Takes the tables of a [`Structure`](ntg_structure::Structure) with their present values; gives
//! what kernels evaluate. Finds: nodes that do not increase, ragged or non-finite values.

use super::error::SetupError;
use ntg_splines::{Axis, Extrapolation, Method, Symmetry, Table};
use ntg_structure::{TableAxis, TableExtrapolation, TableMethod, TableSymmetry};

/// One interpolant for each table, in order: what kernels evaluate.
///
/// # Errors
/// [`SetupError`] for nodes or values that a program has set and that make no table.
pub fn interpolants(tables: &[ntg_structure::Table]) -> Result<Vec<Table>, SetupError> {
    tables.iter().map(interpolant).collect()
}

fn interpolant(table: &ntg_structure::Table) -> Result<Table, SetupError> {
    let axes = table.axes.iter().map(axis).collect();
    let method = match &table.method {
        TableMethod::Monotone => Method::Monotone,
        TableMethod::Bspline { order } => Method::Bspline { order: *order },
        TableMethod::Fit { order, intervals } => Method::Fit { order: *order, intervals: intervals.clone() },
        TableMethod::Linear => Method::Linear,
    };
    let extrapolation = match table.extrapolation {
        TableExtrapolation::Clamp => Extrapolation::Clamp,
        TableExtrapolation::Linear => Extrapolation::Linear,
    };
    Table::new(axes, table.values.clone(), method, extrapolation)
        .map_err(|error| SetupError::Table { table: table.name.clone(), message: error.to_string() })
}

fn axis(axis: &TableAxis) -> Axis {
    let nodes = axis.nodes.clone();
    let symmetry = match axis.symmetry {
        TableSymmetry::Plain => Symmetry::Plain,
        TableSymmetry::Even => Symmetry::Even,
        TableSymmetry::Periodic => Symmetry::Periodic,
    };
    Axis { nodes, symmetry }
}
