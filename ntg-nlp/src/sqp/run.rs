//! The state of a solve, and the steps of the loop that make proposals and move on.
//! The search along a proposal is in `search.rs`, the end in `ending.rs`.

use super::clarabel::Verdict;
use super::elastic::{Elastic, Found};
use super::ending::Best;
use super::exact::ExactStep;
use super::globalise::Merit;
use super::scaled::Program;
use super::search::Trial;
use super::step::Step;
use super::subproblem::{Model, Subproblem};
use crate::contract::{Nlp, NotFinite};
use crate::options::Options;
use crate::outcome::{IterationRecord, Multipliers};
use crate::sparse::Csc;
use crate::status::Status;
use std::time::Instant;

/// The smallest proximal term: it bounds the step where the clipped Hessian is singular.
const LEAST_PROXIMAL: f64 = 1e-8;
/// The proximal term after a first failure.
const FIRST_PROXIMAL: f64 = 1e-3;
/// The largest proximal term: steps are then shorter than the tolerances ask for.
const LARGEST_PROXIMAL: f64 = 1e8;
/// Factor by which the proximal term grows after a failure and shrinks after a success.
const PROXIMAL_STEP: f64 = 10.0;
/// Shares of the clipped Hessian in the one of Newton's step, in the order of trial.
const CONVEX_FRACTIONS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];
/// How often restoration is tried in one solve.
const RESTORATIONS: usize = 3;
/// A step cut to this fraction was a bad proposal.
const SHORT: f64 = 1.0 / 64.0;
/// An elastic step cut to this fraction calls for shorter proposals.
const LONG_ENOUGH: f64 = 0.25;
/// A full step halved this often has no effect any more.
const HALVINGS: usize = 40;
/// Most history records for which room is made at once.
const HISTORY: usize = 4096;

/// Everything that lives from one iteration to the next. All vectors are scaled.
pub(super) struct Run<'a, N: Nlp> {
    pub(super) options: &'a Options,
    pub(super) program: Program<'a, N>,
    pub(super) x: Vec<f64>,
    pub(super) previous: Vec<f64>,
    pub(super) row_multipliers: Vec<f64>,
    pub(super) bound_multipliers: Vec<f64>,
    /// The subproblem's proposal.
    pub(super) convex: Step,
    /// Newton's proposal.
    pub(super) newton: Step,
    /// The active bounds with which `newton` began.
    guess: Step,
    /// How much of the clipped Hessian is in the one that `newton` was made with.
    fraction: f64,
    /// Whether `newton` is the proposal that is searched.
    pub(super) use_newton: bool,
    /// A step corrected for curvature.
    pub(super) corrected: Step,
    /// The active bounds of the subproblem before this one.
    settled: Step,
    pub(super) subproblem: Subproblem,
    pub(super) elastic: Option<Elastic>,
    pub(super) exact: ExactStep,
    pub(super) merit: Merit,
    pub(super) trial: Trial,
    /// The penalty of the present elastic step; none in ordinary mode.
    pub(super) penalty: Option<f64>,
    /// Whether the next iteration begins in elastic mode.
    stretched: bool,
    /// Whether the multipliers are still those of the start.
    pub(super) untouched: bool,
    repeat_newton: bool,
    /// How often restoration may still be tried.
    restorations: usize,
    /// Whether the subproblem had no minimum without a larger proximal term.
    pub(super) falls: bool,
    pub(super) proximal: f64,
    pub(super) record: IterationRecord,
    /// The best acceptable point so far.
    pub(super) best: Best,
    pub(super) history: Vec<IterationRecord>,
    pub(super) iterations: usize,
    pub(super) qps: usize,
    pub(super) begin: Instant,
}

impl<'a, N: Nlp> Run<'a, N> {
    /// Evaluates the program at `start`, which lies within the bounds.
    pub(super) fn new(
        nlp: &'a N,
        start: &[f64],
        from: Option<Multipliers<'_>>,
        options: &'a Options,
        begin: Instant,
    ) -> Result<Self, NotFinite> {
        let mut program = Program::new(nlp, start, options.scaling)?;
        let (n, m) = (nlp.variables(), nlp.rows());
        let x = program.scale(start);
        let from = from.filter(|from| from.rows.len() == m && from.bounds.len() == n);
        let (rows, bounds) = match &from {
            Some(from) => program.scale_multipliers(from.rows, from.bounds),
            None => (vec![0.0; m], vec![0.0; n]),
        };
        program.derivatives(&x, &rows)?;
        Ok(Self {
            options,
            previous: x.clone(),
            x,
            row_multipliers: rows,
            bound_multipliers: bounds,
            convex: Step::new(n, m),
            newton: Step::new(n, m),
            guess: Step::new(n, m),
            fraction: 0.0,
            use_newton: false,
            corrected: Step::new(n, m),
            settled: Step::new(n, m),
            subproblem: Subproblem::new(&program.limits, &program.jacobian, &program.convex, false),
            elastic: None,
            exact: ExactStep::new(&program.jacobian, &program.exact),
            merit: Merit::new(),
            trial: Trial::new(n, m),
            penalty: None,
            stretched: false,
            untouched: from.is_none(),
            repeat_newton: false,
            restorations: RESTORATIONS,
            falls: false,
            proximal: LEAST_PROXIMAL,
            record: IterationRecord::default(),
            best: Best::default(),
            history: Vec::with_capacity(options.max_iterations.min(HISTORY) + 1),
            iterations: 0,
            qps: 0,
            begin,
            program,
        })
    }

    /// Newton's step on the active bounds of the last one, if that was taken in full.
    pub(super) fn newton_again(&mut self) -> bool {
        self.use_newton = false;
        std::mem::take(&mut self.repeat_newton) && self.solve_newton()
    }

    /// Newton's step on the active bounds of the subproblem, once these have settled.
    pub(super) fn newton_from_subproblem(&mut self) -> bool {
        let settled = self.convex.same_active(&self.settled);
        self.settled.copy_from(&self.convex);
        if !self.options.exact_hessian || self.penalty.is_some() || !settled {
            return false;
        }
        self.newton.copy_from(&self.convex);
        self.solve_newton()
    }

    /// Newton's step from the active bounds in `newton`: with the exact Hessian, else with as
    /// little of the clipped one mixed in as makes the step lead to a minimum of the model.
    fn solve_newton(&mut self) -> bool {
        self.guess.copy_from(&self.newton);
        for fraction in CONVEX_FRACTIONS {
            self.program.mix(fraction);
            let model = model(&self.program, &self.x, &self.program.mixed, 0.0);
            self.use_newton = self.exact.solve(&model, &mut self.newton);
            if self.use_newton {
                self.fraction = fraction;
                return true;
            }
            self.newton.copy_from(&self.guess);
        }
        false
    }

    /// Solves the convex subproblem, in elastic form where the ordinary one has no solution; a
    /// status if that is the end.
    pub(super) fn subproblem(&mut self) -> Option<Status> {
        self.use_newton = false;
        self.falls = false;
        loop {
            if let Some(result) = self.ordinary_subproblem().or_else(|| self.elastic_subproblem()) {
                return result;
            }
            // Neither form could be solved: once more with a larger proximal term.
            if self.proximal >= 1.0 {
                return Some(Status::SubproblemFailed);
            }
            self.falls = true;
            self.grow_proximal();
        }
    }

    /// A step and no status, or nothing.
    fn ordinary_subproblem(&mut self) -> Option<Option<Status>> {
        while !self.stretched {
            let model = model(&self.program, &self.x, &self.program.convex, self.proximal);
            self.qps += 1;
            match self.subproblem.solve(&model, &mut self.convex) {
                Verdict::Solved => {
                    self.penalty = None;
                    return Some(None);
                }
                // Where every row is satisfied, there is a step, if only a short one.
                Verdict::Unbounded | Verdict::Failed if self.proximal < 1.0 && !self.violated() => {
                    self.falls = true;
                    self.grow_proximal();
                }
                _ => break,
            }
        }
        None
    }

    /// A step, or the end, or nothing.
    fn elastic_subproblem(&mut self) -> Option<Option<Status>> {
        let model = model(&self.program, &self.x, &self.program.convex, self.proximal);
        let violation = super::globalise::violation(&self.program.limits, &self.program.rows);
        let elastic = self.elastic.get_or_insert_with(|| Elastic::new(&model));
        match elastic.step(&model, violation, &mut self.convex, &mut self.qps) {
            Found::Step { penalty, feasible } => {
                self.penalty = Some(penalty);
                self.stretched = !feasible;
                if feasible {
                    elastic.reset();
                }
                Some(None)
            }
            Found::Stationary if self.violated() => Some(self.restored()),
            Found::Stationary | Found::Failed => {
                self.stretched = false;
                None
            }
        }
    }

    /// Where the sum of violations cannot be reduced, perhaps the sum of their squares can.
    fn restored(&mut self) -> Option<Status> {
        self.stretched = false;
        if self.restorations > 0 {
            self.restorations -= 1;
            if self.restore() {
                return None;
            }
            self.measure();
        }
        Some(Status::Infeasible { rows: self.violations() })
    }

    /// Whether a row is violated by more than the tolerance.
    fn violated(&self) -> bool {
        self.record.residuals.scaled.primal > self.options.constraint_tolerance
    }

    /// After a search that found nothing: shorter steps, or the end.
    pub(super) fn shorten(&mut self) -> Option<Status> {
        self.grow_proximal();
        self.stretch();
        if self.proximal < LARGEST_PROXIMAL {
            return None;
        }
        Some(match self.trial.failure.take() {
            Some(what) => self.not_finite(what),
            None => Status::StepTooSmall,
        })
    }

    /// Begins the next iteration in elastic mode if rows are violated: linearised rows that can be
    /// satisfied only by steps that lead nowhere are as bad as rows that cannot.
    fn stretch(&mut self) {
        self.stretched |= self.violated();
    }

    fn grow_proximal(&mut self) {
        self.proximal = (PROXIMAL_STEP * PROXIMAL_STEP * self.proximal).max(FIRST_PROXIMAL);
    }

    /// Moves to the accepted trial point and blends the multipliers.
    ///
    /// # Errors
    /// The derivatives are not finite on the whole way there.
    pub(super) fn advance(&mut self) -> Result<(), NotFinite> {
        let proposal = if self.use_newton { &self.newton } else { &self.convex };
        let alpha = self.trial.alpha;
        let blend = if self.untouched || self.penalty.is_some() { 1.0 } else { alpha };
        for (lambda, new) in self.row_multipliers.iter_mut().zip(&proposal.row_multipliers) {
            *lambda += blend * (new - *lambda);
        }
        for (mu, new) in self.bound_multipliers.iter_mut().zip(&proposal.bound_multipliers) {
            *mu += blend * (new - *mu);
        }
        // Multipliers of the elastic subproblem count penalties; the next step replaces them at once.
        self.untouched = self.penalty.is_some();
        self.repeat_newton = self.use_newton;
        self.record.step = alpha;
        self.record.elastic = self.penalty.is_some();
        self.record.exact = self.use_newton && self.fraction == 0.0;
        self.record.convexified = self.use_newton && self.fraction > 0.0;
        self.record.corrected = self.trial.corrected;
        self.history.push(self.record);
        self.iterations += 1;
        if alpha <= SHORT {
            self.stretch();
        }
        if alpha <= LONG_ENOUGH && self.penalty.is_some() {
            // The elastic model promises too much far away: keep its next step shorter.
            self.proximal = (PROXIMAL_STEP * self.proximal).max(FIRST_PROXIMAL);
        }
        if alpha >= 1.0 {
            self.proximal = (self.proximal / PROXIMAL_STEP).max(LEAST_PROXIMAL);
        }
        self.previous.copy_from_slice(&self.x);
        self.x.copy_from_slice(&self.trial.x);
        self.differentiate()
    }

    /// Derivatives at the new point, or nearer to the last one where they are not finite.
    fn differentiate(&mut self) -> Result<(), NotFinite> {
        let mut result = self.program.derivatives(&self.x, &self.row_multipliers);
        for _ in 0..HALVINGS {
            if result.is_ok() {
                break;
            }
            self.repeat_newton = false;
            for (x, before) in self.x.iter_mut().zip(&self.previous) {
                *x = 0.5 * (*x + before);
            }
            result = self.program.derivatives(&self.x, &self.row_multipliers);
        }
        result
    }
}

/// The subproblem's data at the present point, with one of the Hessians.
pub(super) fn model<'m, N: Nlp>(
    program: &'m Program<'_, N>,
    x: &'m [f64],
    hessian: &'m Csc,
    proximal: f64,
) -> Model<'m> {
    Model {
        limits: &program.limits,
        x,
        rows: &program.rows,
        gradient: &program.gradient,
        jacobian: &program.jacobian,
        hessian,
        proximal,
        penalty: 0.0,
        squared: false,
    }
}
