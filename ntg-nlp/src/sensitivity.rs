//! How a solution moves when its bounds move (docs/maths.md, section 16.2).
//!
//! ```text
//! H dx - J_A^T dy = g       A: the active rows and bounds
//! J_A dx          = r       r: how fast the active bounds move
//! ```
//!
//! Takes a program, a solution and its multipliers; gives the derivatives of the solution and of its multipliers, to
//! first order. A parameter of a program is a variable whose two bounds are its value: to move it is to move them.
//! Second derivatives are exact, and convexified nowhere; the factors of the condensed matrix of the interior-point
//! method precondition the system, and refinement by its own residuals removes what they leave.
//!
//! References: A. V. Fiacco, *Introduction to Sensitivity and Stability Analysis in Nonlinear Programming* (1983),
//! theorem 3.2.2; H. Pirnay, R. López-Negrete, L. T. Biegler, *Math. Prog. Comp.* 4 (2012), for parameters as variables.

use crate::contract::{Evaluation, Limits, Nlp, NotFinite};
use crate::kkt::{Curvature, System, Weights};
use crate::options::Scaling;
use crate::outcome::Multipliers;
use crate::scaling::Scales;
use crate::sparse::Assembly;

/// The proximal term of active rows and bounds, whose scaled slope is 1; refinement removes it.
const PROXIMAL: f64 = 1e-10;
/// The weight of a row that is not active: none, but a number that may divide.
const WEIGHTLESS: f64 = 1e-30;
/// Shifts of the diagonal where the matrix is not that of a strict minimum: the first, their factor, the largest.
const FIRST_SHIFT: f64 = 1e-8;
const SHIFT_FACTOR: f64 = 100.0;
const LARGEST_SHIFT: f64 = 1.0;
/// Refinements at most. A law of two or three is usual; a shift takes more.
const REFINEMENTS: usize = 40;
/// What is left of a residual, relative to the terms that it is the sum of: where refinement ends, and what is allowed.
const REFINED: f64 = 1e-13;
const ALLOWED: f64 = 1e-6;
/// A bound is undecided where the smaller one of its scaled distance and its scaled multiplier is more than this
/// fraction of the larger one.
const UNDECIDED: f64 = 0.1;

/// Whether a row or a variable is at a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Between its bounds.
    Inactive,
    /// At a bound that holds it, or an equality.
    Active,
    /// At a bound that hardly holds it: distance and multiplier are both nearly 0. What is active may change with the
    /// smallest step, and derivatives are one-sided.
    Weak {
        /// Whether it is taken to be active.
        active: bool,
    },
}

impl Activity {
    /// Whether it is taken to stay at its bound.
    pub fn is_active(self) -> bool {
        matches!(self, Self::Active | Self::Weak { active: true })
    }
}

/// Why there are no derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unavailable {
    /// A number of the program is not finite at the solution.
    NotFinite(NotFinite),
    /// The matrix cannot be given the inertia of a minimum.
    Singular,
    /// The active bounds contradict each other as soon as they move, or the solution is not unique: what is left of the
    /// residual, relative to its terms.
    Unresolved(f64),
}

impl std::fmt::Display for Unavailable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite(what) => write!(f, "{what}"),
            Self::Singular => write!(f, "the second-order conditions of a minimum do not hold there"),
            Self::Unresolved(left) => {
                write!(f, "the active constraints contradict each other as soon as they move (residual {left:.1e})")
            }
        }
    }
}

impl std::error::Error for Unavailable {}

/// What moves a solution: how fast the bounds move.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// For each row the derivative of its active bound.
    pub rows: &'a [f64],
    /// For each variable the derivative of its active bound.
    pub variables: &'a [f64],
}

/// Derivatives of a solution, in the program's own units.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Of the variables.
    pub x: Vec<f64>,
    /// Of the rows' multipliers, in the sense of [`Outcome::row_multipliers`](crate::Outcome::row_multipliers).
    pub rows: Vec<f64>,
    /// Of the multipliers of the variables' bounds.
    pub variables: Vec<f64>,
}

/// The factorised system of one solution. `W` is the program's workspace.
pub struct Sensitivity<W> {
    system: System<W>,
    assembly: Assembly,
    activity: Vec<Activity>,
    /// The functions that are active: rows, then variables, as [`System`] numbers them.
    active: Vec<usize>,
    shift: f64,
    buffers: Buffers,
}

/// Vectors by variable (with the padding entry), by function, and by border row.
#[derive(Clone, Debug, Default)]
struct Buffers {
    by_function: Vec<f64>,
    border: Vec<f64>,
    unscaled: Vec<f64>,
    product: Vec<f64>,
    rows: Vec<f64>,
}

/// A scaled step, or a scaled residual: by variable with the padding entry, and by function.
#[derive(Clone, Debug)]
struct Scaled {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl<W> Sensitivity<W> {
    /// Evaluates and factorises a program at a solution.
    ///
    /// # Errors
    /// [`Unavailable::NotFinite`] and [`Unavailable::Singular`].
    pub fn new<N: Nlp<Workspace = W>>(nlp: &N, x: &[f64], multipliers: Multipliers<'_>) -> Result<Self, Unavailable> {
        Self::again(None, nlp, x, multipliers)
    }

    /// As [`Sensitivity::new`]. Where the program has the patterns of the one that was analysed `earlier`, that analysis is
    /// used again, and gives the same bits.
    ///
    /// # Errors
    /// As [`Sensitivity::new`].
    pub fn again<N: Nlp<Workspace = W>>(
        earlier: Option<Self>,
        nlp: &N,
        x: &[f64],
        multipliers: Multipliers<'_>,
    ) -> Result<Self, Unavailable> {
        let (n, m) = (nlp.variables(), nlp.rows());
        let (mut system, assembly) = match earlier {
            Some(Self { system, assembly, .. }) if system.fits(nlp) => (system.refit(nlp), assembly),
            _ => (System::new(nlp), Assembly::new(n, m, nlp.blocks())),
        };
        let mut scaled: Vec<f64> = x.iter().zip(&system.scales.variables).map(|(x, size)| x / size).collect();
        scaled.push(0.0);
        system.choose_scales(nlp, &scaled, Scaling::Automatic).map_err(Unavailable::NotFinite)?;
        let weights = scaled_multipliers(&system, multipliers);
        let mut values = vec![0.0; system.functions()];
        system.derivatives(nlp, &scaled, &weights, &mut values).map_err(Unavailable::NotFinite)?;
        let activity = activity(nlp.limits(), &system.scales, system.latest(), (x, multipliers));
        let first = system.first_variable();
        let functions = (0..m).chain(first..first + n);
        let active = functions.zip(&activity).filter(|(_, is)| is.is_active()).map(|(function, _)| function).collect();
        let buffers = Buffers {
            by_function: vec![0.0; system.functions()],
            border: vec![0.0; system.border_rows().len()],
            unscaled: vec![0.0; n],
            product: vec![0.0; n],
            rows: vec![0.0; m],
        };
        let mut found = Self { system, assembly, activity, active, shift: 0.0, buffers };
        found.assembly.first(nlp.blocks(), found.system.latest());
        found.assembly.hessian(nlp.blocks(), found.system.latest(), |_, _, _| {});
        found.factorise()?;
        Ok(found)
    }

    /// Whether each row is at a bound.
    pub fn rows(&self) -> &[Activity] {
        &self.activity[..self.buffers.rows.len()]
    }

    /// Whether each variable is at a bound.
    pub fn variables(&self) -> &[Activity] {
        &self.activity[self.buffers.rows.len()..]
    }

    /// Whether the solution is a strict minimum: the second derivatives of the Lagrangian are positive along every
    /// direction that the active bounds leave. Elsewhere the solution moves least among all that solve the system.
    pub fn is_strict(&self) -> bool {
        self.shift == 0.0
    }

    /// The gradient of the objective without that of the rows times these multipliers: the multiplier of every variable
    /// that its bounds hold.
    pub fn lagrangian(&self, row_multipliers: &[f64]) -> Vec<f64> {
        let mut gradient = self.assembly.gradient.clone();
        self.assembly.jacobian.add_transposed_product(-1.0, row_multipliers, &mut gradient);
        gradient
    }

    /// The derivatives of the solution where bounds move so fast. Bounds that are not active count for nothing.
    ///
    /// # Errors
    /// [`Unavailable::Unresolved`].
    pub fn response(&mut self, moving: Moving<'_>) -> Result<Response, Unavailable> {
        let Scales { variables, rows, .. } = &self.system.scales;
        let mut by_function = vec![0.0; self.system.functions()];
        for ((to, rate), factor) in by_function.iter_mut().zip(moving.rows).zip(rows) {
            *to = rate * factor;
        }
        let first = self.system.first_variable();
        for ((to, rate), size) in by_function[first..].iter_mut().zip(moving.variables).zip(variables) {
            *to = rate / size;
        }
        self.solve(Scaled { x: vec![0.0; variables.len() + 1], y: by_function })
    }

    /// The *adjoint* of a linear function of the variables, with these coefficients: its derivative by the active bound
    /// of row `i` is `-rows[i]`, by that of variable `j` it is `-variables[j]`. One solve serves all parameters.
    ///
    /// # Errors
    /// [`Unavailable::Unresolved`].
    pub fn adjoint(&mut self, coefficients: &[f64]) -> Result<Response, Unavailable> {
        let Scales { variables, objective, .. } = &self.system.scales;
        let scaled = coefficients.iter().zip(variables).map(|(g, size)| g * size * objective);
        let x = scaled.chain([0.0]).collect();
        self.solve(Scaled { x, y: vec![0.0; self.system.functions()] })
    }

    /// The matrix of a strict minimum; elsewhere with the smallest shift that gives it one.
    fn factorise(&mut self) -> Result<(), Unavailable> {
        let mut sigma = vec![0.0; self.system.functions()];
        self.active.iter().for_each(|&function| sigma[function] = 1.0 / PROXIMAL);
        self.system.assemble(Weights { sigma: &sigma, curvature: Curvature::Exact });
        for border in 0..self.system.border_rows().len() {
            let weight = sigma[self.system.border_rows()[border]];
            self.system.set_border_diagonal(border, 1.0 / weight.max(WEIGHTLESS));
        }
        let shifts = std::iter::successors(Some(FIRST_SHIFT), |shift| Some(shift * SHIFT_FACTOR));
        for shift in [0.0].into_iter().chain(shifts.take_while(|shift| *shift <= LARGEST_SHIFT)) {
            if self.system.factorise(0.0, shift) {
                self.shift = shift;
                return Ok(());
            }
        }
        Err(Unavailable::Singular)
    }

    /// Solves the system for a scaled right-hand side, by refinement of what the factors give.
    fn solve(&mut self, right: Scaled) -> Result<Response, Unavailable> {
        let mut step = Scaled { x: vec![0.0; right.x.len()], y: vec![0.0; right.y.len()] };
        let (mut left, mut before, mut best) = (f64::INFINITY, f64::INFINITY, step.clone());
        for _ in 0..REFINEMENTS {
            let (residual, relative) = self.residual(&right, &step);
            if relative < left {
                (left, best) = (relative, step.clone());
            }
            let is_stuck = left <= ALLOWED && relative > 0.5 * before;
            if !relative.is_finite() || relative <= REFINED || is_stuck {
                break;
            }
            before = relative;
            self.improve(&residual, &mut step);
        }
        if left <= ALLOWED { Ok(self.unscaled(&best)) } else { Err(Unavailable::Unresolved(left)) }
    }

    /// The residual of the system without proximal terms and shift, and its size relative to its terms.
    fn residual(&mut self, right: &Scaled, step: &Scaled) -> (Scaled, f64) {
        let Self { system, assembly, active, buffers, .. } = self;
        let Scales { variables, rows, .. } = &system.scales;
        let first = system.first_variable();
        for ((to, x), size) in buffers.unscaled.iter_mut().zip(&step.x).zip(variables) {
            *to = x * size;
        }
        // The second derivatives are those of the scaled objective.
        buffers.product.fill(0.0);
        assembly.hessian.add_symmetric_product(1.0, &buffers.unscaled, &mut buffers.product);
        let mut left = Scaled { x: right.x.clone(), y: vec![0.0; right.y.len()] };
        let mut size = right.x.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
        for ((left, product), variable) in left.x.iter_mut().zip(&buffers.product).zip(variables) {
            let curvature = product * variable;
            *left -= curvature;
            size = size.max(curvature.abs());
        }
        buffers.rows.fill(0.0);
        active.iter().filter(|&&f| f < rows.len()).for_each(|&f| buffers.rows[f] = step.y[f] * rows[f]);
        buffers.product.fill(0.0);
        assembly.jacobian.add_transposed_product(1.0, &buffers.rows, &mut buffers.product);
        let bounds = &step.y[first..];
        for (((left, product), variable), bound) in left.x.iter_mut().zip(&buffers.product).zip(variables).zip(bounds) {
            let pull = product * variable + bound;
            *left += pull;
            size = size.max(pull.abs());
        }
        buffers.rows.fill(0.0);
        assembly.jacobian.add_product(1.0, &buffers.unscaled, &mut buffers.rows);
        // Where no bound moves, what changes in an active row is nothing: the measure is what it is the sum of, and
        // scaled slopes are about 1.
        let is_still = right.y.iter().all(|rate| *rate == 0.0);
        let mut moved = if is_still { step.x.iter().fold(0.0_f64, |most, x| most.max(x.abs())) } else { 0.0 };
        for &f in active.iter() {
            let change = if f < rows.len() { buffers.rows[f] * rows[f] } else { step.x[f - first] };
            left.y[f] = right.y[f] - change;
            moved = moved.max(right.y[f].abs()).max(change.abs());
        }
        let relative = |of: &[f64], size: f64| {
            let largest = of.iter().fold(0.0_f64, |most, r| if r.is_nan() { f64::NAN } else { most.max(r.abs()) });
            if largest == 0.0 { 0.0 } else { largest / size }
        };
        // Scaled curvatures are about 1: where all terms vanish, what moves is the measure.
        let worst = relative(&left.x, size.max(moved)).max(relative(&left.y, moved));
        (left, worst)
    }

    /// Adds to a step what the factors make of its residual.
    fn improve(&mut self, residual: &Scaled, step: &mut Scaled) {
        let Self { system, active, buffers, .. } = self;
        let n = residual.x.len() - 1;
        buffers.by_function.fill(0.0);
        active.iter().for_each(|&f| buffers.by_function[f] = residual.y[f] / PROXIMAL);
        for (border, &row) in system.border_rows().iter().enumerate() {
            buffers.border[border] = residual.y[row];
            buffers.by_function[row] = 0.0;
        }
        let mut x = vec![0.0; n + 1];
        system.transposed_product(&buffers.by_function, &mut x);
        x.iter_mut().zip(&residual.x).for_each(|(x, g)| *x += g);
        system.solve(&mut x[..n], &mut buffers.border);
        x[n] = 0.0;
        system.product(&x, &mut buffers.by_function);
        for &f in active.iter() {
            step.y[f] += (residual.y[f] - buffers.by_function[f]) / PROXIMAL;
        }
        step.x.iter_mut().zip(&x).for_each(|(step, more)| *step += more);
    }

    fn unscaled(&self, step: &Scaled) -> Response {
        let Scales { variables, rows, objective } = &self.system.scales;
        let bounds = step.y[self.system.first_variable()..].iter().zip(variables);
        Response {
            x: step.x.iter().zip(variables).map(|(x, size)| x * size).collect(),
            rows: step.y.iter().zip(rows).map(|(y, factor)| y * factor / objective).collect(),
            variables: bounds.map(|(y, size)| y / (size * objective)).collect(),
        }
    }
}

/// The multipliers of all functions of the scaled program; that of the objective is -1.
fn scaled_multipliers<W>(system: &System<W>, multipliers: Multipliers<'_>) -> Vec<f64> {
    let Scales { variables, rows, objective } = &system.scales;
    let mut all = vec![0.0; system.functions()];
    for ((to, y), factor) in all.iter_mut().zip(multipliers.rows).zip(rows) {
        *to = y * objective / factor;
    }
    all[system.objective()] = -1.0;
    for ((to, y), size) in all[system.first_variable()..].iter_mut().zip(multipliers.bounds).zip(variables) {
        *to = y * objective * size;
    }
    all
}

/// Whether rows, then variables, are at a bound.
fn activity(
    limits: &Limits,
    scales: &Scales,
    at: &Evaluation,
    (x, multipliers): (&[f64], Multipliers<'_>),
) -> Vec<Activity> {
    let rows = (0..at.rows.len()).map(|i| {
        let bounds = (limits.row_lower[i], limits.row_upper[i]);
        let (multiplier, factor) = (multipliers.rows[i], scales.rows[i]);
        of_bounds(bounds, at.rows[i], multiplier, (factor, scales.objective / factor))
    });
    let variables = (0..x.len()).map(|j| {
        let bounds = (limits.lower[j], limits.upper[j]);
        let (multiplier, size) = (multipliers.bounds[j], scales.variables[j]);
        of_bounds(bounds, x[j], multiplier, (1.0 / size, scales.objective * size))
    });
    rows.chain(variables).collect()
}

/// Whether a value is at one of its bounds; `factors` scale distances and multipliers.
fn of_bounds((lower, upper): (f64, f64), value: f64, multiplier: f64, factors: (f64, f64)) -> Activity {
    if lower == upper {
        return Activity::Active;
    }
    let distance = match multiplier {
        y if y > 0.0 => value - lower,
        y if y < 0.0 => upper - value,
        _ => (value - lower).min(upper - value),
    };
    let (distance, multiplier) = (distance.max(0.0) * factors.0, multiplier.abs() * factors.1);
    let active = multiplier > distance;
    let (small, large) = if active { (distance, multiplier) } else { (multiplier, distance) };
    match small > UNDECIDED * large || large == 0.0 {
        true => Activity::Weak { active },
        false if active => Activity::Active,
        false => Activity::Inactive,
    }
}
