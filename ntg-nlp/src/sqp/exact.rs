//! Newton's step on the active bounds, with the exact Hessian (docs/maths.md, section 6, (6.12)).
//!
//! ```text
//! [ H   A^T ] [  d ]   [ -g ]        A  the active rows, divided by the size of their gradients
//! [ A  -dI  ] [ -y ] = [  r ]        r  what they lack to their bounds
//! ```
//!
//! The factorisation tells whether this is a minimum: exactly as many positive pivots as variables
//! mean that `H + A^T A / d` is positive definite, so `H` is positive definite along the active
//! rows. Then `d` goes to zero by refinement of the solution, which also copes with active rows that
//! depend on each other. Active bounds whose multipliers have the wrong sign are dropped, bounds that
//! the step would cross are added, a few times. What remains solves the quadratic subproblem with
//! the exact Hessian; near a solution, these are Newton steps and converge quadratically.

use super::clarabel::Factors;
use super::step::Step;
use super::subproblem::Model;
use crate::sparse::Csc;

/// The `d` of the system: small beside 1, the size of rows; large enough for dependent rows.
const REGULARISATION: f64 = 1e-8;
/// Refinements at most; independent rows need 2 or 3.
const REFINEMENTS: usize = 12;
/// Relative residual at which refinement ends.
const REFINED: f64 = 1e-14;
/// Relative residual above which the step is not believed.
const BELIEVED: f64 = 1e-9;
/// Changes of the active set at most.
const CHANGES: usize = 8;
/// How far a bound may be missed, or a multiplier have the wrong sign, in scaled units.
const SLACK: f64 = 1e-10;

/// Where the entries of the system come from, and its factors.
pub(super) struct ExactStep {
    n: usize,
    m: usize,
    /// Upper triangle: variables first, then rows.
    system: Csc,
    /// Position in `system` of each entry of the Hessian and of the Jacobian.
    hessian_at: Vec<usize>,
    jacobian_at: Vec<usize>,
    factors: Factors,
    factor: Vec<f64>,
    residual: Vec<f64>,
    /// Linearised rows at the end of the step.
    rows: Vec<f64>,
}

impl ExactStep {
    /// For these patterns.
    pub(super) fn new(jacobian: &Csc, hessian: &Csc) -> Self {
        let (n, m) = (jacobian.columns(), jacobian.rows);
        let mut places: Vec<(u32, u32)> = (0..m).map(|i| ((n + i) as u32, (n + i) as u32)).collect();
        for j in 0..n {
            places.extend(hessian.column(j).map(|(i, _)| (j as u32, i as u32)));
            places.extend(jacobian.column(j).map(|(i, _)| ((n + i) as u32, j as u32)));
        }
        let system = Csc::with_pattern(n + m, n + m, places);
        let find = |row, column| system.position(row, column).expect("the pattern was built from these places");
        let hessian_at = (0..n).flat_map(|j| hessian.column(j).map(move |(i, _)| (i, j))).map(|(i, j)| find(i, j));
        let jacobian_at = (0..n).flat_map(|j| jacobian.column(j).map(move |(i, _)| (j, n + i)));
        Self {
            n,
            m,
            hessian_at: hessian_at.collect(),
            jacobian_at: jacobian_at.map(|(i, j)| find(i, j)).collect(),
            factors: Factors::new(&system),
            system,
            factor: vec![1.0; m],
            residual: vec![0.0; n + m],
            rows: vec![0.0; m],
        }
    }

    /// Replaces `step`, whose active bounds are the first guess, by the solution of the subproblem
    /// with the Hessian of `model`; false if none was found, and then `step` is spoilt.
    pub(super) fn solve(&mut self, model: &Model<'_>, step: &mut Step) -> bool {
        step.exact = true;
        step.elastic = false;
        for _ in 0..CHANGES {
            if !self.factorise(model, step) || !self.refine(model, step) {
                return false;
            }
            if !self.change_active(model, step) {
                return true;
            }
        }
        false
    }

    /// Solves again with the same active bounds and factors, for other values of the rows.
    /// The multipliers and active bounds of `step` stay; false if that failed.
    pub(super) fn correct(&mut self, model: &Model<'_>, step: &mut Step) -> bool {
        self.refine(model, step)
    }

    /// Builds and factorises the system; whether its inertia is that of a minimum.
    fn factorise(&mut self, model: &Model<'_>, step: &Step) -> bool {
        let free = |j: usize| step.bound_active[j] == 0;
        self.factor.fill(0.0);
        for (at, &i) in model.jacobian.row.iter().enumerate() {
            self.factor[i] = self.factor[i].max(model.jacobian.value[at].abs());
        }
        self.factor.iter_mut().for_each(|f| *f = if *f > 0.0 { 1.0 / *f } else { 1.0 });
        for j in 0..self.n {
            for at in model.hessian.start[j]..model.hessian.start[j + 1] {
                let i = model.hessian.row[at];
                self.system.value[self.hessian_at[at]] = match (free(i) && free(j), i == j) {
                    (true, false) => model.hessian.value[at],
                    (true, true) => model.hessian.value[at] + model.proximal,
                    (false, same) => f64::from(u8::from(same)),
                };
            }
            for at in model.jacobian.start[j]..model.jacobian.start[j + 1] {
                let i = model.jacobian.row[at];
                let active = free(j) && step.row_active[i] != 0;
                self.system.value[self.jacobian_at[at]] =
                    if active { self.factor[i] * model.jacobian.value[at] } else { 0.0 };
            }
        }
        for i in 0..self.m {
            let last = self.system.start[self.n + i + 1] - 1;
            self.system.value[last] = if step.row_active[i] != 0 { -REGULARISATION } else { -1.0 };
        }
        self.factors.factorise(&self.system) == Some(self.n)
    }

    /// Solves by repeated refinement of step and multipliers.
    fn refine(&mut self, model: &Model<'_>, step: &mut Step) -> bool {
        let n = self.n;
        for j in 0..n {
            match bound(model.limits.lower[j], model.limits.upper[j], step.bound_active[j]) {
                Some(bound) => step.d[j] = bound - model.x[j],
                None => step.bound_multipliers[j] = 0.0,
            }
        }
        for i in 0..self.m {
            if step.row_active[i] == 0 {
                step.row_multipliers[i] = 0.0;
            }
        }
        let mut before = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            let size = self.compute_residual(model, step);
            if !size.is_finite() {
                return false;
            }
            if size <= REFINED || size > 0.5 * before {
                return size <= BELIEVED;
            }
            before = size;
            self.factors.solve(&mut self.residual);
            for j in (0..n).filter(|&j| step.bound_active[j] == 0) {
                step.d[j] += self.residual[j];
            }
            for i in (0..self.m).filter(|&i| step.row_active[i] != 0) {
                step.row_multipliers[i] -= self.factor[i] * self.residual[n + i];
            }
        }
        self.compute_residual(model, step) <= BELIEVED
    }

    /// Residual of the system without regularisation, multipliers of active bounds, and linearised
    /// rows; gives the residual's relative size.
    fn compute_residual(&mut self, model: &Model<'_>, step: &mut Step) -> f64 {
        let (dual, primal) = self.residual.split_at_mut(self.n);
        for (out, g) in dual.iter_mut().zip(model.gradient) {
            *out = -g;
        }
        model.hessian.add_symmetric_product(-1.0, &step.d, dual);
        model.jacobian.add_transposed_product(1.0, &step.row_multipliers, dual);
        self.rows.copy_from_slice(model.rows);
        model.jacobian.add_product(1.0, &step.d, &mut self.rows);
        let mut size = 0.0_f64;
        for (j, out) in dual.iter_mut().enumerate() {
            *out -= model.proximal * step.d[j];
            if step.bound_active[j] != 0 {
                step.bound_multipliers[j] = -*out;
                *out = 0.0;
            }
            size = size.max(out.abs());
        }
        let largest = |v: &[f64]| v.iter().fold(1.0_f64, |size, entry| size.max(entry.abs()));
        size /= largest(model.gradient).max(largest(&step.row_multipliers));
        for (i, out) in primal.iter_mut().enumerate() {
            let bound = bound(model.limits.row_lower[i], model.limits.row_upper[i], step.row_active[i]);
            *out = bound.map_or(0.0, |bound| self.factor[i] * (bound - self.rows[i]));
            size = size.max(out.abs());
        }
        let sum: f64 = self.residual.iter().sum();
        if sum.is_finite() { size } else { f64::INFINITY }
    }

    /// Drops bounds with multipliers of the wrong sign, adds bounds that are crossed; whether
    /// anything changed.
    fn change_active(&self, model: &Model<'_>, step: &mut Step) -> bool {
        let mut changed = false;
        let limits = model.limits;
        for i in 0..self.m {
            let unit = 1.0 / self.factor[i];
            let (value, lower, upper) = (self.rows[i], limits.row_lower[i], limits.row_upper[i]);
            let active = &mut step.row_active[i];
            changed |= update(active, step.row_multipliers[i] * unit, value * self.factor[i], [lower, upper], unit);
        }
        for j in 0..self.n {
            let value = model.x[j] + step.d[j];
            let active = &mut step.bound_active[j];
            changed |= update(active, step.bound_multipliers[j], value, [limits.lower[j], limits.upper[j]], 1.0);
        }
        changed
    }
}

/// The bound that is active.
fn bound(lower: f64, upper: f64, active: i8) -> Option<f64> {
    match active {
        0 => None,
        -1 => Some(lower),
        _ => Some(upper),
    }
}

/// New activity of one bound pair; `bounds` are divided by `unit`, the others are already.
fn update(active: &mut i8, multiplier: f64, value: f64, bounds: [f64; 2], unit: f64) -> bool {
    let [lower, upper] = bounds.map(|bound| bound / unit);
    let next = match *active {
        2 => 2,
        -1 if multiplier < -SLACK => 0,
        1 if multiplier > SLACK => 0,
        0 if value < lower - SLACK => -1,
        0 if value > upper + SLACK => 1,
        same => same,
    };
    let changed = next != *active;
    *active = next;
    changed
}
