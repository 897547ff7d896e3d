//! The quadratic subproblem (docs/maths.md, section 6, equation (6.7)).
//!
//! ```text
//! minimise    d^T P d / 2 + g^T d + weight^T t
//! subject to  row_lower <= c + J d + t_lower - t_upper <= row_upper,   t >= 0
//!             lower     <= x + d                       <= upper
//! ```
//!
//! Without `t` this is the ordinary subproblem; with it, in *elastic* form, it always has a
//! solution. Every finite bound is one row of Clarabel's problem. Infinite bounds have
//! none. Each row is divided by the size of its gradient, anew for each subproblem.

use super::clarabel::{Quadratic, QuadraticSolver, Verdict};
use super::step::Step;
use crate::contract::Limits;
use crate::sparse::Csc;

/// Smallest size by which a row is divided, of rows whose slopes were 1 at the start: a row that hardly depends on anything
/// here must not outweigh the others. A fit to the specs of the repository: 1e-2 solves 139 of 179, 1e-8 138.
const SMALLEST_SLOPE: f64 = 1e-2;

/// Which kind of bound it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Equal,
    Lower,
    Upper,
}

/// One finite bound of a row or a variable.
#[derive(Clone, Copy, Debug)]
struct FiniteBound {
    /// Index of the row, or of the variable.
    index: usize,
    is_row: bool,
    kind: Kind,
}

/// Where an entry of the constraint matrix comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// An entry of the Jacobian.
    Jacobian { finite_bound: usize, at: usize, sign: f64 },
    /// A number that stays: the variable of a bound, or an elastic variable.
    Fixed(f64),
}

/// What a subproblem is made of, all scaled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model<'a> {
    pub(super) limits: &'a Limits,
    pub(super) x: &'a [f64],
    /// The rows whose linearisation at `d = 0` this is: `c`, or corrected ones.
    pub(super) rows: &'a [f64],
    pub(super) gradient: &'a [f64],
    pub(super) jacobian: &'a Csc,
    /// Positive semidefinite.
    pub(super) hessian: &'a Csc,
    /// Added to every diagonal entry of the Hessian.
    pub(super) proximal: f64,
    /// Penalty of violating a row; used in elastic form only.
    pub(super) penalty: f64,
    /// Whether half the square of each violation is penalised instead of its size.
    pub(super) squared: bool,
}

/// A subproblem whose pattern is fixed, its solver and its buffers.
pub(super) struct Subproblem {
    elastic: bool,
    equalities: usize,
    finite_bounds: Vec<FiniteBound>,
    /// For each elastic variable the number of its finite bound.
    stretched: Vec<usize>,
    p: Csc,
    q: Vec<f64>,
    a: Csc,
    b: Vec<f64>,
    sources: Vec<Source>,
    factor: Vec<f64>,
    slope: Vec<f64>,
    /// Diagonal entries of the Hessian for the elastic variables.
    square: Vec<f64>,
    solver: QuadraticSolver,
}

impl Subproblem {
    /// The subproblem of a program with these bounds and patterns.
    pub(super) fn new(limits: &Limits, jacobian: &Csc, hessian: &Csc, elastic: bool) -> Self {
        let (finite_bounds, equalities) = finite_bounds(limits);
        let stretched = if elastic { stretched(&finite_bounds) } else { Vec::new() };
        let (a, sources) = constraint_matrix(&finite_bounds, &stretched, jacobian);
        let n = jacobian.columns();
        let total = n + stretched.len();
        let mut places: Vec<(u32, u32)> = (n..total).map(|j| (j as u32, j as u32)).collect();
        for j in 0..n {
            places.extend(hessian.column(j).map(|(i, _)| (j as u32, i as u32)));
        }
        Self {
            elastic,
            equalities,
            p: Csc::with_pattern(total, total, places),
            q: vec![0.0; total],
            b: vec![0.0; a.rows],
            factor: vec![1.0; finite_bounds.len()],
            slope: vec![0.0; jacobian.rows],
            square: vec![0.0; stretched.len()],
            finite_bounds,
            stretched,
            a,
            sources,
            solver: QuadraticSolver::default(),
        }
    }

    /// Solves for `model`; when solved, writes step, multipliers and active bounds to `step`.
    pub(super) fn solve(&mut self, model: &Model<'_>, step: &mut Step) -> Verdict {
        let size = self.load(model);
        let problem = Quadratic { p: &self.p, q: &self.q, a: &self.a, b: &self.b, equalities: self.equalities };
        let verdict = self.solver.solve(&problem);
        if verdict == Verdict::Solved {
            self.unload(model, size, step);
        }
        verdict
    }

    /// Refreshes the data; gives the factor by which the objective was multiplied.
    fn load(&mut self, model: &Model<'_>) -> f64 {
        let n = model.x.len();
        self.slope.fill(SMALLEST_SLOPE);
        for (at, &i) in model.jacobian.row.iter().enumerate() {
            self.slope[i] = self.slope[i].max(model.jacobian.value[at].abs());
        }
        for (k, finite_bound) in self.finite_bounds.iter().enumerate() {
            self.factor[k] = if finite_bound.is_row { 1.0 / self.slope[finite_bound.index] } else { 1.0 };
            self.b[k] = self.factor[k] * distance(finite_bound, model);
        }
        for (value, source) in self.a.value.iter_mut().zip(&self.sources) {
            *value = match *source {
                Source::Jacobian { finite_bound, at, sign } => {
                    sign * self.factor[finite_bound] * model.jacobian.value[at]
                }
                Source::Fixed(number) => number,
            };
        }
        self.q[..n].copy_from_slice(model.gradient);
        for (k, &finite_bound) in self.stretched.iter().enumerate() {
            let penalty = model.penalty / self.factor[finite_bound];
            self.q[n + k] = if model.squared { 0.0 } else { penalty };
            self.square[k] = if model.squared { penalty / self.factor[finite_bound] } else { 0.0 };
        }
        let size = 1.0 / self.q.iter().fold(1.0_f64, |size, q| size.max(q.abs()));
        self.q.iter_mut().for_each(|q| *q *= size);
        let entries = model.hessian.value.len();
        for (value, h) in self.p.value[..entries].iter_mut().zip(&model.hessian.value) {
            *value = size * h;
        }
        for (k, square) in self.square.iter().enumerate() {
            self.p.value[entries + k] = size * square;
        }
        for j in 0..n {
            // The diagonal entry is the last one of a column of an upper triangle.
            self.p.value[self.p.start[j + 1] - 1] += size * model.proximal;
        }
        size
    }

    /// From Clarabel's answer to the step, in scaled variables and rows.
    fn unload(&self, model: &Model<'_>, size: f64, step: &mut Step) {
        step.clear();
        step.elastic = self.elastic;
        step.d.copy_from_slice(&self.solver.x[..model.x.len()]);
        for (k, finite_bound) in self.finite_bounds.iter().enumerate() {
            let z = self.solver.z[k] * self.factor[k] / size;
            let (multiplier, active) = match finite_bound.kind {
                Kind::Equal => (-z, 0),
                Kind::Lower => (z.max(0.0), if self.solver.z[k] / size > self.solver.s[k] { -1 } else { 0 }),
                Kind::Upper => (-z.max(0.0), if self.solver.z[k] / size > self.solver.s[k] { 1 } else { 0 }),
            };
            let (multipliers, actives) = if finite_bound.is_row {
                (&mut step.row_multipliers, &mut step.row_active)
            } else {
                (&mut step.bound_multipliers, &mut step.bound_active)
            };
            multipliers[finite_bound.index] += multiplier;
            if active != 0 || finite_bound.kind == Kind::Equal {
                actives[finite_bound.index] = if finite_bound.kind == Kind::Equal { 2 } else { active };
            }
        }
        for (j, d) in step.d.iter_mut().enumerate() {
            // An interior-point answer may miss a bound by its tolerance; ours are exact.
            *d = d.max(model.limits.lower[j] - model.x[j]).min(model.limits.upper[j] - model.x[j]);
        }
    }
}

/// The finite bounds, equalities first, and how many of those there are.
fn finite_bounds(limits: &Limits) -> (Vec<FiniteBound>, usize) {
    let (mut equal, mut other) = (Vec::new(), Vec::new());
    let bounds = [(true, &limits.row_lower, &limits.row_upper), (false, &limits.lower, &limits.upper)];
    for (is_row, lower, upper) in bounds {
        for (index, (low, high)) in lower.iter().zip(upper).enumerate() {
            if low == high {
                equal.push(FiniteBound { index, is_row, kind: Kind::Equal });
                continue;
            }
            if low.is_finite() {
                other.push(FiniteBound { index, is_row, kind: Kind::Lower });
            }
            if high.is_finite() {
                other.push(FiniteBound { index, is_row, kind: Kind::Upper });
            }
        }
    }
    let equalities = equal.len();
    equal.extend(other);
    (equal, equalities)
}

/// The finite bound of each elastic variable: an equality has two, for either direction.
fn stretched(finite_bounds: &[FiniteBound]) -> Vec<usize> {
    let mut stretched = Vec::new();
    for (k, finite_bound) in finite_bounds.iter().enumerate().filter(|(_, finite_bound)| finite_bound.is_row) {
        stretched.push(k);
        if finite_bound.kind == Kind::Equal {
            stretched.push(k);
        }
    }
    stretched
}

/// How far a bound is from being active: the right-hand side of `+-(J d) + s = b`.
fn distance(finite_bound: &FiniteBound, model: &Model<'_>) -> f64 {
    let FiniteBound { index, is_row, kind } = *finite_bound;
    let (value, lower, upper) = if is_row {
        (model.rows[index], model.limits.row_lower[index], model.limits.row_upper[index])
    } else {
        (model.x[index], model.limits.lower[index], model.limits.upper[index])
    };
    match kind {
        Kind::Equal | Kind::Upper => upper - value,
        Kind::Lower => value - lower,
    }
}

/// The pattern of the constraint matrix, and where each of its entries comes from.
fn constraint_matrix(finite_bounds: &[FiniteBound], stretched: &[usize], jacobian: &Csc) -> (Csc, Vec<Source>) {
    let n = jacobian.columns();
    let mut of_row = vec![Vec::new(); jacobian.rows];
    let mut entries: Vec<(u32, u32, Source)> = Vec::new();
    for (k, finite_bound) in finite_bounds.iter().enumerate() {
        let sign = if finite_bound.kind == Kind::Lower { -1.0 } else { 1.0 };
        if finite_bound.is_row {
            of_row[finite_bound.index].push((k, sign));
        } else {
            entries.push((finite_bound.index as u32, k as u32, Source::Fixed(sign)));
        }
    }
    for j in 0..n {
        for at in jacobian.start[j]..jacobian.start[j + 1] {
            for &(finite_bound, sign) in &of_row[jacobian.row[at]] {
                entries.push((j as u32, finite_bound as u32, Source::Jacobian { finite_bound, at, sign }));
            }
        }
    }
    let mut previous = None;
    for (k, &finite_bound) in stretched.iter().enumerate() {
        // The second elastic variable of an equality works the other way.
        let sign = if previous == Some(finite_bound) { 1.0 } else { -1.0 };
        previous = Some(finite_bound);
        let column = (n + k) as u32;
        entries.push((column, finite_bound as u32, Source::Fixed(sign)));
        entries.push((column, (finite_bounds.len() + k) as u32, Source::Fixed(-1.0)));
    }
    entries.sort_by_key(|&(column, row, _)| (column, row));
    let places = entries.iter().map(|&(column, row, _)| (column, row)).collect();
    let matrix = Csc::with_pattern(finite_bounds.len() + stretched.len(), n + stretched.len(), places);
    (matrix, entries.into_iter().map(|(_, _, source)| source).collect())
}
