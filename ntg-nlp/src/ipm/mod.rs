//! The structured primal-dual interior-point method: Algorithm 11 of docs/maths.md, section 11.
//!
//! Takes any [`Nlp`], a start and [`Options`]; gives an [`Outcome`], by the same test of optimality as
//! sequential quadratic programming. Second derivatives are exact. The linear systems are condensed element by element
//! and eliminated in an order that follows their coupling, so that the cost of an iteration grows linearly with the
//! length of a trajectory.
//!
//! `state` holds the iterate and its residuals, `slacks` the bounds with slacks and multipliers, `barrier` the barrier
//! parameter, `crawl` whether shifts serve better than what `inertia` adds, `step` the primal-dual step, which
//! `equalities` and `conjugate_residuals` refine, `line_search` the search by the `filter` with its second-order
//! corrections and its `watchdog`; `angles` turn by little, and variables that rows define (`definitions`) are at every
//! point what these say. `mode` says how violations are treated: `relaxed` rows cost a price, that of `penalty`, where
//! bounds are elastic, or of the `augmented` Lagrangian; `penalty_search` searches by it, `restoration` restores
//! feasibility by it. `initial` and `warm` are the start, `polish` and `ending` the end, and `saddle` looks whether that
//! is a minimum.
//!
//! The globalisation follows A. Wächter and L. T. Biegler, *Math. Prog.* 106 (2006), cited as WB.

mod angles;
mod augmented;
mod barrier;
mod best;
mod conjugate_residuals;
mod crawl;
mod definitions;
mod ending;
mod equalities;
mod filter;
mod inertia;
mod initial;
mod last_barrier;
mod line_search;
mod mode;
mod penalty;
mod penalty_search;
mod polish;
mod relaxed;
mod restoration;
mod saddle;
mod second_order;
mod slacks;
mod stagnation;
mod state;
mod step;
mod step_kernels;
mod warm;
mod watchdog;

use crate::check::refusal;
use crate::contract::Nlp;
use crate::erased::{Buffers, Erased, Own};
use crate::options::Options;
use crate::outcome::{Outcome, Start};
use crate::posed::{Form, Posed};
use crate::remeasure::{Measure, until_measured};
use crate::status::Status;
use line_search::SearchOutcome;
#[cfg(feature = "sqp")]
pub(crate) use saddle::below_saddle;
use state::{Kept, State};
use std::marker::PhantomData;
use std::time::Instant;

/// Most iterations with limits and continuity over durations as they are written, before they are posed times durations. A fit to
/// the family `splits`: what is found so is found in so many, mostly, and the others take as many in the other form.
const AS_WRITTEN: usize = 150;

/// Tiny steps in a row, at one barrier parameter, that end a solve. A law: one may be an accident of rounding.
const TINY_STEPS: usize = 3;

/// What one solve leaves to the next: the scaled system with its symbolic analysis. `W` is the program's workspace.
///
/// A solve analyses the program again where its patterns differ from those of the last program, and loads its numbers
/// again where they may differ.
pub struct Analysis<W> {
    kept: Kept<Buffers>,
    workspace: PhantomData<fn() -> W>,
}

impl<W> Analysis<W> {
    /// Must be called when a program differs from the one of the last solve in its blocks or in the data of its
    /// workspace. Bounds, row sizes and variable sizes may differ without it.
    pub fn program_changed(&mut self) {
        self.kept.is_unchanged = false;
    }
}

impl<W> Default for Analysis<W> {
    fn default() -> Self {
        Self { kept: Kept::default(), workspace: PhantomData }
    }
}

/// Solves `nlp` from `start`, which is first moved to within the bounds of the variables.
///
/// The answer is deterministic: the same program, start and options give the same bits (a time
/// limit apart).
pub fn solve<N: Nlp>(nlp: &N, start: &[f64], options: &Options) -> Outcome {
    solve_from(nlp, start, Start::Cold, options)
}

/// As [`solve`], from a start about which more is known.
pub fn solve_from<N: Nlp>(nlp: &N, start: &[f64], from: Start<'_>, options: &Options) -> Outcome {
    solve_again(&mut Analysis::default(), nlp, start, from, options)
}

/// As [`solve_from`], with the symbolic analysis of an earlier solve, which is made anew only where the program's
/// patterns have changed. After the first solve an unchanged program costs no analysis at all
/// ([`Analysis::program_changed`]).
pub fn solve_again<N: Nlp>(
    analysis: &mut Analysis<N::Workspace>,
    nlp: &N,
    start: &[f64],
    from: Start<'_>,
    options: &Options,
) -> Outcome {
    solve_erased(&mut analysis.kept, &Erased::of(&Own(nlp)), start, from, options)
}

/// As [`solve_again`]. Where limits and continuity could be posed times durations, which may vanish, they are as they are written
/// first.
fn solve_erased(
    kept: &mut Kept<Buffers>,
    nlp: &Erased<'_>,
    start: &[f64],
    from: Start<'_>,
    options: &Options,
) -> Outcome {
    let began = Instant::now();
    let has_others = Form::differ(nlp.limits());
    let most = if has_others { options.max_iterations.min(AS_WRITTEN) } else { options.max_iterations };
    let first = Options { max_iterations: most, ..options.clone() };
    // The last solve may have ended in the other form, whose blocks differ.
    kept.is_unchanged &= !has_others;
    let written = solve_in_form(kept, nlp, (start, from), Form::Equations, &first);
    let is_solved = written.status == Status::Solved && !written.is_saddle;
    let is_stopped = matches!(written.status, Status::Cancelled | Status::TimeLimit);
    if !has_others || is_solved || is_stopped || most == options.max_iterations {
        return written;
    }
    let left = options.max_iterations.saturating_sub(written.iterations);
    let rest = Options { max_iterations: left, ..options.after(began.elapsed()) };
    kept.is_unchanged = false;
    let posed = solve_in_form(kept, nlp, (start, from), Form::All, &rest);
    let iterations = written.iterations + posed.iterations;
    let is_better = posed.status.has_solution() || !written.status.has_solution();
    let best = if is_better { posed } else { written };
    Outcome { iterations, seconds: began.elapsed().as_secs_f64(), ..best }
}

/// As [`solve_again`], with rows over durations in one form.
fn solve_in_form(
    kept: &mut Kept<Buffers>,
    nlp: &Erased<'_>,
    (start, from): (&[f64], Start<'_>),
    form: Form,
    options: &Options,
) -> Outcome {
    match Posed::of(nlp, start, form) {
        Some(posed) => posed.solve(start, from, |posed, from| solve_posed(kept, posed, start, from, options)),
        None => solve_posed(kept, nlp, start, from, options),
    }
}

/// As [`solve_again`]; norms are as they are.
fn solve_posed(
    kept: &mut Kept<Buffers>,
    nlp: &Erased<'_>,
    start: &[f64],
    from: Start<'_>,
    options: &Options,
) -> Outcome {
    until_measured(nlp, options, |nlp, round, options| {
        let (start, from) = round.start.unwrap_or((start, from));
        let outcome = match initial(nlp, start, from, options, kept) {
            Ok(mut state) => {
                if round.may_outgrow {
                    state.watch_sizes();
                }
                state.is_damped = round.is_damped;
                iterate(state)
            }
            Err(status) => {
                kept.measure = Measure::Holds;
                Outcome::failed(nlp, start, status)
            }
        };
        (outcome, std::mem::take(&mut kept.measure))
    })
}

/// A penalty parameter that is the same from beginning to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPenalty {
    /// The penalty parameter: what a unit of violation costs, in units of the scaled objective.
    pub parameter: f64,
    /// The barrier parameter at and below which a violation that remains ends the solve as infeasible.
    pub barrier: f64,
}

/// As [`solve`], in penalty mode with a fixed penalty parameter: where the constraints cannot be met, the sum of scaled
/// violations is least, and the objective decides only among such points. Multipliers are at most the parameter.
pub fn solve_at_fixed_penalty<N: Nlp>(nlp: &N, start: &[f64], penalty: FixedPenalty, options: &Options) -> Outcome {
    solve_erased_at_fixed_penalty(&Erased::of(&Own(nlp)), start, penalty, options)
}

/// As [`solve_at_fixed_penalty`].
fn solve_erased_at_fixed_penalty(nlp: &Erased<'_>, start: &[f64], penalty: FixedPenalty, options: &Options) -> Outcome {
    match initial(nlp, start, Start::Cold, options, &mut Kept::default()) {
        Ok(mut state) => {
            state.enter_penalty_mode(penalty.parameter);
            state.fix_penalty(penalty);
            state.centre_on_price();
            iterate(state)
        }
        Err(status) => Outcome::failed(nlp, start, status),
    }
}

/// Line 1 of Algorithm 11: the scaled program and the first iterate, or why there is none.
fn initial<'a, N: Nlp>(
    nlp: &'a N,
    start: &[f64],
    from: Start<'_>,
    options: &'a Options,
    kept: &'a mut Kept<N::Workspace>,
) -> Result<State<'a, N>, Status> {
    match refusal(nlp, start) {
        Some(status) => Err(status),
        None => State::new(nlp, start, from, options, kept),
    }
}

/// Lines 2 to 11 of Algorithm 11, whose numbers stand beside them.
fn iterate<N: Nlp>(mut state: State<'_, N>) -> Outcome {
    let (mut tiny_steps, mut mu) = (0, state.mu);
    loop {
        state.compute_residuals(); // 3
        if let Some(sizes) = state.outgrown_sizes() {
            return state.end_outgrown(sizes);
        }
        state.leave_restoration();
        state.keep_nearest();
        let stop = state.stop();
        let solved = stop == Some(Status::Solved);
        if (solved || state.best.is_held) && state.is_polished(solved) {
            return state.outcome(Status::Solved); // 4
        }
        if let Some(status) = stop.filter(|_| !solved) {
            return state.end(status); // 5
        }
        if state.stagnates() {
            return state.end(Status::StepTooSmall); // 5
        }
        state.lower_last_barrier(); // 6
        if let Some(status) = state.lower_barrier() {
            return state.end(status); // 6
        }
        let searched = state.step_and_search(); // 7 to 9
        tiny_steps = match searched {
            SearchOutcome::Tiny if state.mu == mu => tiny_steps + 1,
            SearchOutcome::Tiny => 1,
            SearchOutcome::Stuck | SearchOutcome::Accepted => 0,
        };
        mu = state.mu;
        let ended = match searched {
            // WB, section 3.9: a barrier problem whose steps are rounding is solved.
            SearchOutcome::Tiny if tiny_steps >= TINY_STEPS => {
                tiny_steps = 0;
                (!state.force_lower_barrier() && !state.leave_augmented_mode()).then(|| state.stuck())
            }
            SearchOutcome::Stuck if state.mode.restoration().is_some() => {
                state.abandon_restoration();
                state.enter_penalty_mode(penalty::PARAMETER);
                None
            }
            SearchOutcome::Stuck if state.leave_augmented_mode() => None,
            SearchOutcome::Stuck if state.mode.relaxed().is_some() => Some(state.stuck()),
            SearchOutcome::Stuck if state.is_nearly_feasible() => {
                if state.newton_step() {
                    None
                } else {
                    Some(state.stuck())
                }
            }
            SearchOutcome::Stuck if state.nearest_is_acceptable() => Some(state.stuck()),
            SearchOutcome::Stuck => {
                if !state.enter_restoration() {
                    state.enter_penalty_mode(penalty::PARAMETER);
                }
                None
            }
            SearchOutcome::Tiny | SearchOutcome::Accepted => None,
        };
        if let Some(status) = ended {
            return state.end(status); // 10
        }
        if let Err(status) = state.advance() {
            return state.end(status); // 11
        }
    }
}

impl<N: Nlp> State<'_, N> {
    /// Lines 7 to 9 of Algorithm 11: the step of the present mode, and the search along it.
    fn step_and_search(&mut self) -> SearchOutcome {
        if self.mode.restoration().is_some() {
            return self.restoration_step();
        }
        if self.mode.relaxed().is_some() {
            self.minimise_over_slacks();
            return if self.compute_step() { self.penalty_search() } else { SearchOutcome::Stuck };
        }
        if !self.compute_step() {
            return SearchOutcome::Stuck;
        }
        let is_rounding = self.is_rounding();
        if !self.lower_barrier_along_step() {
            return SearchOutcome::Stuck;
        }
        match self.watched_search() {
            SearchOutcome::Accepted if is_rounding => SearchOutcome::Tiny,
            searched => searched,
        }
    }
}
