//! Refinement of what the factors give, for several right-hand sides at a time (docs/maths.md, section 16.2).
//!
//! Takes scaled right-hand sides; leaves the solutions where they were. What becomes of one does not hang on the others.

use super::{PENALTY, Response, Sensitivity, Unavailable};
use crate::kkt::{COLUMNS, Columns, Held, Part, Refinement};
use crate::scaling::Scales;
use ntg_math::{Simd, Task, dispatch};

/// Refinements at most. A law of two or three is usual; a shift takes more.
const REFINEMENTS: usize = 40;
/// What is left of a residual, relative to the terms that it is the sum of: where refinement ends, and what is allowed.
const REFINED: f64 = 1e-13;
const ALLOWED: f64 = 1e-6;

/// What is solved for several right-hand sides at a time: vectors by variable, with the padding entry, and by function.
#[derive(Clone, Debug, Default)]
pub(super) struct Work {
    x: Vec<Columns>,
    y: Vec<Columns>,
    /// What is left of both equations.
    pub(super) left: Vec<Columns>,
    pub(super) rows: Vec<Columns>,
    /// The latest step, and what it changes.
    step: Vec<Columns>,
    bend: Vec<Columns>,
    pull: Vec<Columns>,
    /// Multipliers of border rows, by border row and by function.
    border: Vec<Columns>,
    multipliers: Vec<Columns>,
}

impl Work {
    /// The scaled steps of the variables, and the padding entry, for one right-hand side.
    pub(super) fn steps(&self, k: usize) -> impl Iterator<Item = f64> {
        self.x.iter().map(move |x| x[k])
    }

    /// The scaled changes of the functions' multipliers for one right-hand side.
    pub(super) fn multipliers(&self, k: usize) -> impl Iterator<Item = f64> {
        self.y.iter().map(move |y| y[k])
    }
}

impl<W> Sensitivity<W> {
    /// Right-hand sides of 0.
    pub(super) fn clear(&mut self) {
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
    /// give. How variables that are held move is known from the beginning: the first pass concerns one part, later ones
    /// another.
    pub(super) fn solve(&mut self, parts: (Part, Part)) -> Result<(), Unavailable> {
        self.solve_within(REFINEMENTS, parts)
    }

    /// As [`Sensitivity::solve`], with so many refinements at most.
    pub(super) fn solve_within(
        &mut self,
        refinements: usize,
        (first_part, later): (Part, Part),
    ) -> Result<(), Unavailable> {
        let first = self.system.first_variable();
        let Work { x, left, rows, step, .. } = &mut self.work;
        for (j, _) in self.system.held().iter().enumerate().filter(|(_, held)| **held) {
            (x[j], step[j]) = (rows[first + j], rows[first + j]);
        }
        let mut terms = Sizes { variables: largest(&*left), rows: largest(&*rows) };
        let mut sizes = self.pass(first_part, &mut terms, true);
        terms.rows = both(terms.rows, sizes.rows, larger);
        let (mut before, mut least, mut open) = ([f64::INFINITY; COLUMNS], [f64::INFINITY; COLUMNS], [true; COLUMNS]);
        for round in 0..=refinements {
            let relative = self.relative(&sizes, &terms);
            for k in 0..COLUMNS {
                let is_best = relative[k] < least[k];
                least[k] = if is_best { relative[k] } else { least[k] };
                let is_stuck = least[k] <= ALLOWED && relative[k] > 0.5 * before[k];
                let is_last = !relative[k].is_finite() || relative[k] <= REFINED || is_stuck || round == refinements;
                if open[k] && is_last {
                    open[k] = false;
                    self.close(k, is_best);
                }
            }
            if open == [false; COLUMNS] {
                break;
            }
            self.still(open);
            before = relative;
            self.improve();
            sizes = self.pass(later, &mut terms, false);
        }
        let left = least.into_iter().fold(0.0, larger);
        let is_finite = self.work.x.iter().flatten().all(|x| x.is_finite());
        if left <= ALLOWED && is_finite { Ok(()) } else { Err(Unavailable::Unresolved(left)) }
    }

    /// What is left of the equations relative to their terms.
    fn relative(&self, left: &Sizes, terms: &Sizes) -> Columns {
        // Where no bound moves, what changes in an active row is nothing: the measure is what it is the sum of, and
        // scaled slopes are about 1.
        let moved = match terms.rows.contains(&0.0) {
            true => both(terms.rows, largest(&self.work.x), |rows, step| if rows == 0.0 { step } else { rows }),
            false => terms.rows,
        };
        let relative = |largest: f64, size: f64| if largest == 0.0 { 0.0 } else { largest / size };
        // Scaled curvatures are about 1: where all terms vanish, what moves is the measure.
        let variables = both(left.variables, both(terms.variables, moved, larger), relative);
        both(variables, both(left.rows, moved, relative), larger)
    }

    /// The latest step: what the factors make of what is left.
    fn improve(&mut self) {
        let Self { system, held, work, .. } = self;
        let Work { x, left, rows, step, pull, border, multipliers, .. } = work;
        for ((step, (left, pull)), held) in step.iter_mut().zip(left.iter().zip(&*pull)).zip(system.held()) {
            *step = if *held { Columns::default() } else { both(*left, *pull, |left, pull| left + pull) };
        }
        for (border, &row) in border.iter_mut().zip(system.border_rows()) {
            *border = if held[row] == Held::No { Columns::default() } else { rows[row] };
        }
        system.solve_columns(step, border);
        for (border, &row) in border.iter().zip(system.border_rows()) {
            multipliers[row] = if held[row] == Held::No { Columns::default() } else { border.map(|z| -z) };
        }
        x.iter_mut().zip(&*step).for_each(|(x, step)| *x = both(*x, *step, |x, step| x + step));
    }

    /// What the latest step leaves of the equations: the largest entries. Multipliers change unless it `is_first`. Raises
    /// `terms` to the sizes of what has changed.
    fn pass(&mut self, part: Part, terms: &mut Sizes, is_first: bool) -> Sizes {
        let Work { step, multipliers, rows, bend, pull, .. } = &mut self.work;
        bend.fill(Columns::default());
        pull.fill(Columns::default());
        let (held, penalty) = (&*self.held, PENALTY);
        self.system.refine(&mut Refinement { part, held, penalty, step, multipliers, rows, bend, pull });
        let border = self.system.border_rows().iter().map(|&row| &self.work.multipliers[row]);
        terms.variables = both(terms.variables, largest(border), larger);
        let mut sizes = Sizes::default();
        let held = (self.system.held(), &*self.held);
        dispatch(Advance { work: &mut self.work, held, is_first, terms: &mut terms.variables, sizes: &mut sizes });
        sizes
    }

    /// Ends the refinement of one right-hand side. The latest step is taken back unless it is the best.
    fn close(&mut self, k: usize, is_best: bool) {
        if is_best {
            return;
        }
        let Work { x, y, left, rows, step, bend, pull, multipliers, .. } = &mut self.work;
        for (j, step) in step.iter().enumerate() {
            x[j][k] -= step[k];
            left[j][k] -= bend[j][k] + pull[j][k];
        }
        for (function, held) in self.held.iter().enumerate() {
            y[function][k] -= latest(*held, rows[function][k], multipliers[function][k]);
        }
    }

    /// Where a variable is held, its multiplier is what is left; known where passes concerned all variables.
    pub(super) fn multipliers_of_held(&mut self) {
        let (first, Work { y, left, .. }) = (self.system.first_variable(), &mut self.work);
        for (j, _) in self.system.held().iter().enumerate().filter(|(_, held)| **held) {
            y[first + j] = left[j].map(|left| -left);
        }
    }

    /// Makes the later steps of all but some right-hand sides 0.
    fn still(&mut self, open: [bool; COLUMNS]) {
        if open.contains(&false) {
            let Work { left, rows, pull, .. } = &mut self.work;
            for columns in [left, rows, pull].into_iter().flatten() {
                *columns = std::array::from_fn(|k| if open[k] { columns[k] } else { 0.0 });
            }
        }
    }

    pub(super) fn unscaled(&self, k: usize) -> Response {
        let Scales { variables, rows, objective, .. } = &self.system.scales;
        let Work { x, y, .. } = &self.work;
        let bounds = y[self.system.first_variable()..].iter().zip(variables);
        Response {
            x: x.iter().zip(variables).map(|(x, size)| x[k] * size).collect(),
            rows: y.iter().zip(rows).map(|(y, factor)| y[k] * factor / objective).collect(),
            variables: bounds.map(|(y, size)| y[k] / (size * objective)).collect(),
        }
    }
}

/// The largest entries of vectors by variable and by function.
#[derive(Clone, Copy, Debug, Default)]
struct Sizes {
    variables: Columns,
    rows: Columns,
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A function of the entries of two.
#[inline(always)]
fn both(a: Columns, b: Columns, function: impl Fn(f64, f64) -> f64) -> Columns {
    std::array::from_fn(|k| function(a[k], b[k]))
}

/// The largest entry of each column.
fn largest<'a>(all: impl IntoIterator<Item = &'a Columns>) -> Columns {
    all.into_iter().fold(Columns::default(), |most, entry| both(entry.map(f64::abs), most, larger))
}

/// Adds what a step changes, to be compiled for the widest instructions of the processor.
struct Advance<'a> {
    work: &'a mut Work,
    /// Variables, and functions.
    held: (&'a [bool], &'a [Held]),
    is_first: bool,
    /// The largest changes.
    terms: &'a mut Columns,
    /// What is left.
    sizes: &'a mut Sizes,
}

impl Task for Advance<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Work { y, left, rows, bend, pull, multipliers, .. } = self.work;
        let (mut terms, mut largest) = (*self.terms, Columns::default());
        for ((left, held), (bend, pull)) in left.iter_mut().zip(self.held.0).zip(bend.iter().zip(&*pull)) {
            let pull = if self.is_first { Columns::default() } else { *pull };
            terms = both(bend.map(f64::abs), terms, larger);
            terms = both(pull.map(f64::abs), terms, larger);
            *left = both(*left, both(*bend, pull, |bend, pull| bend + pull), |left, change| left + change);
            if !held {
                largest = both(left.map(f64::abs), largest, larger);
            }
        }
        (*self.terms, self.sizes.variables) = (terms, largest);
        let mut largest = Columns::default();
        for (((y, row), border), held) in y.iter_mut().zip(&*rows).zip(&*multipliers).zip(self.held.1) {
            if *held == Held::No {
                continue;
            }
            largest = both(row.map(f64::abs), largest, larger);
            if !self.is_first {
                *y = both(*y, both(*row, *border, |row, border| latest(*held, row, border)), |y, more| y + more);
            }
        }
        self.sizes.rows = largest;
    }
}

/// The latest change of a multiplier, where `row` is what is left of its function and `border` the change in the border.
#[inline(always)]
fn latest(held: Held, row: f64, border: f64) -> f64 {
    match held {
        Held::No => 0.0,
        Held::Condensed => PENALTY * row,
        Held::Border => border,
    }
}
