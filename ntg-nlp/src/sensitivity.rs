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
use crate::kkt::{COLUMNS, Columns, Curvature, Held, Refinement, System, Weights};
use crate::outcome::Multipliers;
use crate::scaling::Scales;

/// The weight of the squares of active rows and bounds, whose scaled slope is 1; refinement removes what it leaves.
const PENALTY: f64 = 1e10;
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

/// What moves a solution: how fast the bounds move that do, each with its number.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// Of rows the derivative of the active bound.
    pub rows: &'a [(usize, f64)],
    /// Of variables the derivative of the active bound.
    pub variables: &'a [(usize, f64)],
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
    activity: Vec<Activity>,
    /// How each function enters, as [`System`] numbers them.
    held: Vec<Held>,
    shift: f64,
    work: Work,
}

/// What is solved for several right-hand sides at a time: vectors by variable, with the padding entry, and by function.
#[derive(Clone, Debug, Default)]
struct Work {
    x: Vec<Columns>,
    y: Vec<Columns>,
    /// What is left of both equations.
    left: Vec<Columns>,
    rows: Vec<Columns>,
    /// The latest step, and what it changes.
    step: Vec<Columns>,
    bend: Vec<Columns>,
    pull: Vec<Columns>,
    /// Multipliers of border rows, by border row and by function.
    border: Vec<Columns>,
    multipliers: Vec<Columns>,
}

impl<W> Sensitivity<W> {
    /// Evaluates and factorises a program at a solution.
    ///
    /// # Errors
    /// [`Unavailable::NotFinite`] and [`Unavailable::Singular`].
    pub fn new<N: Nlp<Workspace = W>>(nlp: &N, x: &[f64], multipliers: Multipliers<'_>) -> Result<Self, Unavailable> {
        Self::again((None, false), nlp, x, multipliers)
    }

    /// As [`Sensitivity::new`]. Where the program has the patterns of the one that was analysed `earlier`, that analysis is
    /// used again, and gives the same bits. The program `is_unchanged` where only its limits may differ.
    ///
    /// # Errors
    /// As [`Sensitivity::new`].
    pub fn again<N: Nlp<Workspace = W>>(
        (earlier, is_unchanged): (Option<Self>, bool),
        nlp: &N,
        x: &[f64],
        multipliers: Multipliers<'_>,
    ) -> Result<Self, Unavailable> {
        let (limits, m) = (nlp.limits(), nlp.rows());
        let held = limits.lower.iter().zip(&limits.upper).map(|(lower, upper)| lower == upper).collect();
        let (earlier, work) = earlier.map(|earlier| (earlier.system, earlier.work)).unzip();
        let mut system = System::for_program(earlier, nlp, is_unchanged, held);
        system.at_solution(nlp, x, multipliers.rows).map_err(Unavailable::NotFinite)?;
        let activity = activity(limits, &system.scales, system.latest(), (x, multipliers));
        let mut held = vec![Held::No; system.functions()];
        let first = system.first_variable();
        for (function, _) in (0..m).chain(first..).zip(&activity).filter(|(_, is)| is.is_active()) {
            held[function] = Held::Condensed;
        }
        for &row in system.border_rows().iter().filter(|&&row| activity[row].is_active()) {
            held[row] = Held::Border;
        }
        let mut found = Self { system, activity, held, shift: 0.0, work: work.unwrap_or_default() };
        found.factorise()?;
        Ok(found)
    }

    /// Whether each row is at a bound.
    pub fn rows(&self) -> &[Activity] {
        &self.activity[..self.system.objective()]
    }

    /// Whether each variable is at a bound.
    pub fn variables(&self) -> &[Activity] {
        &self.activity[self.system.objective()..]
    }

    /// Whether the solution is a strict minimum: the second derivatives of the Lagrangian are positive along every
    /// direction that the active bounds leave. Elsewhere the solution moves least among all that solve the system.
    pub fn is_strict(&self) -> bool {
        self.shift == 0.0
    }

    /// The gradient of the objective without that of the rows times these multipliers: the multiplier of every variable
    /// that its bounds hold.
    pub fn lagrangian(&mut self, row_multipliers: &[f64]) -> Vec<f64> {
        let Scales { variables, rows, objective } = &self.system.scales;
        let mut weights = vec![0.0; self.system.functions()];
        for ((to, y), factor) in weights.iter_mut().zip(row_multipliers).zip(rows) {
            *to = -y / factor;
        }
        weights[self.system.objective()] = 1.0 / objective;
        let mut gradient = vec![0.0; variables.len() + 1];
        self.system.transposed_product(&weights, &mut gradient);
        gradient.iter().zip(&self.system.scales.variables).map(|(slope, size)| slope / size).collect()
    }

    /// The derivatives of the solution where bounds move so fast, one for each of `all`. Bounds that are not active count
    /// for nothing. What each is does not hang on the others.
    ///
    /// # Errors
    /// [`Unavailable::Unresolved`].
    pub fn responses(&mut self, all: &[Moving<'_>]) -> Result<Vec<Response>, Unavailable> {
        let mut found = Vec::with_capacity(all.len());
        for some in all.chunks(COLUMNS) {
            self.clear();
            let (first, Scales { variables, rows, .. }) = (self.system.first_variable(), &self.system.scales);
            for (k, moving) in some.iter().enumerate() {
                for &(row, rate) in moving.rows.iter().filter(|(row, _)| self.held[*row] != Held::No) {
                    self.work.rows[row][k] = rate * rows[row];
                }
                for &(j, rate) in moving.variables.iter().filter(|(j, _)| self.held[first + j] != Held::No) {
                    self.work.rows[first + j][k] = rate / variables[j];
                }
            }
            self.solve()?;
            found.extend((0..some.len()).map(|k| self.unscaled(k)));
        }
        Ok(found)
    }

    /// The *adjoint* of a linear function of the variables, with these coefficients: its derivative by the active bound
    /// of row `i` is `-rows[i]`, by that of variable `j` it is `-variables[j]`. One solve serves all parameters.
    /// There is one adjoint for each of `all`.
    ///
    /// # Errors
    /// [`Unavailable::Unresolved`].
    pub fn adjoints(&mut self, all: &[&[f64]]) -> Result<Vec<Response>, Unavailable> {
        let mut found = Vec::with_capacity(all.len());
        for some in all.chunks(COLUMNS) {
            self.clear();
            let Scales { variables, objective, .. } = &self.system.scales;
            for (k, coefficients) in some.iter().enumerate() {
                for ((to, g), size) in self.work.left.iter_mut().zip(*coefficients).zip(variables) {
                    to[k] = g * size * objective;
                }
            }
            self.solve()?;
            found.extend((0..some.len()).map(|k| self.unscaled(k)));
        }
        Ok(found)
    }

    /// The matrix of a strict minimum; elsewhere with the smallest shift that gives it one.
    fn factorise(&mut self) -> Result<(), Unavailable> {
        let weight = |held: &Held| if *held == Held::No { 0.0 } else { PENALTY };
        let sigma: Vec<f64> = self.held.iter().map(weight).collect();
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

    /// Right-hand sides of 0.
    fn clear(&mut self) {
        let (variables, functions) = (self.system.held().len() + 1, self.system.functions());
        let Work { x, y, left, rows, step, bend, pull, border, multipliers } = &mut self.work;
        let sizes = [(x, variables), (left, variables), (step, variables), (bend, variables), (pull, variables)];
        let border = (border, self.system.border_rows().len());
        for (buffer, len) in
            sizes.into_iter().chain([(y, functions), (rows, functions), (multipliers, functions), border])
        {
            buffer.clear();
            buffer.resize(len, Columns::default());
        }
    }

    /// Solves the system for the scaled right-hand sides in `work.left` and `work.rows`, by refinement of what the factors
    /// give. How variables that are held move is known from the beginning.
    fn solve(&mut self) -> Result<(), Unavailable> {
        let first = self.system.first_variable();
        let Work { x, left, rows, step, .. } = &mut self.work;
        for (j, _) in self.system.held().iter().enumerate().filter(|(_, held)| **held) {
            (x[j], step[j]) = (rows[first + j], rows[first + j]);
        }
        let mut terms = Terms { variables: largest(left.iter()), rows: largest(rows.iter()) };
        self.pass();
        let Work { left, bend, .. } = &mut self.work;
        add(left, bend);
        terms.variables = both(terms.variables, largest(bend.iter()), larger);
        terms.rows = both(terms.rows, self.rows_left(), larger);
        let (mut before, mut least, mut open) = ([f64::INFINITY; COLUMNS], [f64::INFINITY; COLUMNS], [true; COLUMNS]);
        for round in 0..=REFINEMENTS {
            let relative = self.relative(&terms);
            for k in 0..COLUMNS {
                let is_best = relative[k] < least[k];
                least[k] = if is_best { relative[k] } else { least[k] };
                let is_stuck = least[k] <= ALLOWED && relative[k] > 0.5 * before[k];
                let is_last = !relative[k].is_finite() || relative[k] <= REFINED || is_stuck || round == REFINEMENTS;
                if open[k] && is_last {
                    open[k] = false;
                    self.close(k, is_best);
                }
            }
            if open == [false; COLUMNS] {
                break;
            }
            before = relative;
            self.improve();
            let Work { bend, pull, multipliers, .. } = &self.work;
            terms.variables = both(terms.variables, largest(bend.iter().chain(pull).chain(multipliers)), larger);
        }
        let left = least.into_iter().fold(0.0, f64::max);
        if left <= ALLOWED { Ok(()) } else { Err(Unavailable::Unresolved(left)) }
    }

    /// The largest entries of what is left of the rows.
    fn rows_left(&self) -> Columns {
        let rows = self.work.rows.iter().zip(&self.held);
        largest(rows.filter(|(_, held)| **held != Held::No).map(|(row, _)| row))
    }

    /// What is left of the equations relative to their terms.
    fn relative(&self, terms: &Terms) -> Columns {
        let free = self.work.left.iter().zip(self.system.held()).filter(|(_, held)| !**held);
        let (variables, rows) = (largest(free.map(|(left, _)| left)), self.rows_left());
        // Where no bound moves, what changes in an active row is nothing: the measure is what it is the sum of, and
        // scaled slopes are about 1.
        let steps = largest(self.work.x.iter());
        let moved = both(terms.rows, steps, |rows, step| if rows == 0.0 { step } else { rows });
        let relative = |largest: f64, size: f64| if largest == 0.0 { 0.0 } else { largest / size };
        // Scaled curvatures are about 1: where all terms vanish, what moves is the measure.
        std::array::from_fn(|k| {
            let variables = relative(variables[k], terms.variables[k].max(moved[k]));
            larger(relative(rows[k], moved[k]), variables)
        })
    }

    /// Adds to a step what the factors make of its residual.
    fn improve(&mut self) {
        let Self { system, held, work, .. } = self;
        let Work { x, left, rows, step, bend, pull, border, multipliers, .. } = work;
        for ((step, (left, pull)), held) in step.iter_mut().zip(left.iter().zip(&*pull)).zip(system.held()) {
            *step = if *held { Columns::default() } else { std::array::from_fn(|k| left[k] + pull[k]) };
        }
        for (border, &row) in border.iter_mut().zip(system.border_rows()) {
            *border = if held[row] == Held::No { Columns::default() } else { rows[row] };
        }
        system.solve_columns(step, border);
        for (border, &row) in border.iter().zip(system.border_rows()) {
            multipliers[row] = if held[row] == Held::No { Columns::default() } else { border.map(|z| -z) };
        }
        add(x, step);
        bend.fill(Columns::default());
        pull.fill(Columns::default());
        self.pass();
        let Work { y, left, rows, bend, pull, multipliers, .. } = &mut self.work;
        for (function, held) in self.held.iter().enumerate() {
            for k in 0..COLUMNS {
                y[function][k] += latest(*held, rows[function][k], multipliers[function][k]);
            }
        }
        add(left, bend);
        add(left, pull);
    }

    /// What the latest step leaves of the equations.
    fn pass(&mut self) {
        let Work { step, multipliers, rows, bend, pull, .. } = &mut self.work;
        self.system.refine(&mut Refinement { held: &self.held, penalty: PENALTY, step, multipliers, rows, bend, pull });
        // The padding.
        [bend, pull].into_iter().filter_map(|buffer| buffer.last_mut()).for_each(|last| *last = Columns::default());
    }

    /// Ends the refinement of one right-hand side, whose equations are then met: later steps are 0. The latest step is taken
    /// back unless it is the best.
    fn close(&mut self, k: usize, is_best: bool) {
        let first = self.system.first_variable();
        let Work { x, y, left, rows, step, bend, pull, multipliers, .. } = &mut self.work;
        if !is_best {
            for (j, step) in step.iter().enumerate() {
                x[j][k] -= step[k];
                left[j][k] -= bend[j][k] + pull[j][k];
            }
            for (function, held) in self.held.iter().enumerate() {
                y[function][k] -= latest(*held, rows[function][k], multipliers[function][k]);
            }
        }
        // Where a variable is held, its multiplier is what is left.
        for (j, _) in self.system.held().iter().enumerate().filter(|(_, held)| **held) {
            y[first + j][k] = -left[j][k];
        }
        [left, rows, pull].into_iter().flatten().for_each(|columns| columns[k] = 0.0);
    }

    fn unscaled(&self, k: usize) -> Response {
        let Scales { variables, rows, objective } = &self.system.scales;
        let Work { x, y, .. } = &self.work;
        let bounds = y[self.system.first_variable()..].iter().zip(variables);
        Response {
            x: x.iter().zip(variables).map(|(x, size)| x[k] * size).collect(),
            rows: y.iter().zip(rows).map(|(y, factor)| y[k] * factor / objective).collect(),
            variables: bounds.map(|(y, size)| y[k] / (size * objective)).collect(),
        }
    }
}

/// The sizes of the terms that residuals are the sum of.
#[derive(Clone, Copy, Debug)]
struct Terms {
    variables: Columns,
    rows: Columns,
}

/// The larger of two; no number where one of them is none.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// A function of the entries of two.
fn both(a: Columns, b: Columns, function: impl Fn(f64, f64) -> f64) -> Columns {
    std::array::from_fn(|k| function(a[k], b[k]))
}

/// The largest entry of each column.
fn largest<'a>(all: impl Iterator<Item = &'a Columns>) -> Columns {
    all.fold(Columns::default(), |most, entry| std::array::from_fn(|k| larger(entry[k].abs(), most[k])))
}

/// The latest change of a multiplier, where `row` is what is left of its function and `border` the change in the border.
fn latest(held: Held, row: f64, border: f64) -> f64 {
    match held {
        Held::No => 0.0,
        Held::Condensed => PENALTY * row,
        Held::Border => border,
    }
}

fn add(to: &mut [Columns], more: &[Columns]) {
    for (to, more) in to.iter_mut().zip(more) {
        *to = both(*to, *more, |to, more| to + more);
    }
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
