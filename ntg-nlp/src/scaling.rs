//! Typical sizes of variables, rows and objective (docs/maths.md, section 5).
//!
//! Takes the sizes that the program gives ([`Limits`]) and the first derivatives at the start; gives
//! factors with which every variable, row and the objective become comparable to 1.

use crate::contract::{Block, Limits};
use crate::options::Scaling;
use crate::sparse::Csc;

/// Slopes of scaled rows and of the scaled objective larger than this are scaled down, as in
/// A. Wächter and L. T. Biegler, *Mathematical Programming* 106 (2006), section 3.8.
const LARGEST_SLOPE: f64 = 100.0;
/// An objective whose slopes are all smaller than this is scaled up, so that the tolerance on the
/// gradient still asks for something.
const SMALLEST_SLOPE: f64 = 1e-2;
/// No factor leaves the range from this to its reciprocal.
const SMALLEST_FACTOR: f64 = 1e-8;

/// Scaled variables, rows and objective are `x / variables`, `rows * c` and `objective * f`, entry by entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// A typical size of each variable.
    pub variables: Vec<f64>,
    /// The factor of each row.
    pub rows: Vec<f64>,
    /// The factor of the objective.
    pub objective: f64,
}

/// How steep a program is at its start, in scaled variables and the program's own rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slopes {
    /// The largest derivative of each row.
    pub rows: Vec<f64>,
    /// The largest first derivative of the objective.
    pub objective: f64,
    /// The largest second derivative of the objective by one variable.
    pub curvature: f64,
}

impl Scales {
    /// The scales of a program, equations (5.1) to (5.3): `gradient`, `jacobian` and the upper
    /// triangle of the objective's `curvature` are those at the start.
    pub fn new(limits: &Limits, scaling: Scaling, gradient: &[f64], jacobian: &Csc, curvature: &Csc) -> Self {
        let sizes = Self::sizes(limits);
        let mut rows = vec![0.0_f64; limits.row_lower.len()];
        for (j, size) in sizes.iter().enumerate() {
            for (i, a) in jacobian.column(j) {
                rows[i] = rows[i].max((a * size).abs());
            }
        }
        let objective = gradient.iter().zip(&sizes).map(|(g, size)| (g * size).abs()).fold(0.0, f64::max);
        let curvature = (0..sizes.len())
            .filter_map(|j| curvature.position(j, j).map(|at| curvature.value[at].abs() * sizes[j].powi(2)))
            .fold(0.0, f64::max);
        Self::from_slopes(limits, scaling, &Slopes { rows, objective, curvature })
    }

    /// Scaled bounds; they have no sizes of their own.
    pub fn limits(&self, limits: &Limits) -> Limits {
        let divide = |bounds: &[f64]| bounds.iter().zip(&self.variables).map(|(b, size)| b / size).collect();
        let multiply = |bounds: &[f64]| bounds.iter().zip(&self.rows).map(|(b, factor)| b * factor).collect();
        Limits {
            lower: divide(&limits.lower),
            upper: divide(&limits.upper),
            row_lower: multiply(&limits.row_lower),
            row_upper: multiply(&limits.row_upper),
            ..Limits::default()
        }
    }

    /// The typical size of each variable: 1 where none is known.
    pub fn sizes(limits: &Limits) -> Vec<f64> {
        limits.scale.iter().map(|&size| positive(size)).collect()
    }

    /// The scales of a program whose slopes at the start are known.
    pub fn from_slopes(limits: &Limits, scaling: Scaling, slopes: &Slopes) -> Self {
        let variables = Self::sizes(limits);
        if scaling == Scaling::Off {
            return Self { variables, rows: vec![1.0; limits.row_lower.len()], objective: 1.0 };
        }
        let mut rows: Vec<f64> = limits.row_scale.iter().map(|&size| 1.0 / positive(size)).collect();
        for (factor, slope) in rows.iter_mut().zip(&slopes.rows) {
            let slope = *factor * slope;
            if slope > LARGEST_SLOPE {
                *factor *= (LARGEST_SLOPE / slope).max(SMALLEST_FACTOR);
            }
        }
        Self { variables, rows, objective: objective_factor(slopes.objective.max(slopes.curvature)) }
    }
}

/// A size that may divide.
fn positive(size: f64) -> f64 {
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}

/// Brings the largest slope of the objective into the range from 0.01 to 100.
fn objective_factor(slope: f64) -> f64 {
    if slope > LARGEST_SLOPE {
        (LARGEST_SLOPE / slope).max(SMALLEST_FACTOR)
    } else if slope > 0.0 && slope < SMALLEST_SLOPE {
        (SMALLEST_SLOPE / slope).min(1.0 / SMALLEST_FACTOR)
    } else {
        1.0
    }
}

/// A typical size of each slot of each block: how far one variable of a size can move it.
pub(crate) fn slot_sizes(blocks: &[Block], variables: &[f64]) -> Vec<Vec<f64>> {
    blocks.iter().map(|block| sizes_of(block, variables)).collect()
}

fn sizes_of(block: &Block, variables: &[f64]) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; block.slots];
    for e in 0..block.elements {
        let (map, width) = (block.map(e), block.variables(e).len());
        for (slot, size) in sizes.iter_mut().enumerate() {
            for (local, &variable) in block.variables(e).iter().enumerate() {
                *size = size.max((map[slot * width + local] * variables[variable as usize]).abs());
            }
        }
    }
    sizes.iter().map(|&size| if size > 0.0 { size } else { 1.0 }).collect()
}
