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

mod activity;
mod refine;
mod settle;

pub use activity::Activity;

use crate::contract::{Nlp, NotFinite};
use crate::kkt::{COLUMNS, Curvature, Held, Part, System, Weights};
use crate::outcome::Multipliers;
use crate::scaling::Scales;
use activity::{Bounded, Side, bounded};
use refine::Work;
use settle::Nearest;

/// The weight of the squares of active rows and bounds, whose scaled slope is 1; refinement removes what it leaves.
const PENALTY: f64 = 1e10;
/// The weight of a row that is not active: none, but a number that may divide.
const WEIGHTLESS: f64 = 1e-30;
/// Shifts of the diagonal where the matrix is not that of a strict minimum: the first, their factor, the largest.
const FIRST_SHIFT: f64 = 1e-8;
const SHIFT_FACTOR: f64 = 100.0;
const LARGEST_SHIFT: f64 = 1.0;

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
    /// Of the multipliers of the variables' bounds. Those of variables whose two bounds are the same are left out, as 0, by
    /// [`Sensitivity::responses`].
    pub variables: Vec<f64>,
}

/// A point with its multipliers, in the program's own units.
struct Point {
    x: Vec<f64>,
    rows: Vec<f64>,
    bounds: Vec<f64>,
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
        let limits = nlp.limits();
        let held = limits.lower.iter().zip(&limits.upper).map(|(lower, upper)| lower == upper).collect();
        let (earlier, work) = earlier.map(|earlier| (earlier.system, earlier.work)).unzip();
        let system = System::for_program(earlier, nlp, is_unchanged, held);
        let held = vec![Held::No; system.functions()];
        let mut found = Self { system, activity: vec![], held, shift: 0.0, work: work.unwrap_or_default() };
        let at = Point { x: x.to_vec(), rows: multipliers.rows.to_vec(), bounds: multipliers.bounds.to_vec() };
        found.evaluate(nlp, &at)?;
        let first = bounded(limits, &found.system.scales, found.system.latest(), (x, multipliers));
        found.hold(&first);
        found.factorise()?;
        let (bounded, nearest) = found.settle(first)?;
        found.activity = bounded.iter().map(Bounded::activity).collect();
        if let Some(nearest) = nearest.filter(|nearest| nearest.is_other) {
            let at = found.moved(&bounded, &nearest, at);
            found.evaluate(nlp, &at)?;
            found.factorise()?;
        }
        Ok(found)
    }

    /// Takes derivatives at a point with its multipliers.
    fn evaluate<N: Nlp<Workspace = W>>(&mut self, nlp: &N, at: &Point) -> Result<(), Unavailable> {
        self.system.at_solution(nlp, &at.x, &at.rows).map_err(Unavailable::NotFinite)
    }

    /// A point and its multipliers, moved to the nearest solution.
    fn moved(&self, bounded: &[Bounded], nearest: &Nearest, mut at: Point) -> Point {
        let Scales { variables, rows, objective, .. } = &self.system.scales;
        at.x.iter_mut().zip(&nearest.step).zip(variables).for_each(|((x, step), size)| *x += step * size);
        let multipliers =
            bounded.iter().zip(&nearest.multipliers).map(|(of, change)| of.held_multiplier_after(*change));
        let factors = rows.iter().map(|factor| factor / objective);
        let factors = factors.chain(variables.iter().map(|size| 1.0 / (size * objective)));
        let all = at.rows.iter_mut().chain(&mut at.bounds);
        all.zip(multipliers.zip(factors)).for_each(|(to, (multiplier, factor))| *to = multiplier * factor);
        at
    }

    /// The functions that have bounds: rows, then variables.
    fn bounded_functions(&self) -> impl Iterator<Item = usize> + Clone + use<W> {
        (0..self.system.objective()).chain(self.system.first_variable()..self.system.functions())
    }

    /// Marks the functions that are at a bound which is taken to hold them.
    fn hold(&mut self, bounded: &[Bounded]) {
        for (function, of) in self.bounded_functions().zip(bounded) {
            self.held[function] = if of.side == Side::Free { Held::No } else { Held::Condensed };
        }
        for &row in self.system.border_rows() {
            if self.held[row] != Held::No {
                self.held[row] = Held::Border;
            }
        }
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
        let Scales { variables, rows, objective, .. } = &self.system.scales;
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
            self.solve((Part::Held, Part::Free))?;
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
            self.solve((Part::All, Part::All))?;
            self.multipliers_of_held();
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
}
