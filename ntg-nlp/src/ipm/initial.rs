//! The first iterate (docs/maths.md, sections 11.4, 11.7 and 11.8; line 1 of Algorithm 11).

use super::best::Point;
use super::conjugate_residuals::ConjugateResiduals;
use super::equalities::Estimate;
use super::filter::{Filter, LARGEST_THETA};
use super::inertia::Corrections;
use super::last_barrier::LastBarrier;
use super::mode::Mode;
use super::slacks::{BoundSizes, Slacks};
use super::stagnation::Stagnation;
use super::state::{Kept, State, Trial};
use super::step::{LARGEST_PROXIMAL, Step};
use super::warm;
use super::watchdog::Watchdog;
use crate::contract::{Limits, Nlp, NotFinite};
use crate::kkt::System;
use crate::options::{Method, Options};
use crate::outcome::{IterationRecord, Start};
use crate::residuals::slot_terms;
use crate::scaling::Scales;
use crate::status::Status;
use std::time::Instant;

/// The first barrier parameter, relative to its unit. WB, section 4: 0.1. A fit to the gallery and to the fleets of
/// `multi_vehicle_separated`: with a larger one the barrier leads away from the minimum that the guess means, with a
/// smaller one the first steps hit the bounds.
const FIRST_BARRIER: f64 = 0.03;
/// That of a program whose inequalities are measured by their bounds. WB, section 4.
const FIRST_BARRIER_BY_BOUNDS: f64 = 0.1;
/// Where there are more inequalities than this, barrier parameters and first multipliers are smaller in proportion: more
/// points of collocation must not weigh more beside an integral, whose weights become smaller. The number itself is a
/// fit to the flights of `examples/robustness.rs`.
const MANY_INEQUALITIES: f64 = 160.0;
/// How far inside their bounds the first point lies, relative to the bound and to the room between bounds. WB, section
/// 3.6: kappa_1 = kappa_2 = 1e-2.
const INSIDE: f64 = 1e-2;
/// Most history records for which memory is reserved at once.
const HISTORY: usize = 4096;

impl<'a, N: Nlp> State<'a, N> {
    /// Analyses and scales a program, moves `start` inside its bounds, and evaluates there.
    ///
    /// # Errors
    /// The status of a solve whose start has no finite values or derivatives.
    pub(super) fn new(
        nlp: &'a N,
        start: &[f64],
        from: Start<'_>,
        options: &'a Options,
        kept: &'a mut Kept<N::Workspace>,
    ) -> Result<Self, Status> {
        let begin = Instant::now();
        let mut system = System::for_program(kept.system.take(), nlp, kept.is_unchanged, vec![false; nlp.variables()]);
        let n = nlp.variables();
        let sizes = Scales::sizes(nlp.limits());
        let mut x: Vec<f64> = start.iter().zip(&sizes).map(|(x, size)| x / size).collect();
        x.push(0.0);
        let inside = if matches!(from, Start::Cold) { INSIDE } else { warm::INSIDE };
        push_inside_bounds(&mut x, nlp.limits(), &sizes, inside);
        if options.is_overdue(begin) {
            return Err(Status::TimeLimit);
        }
        if let Err(what) = system.choose_scales(nlp, &x, options.scaling) {
            return Err(Status::NotFinite { what, x: system.last_point().to_vec() });
        }
        let slacks = Slacks::new(&system.scales.limits(nlp.limits()), system.first_variable());
        system.mark_equalities(slacks.equalities.iter().map(|equality| equality.function));
        let barrier_unit = (MANY_INEQUALITIES / slacks.inequalities.len().max(1) as f64).min(1.0);
        let functions = system.functions();
        let step = Step::new(n, functions, &slacks, system.border_rows().len());
        let mut state = Self {
            nlp,
            options,
            kept,
            values: vec![0.0; functions],
            negative_gradient: vec![0.0; n + 1],
            multipliers: vec![0.0; functions],
            mu: FIRST_BARRIER * barrier_unit,
            s_d: 1.0,
            slot_terms: slot_terms(nlp.blocks()),
            terms: vec![0.0; nlp.variables()],
            barrier_unit,
            filter: Filter::with_capacity(options.max_iterations.min(HISTORY)),
            best: Point::new(&x, &slacks),
            solved_at: 0,
            nearest: Point::new(&x, &slacks),
            before_step: Point::new(&x, &slacks),
            watchdog: Watchdog::new(Point::new(&x, &slacks)),
            saved_step: step.clone(),
            conjugate_residuals: ConjugateResiduals::new(n + 1, slacks.equalities.len()),
            mode: Mode::Filter,
            restorations: 0,
            stagnation: Stagnation::default(),
            short_steps: 0,
            estimate: Estimate::default(),
            proximal: LARGEST_PROXIMAL,
            corrections: Corrections::default(),
            crawl: Stagnation::default(),
            step,
            trial: Trial::new(&x, functions, slacks.s.clone()),
            record: IterationRecord::default(),
            history: Vec::with_capacity(options.max_iterations.min(HISTORY) + 1),
            iterations: 0,
            begin,
            size_limits: vec![],
            is_damped: false,
            last: LastBarrier::default(),
            is_warm: matches!(from, Start::Warm(_)),
            x,
            slacks,
            system,
        };
        if options.is_overdue(begin) {
            return Err(Status::TimeLimit);
        }
        match state.initialise(from) {
            Ok(()) => Ok(state),
            Err(what) => Err(state.not_finite(what)),
        }
    }

    /// First slacks, multipliers and derivatives.
    fn initialise(&mut self, from: Start<'_>) -> Result<(), NotFinite> {
        // The scales were chosen by derivatives at this point, so the values are known.
        self.system.latest_values(&self.x, &mut self.values);
        self.slacks.update_distances(&self.values);
        match (from, from.multipliers(self.nlp)) {
            (_, Some(from)) => self.start_warm(from),
            (Start::Cold, None) => self.start_without_multipliers(self.first_barrier()),
            (Start::Near | Start::Warm(_), None) => self.start_without_multipliers(self.near_barrier()),
        }
        self.evaluate()?;
        self.start_filter();
        if self.options.method == Method::AugmentedLagrangian {
            self.enter_augmented_mode();
        }
        Ok(())
    }

    /// Slacks and multipliers of a point whose multipliers are not known. `barrier` is relative to its unit.
    fn start_without_multipliers(&mut self, barrier: f64) {
        self.mu = barrier * self.barrier_unit;
        let first = self.first_barrier();
        self.slacks.initialise(INSIDE * barrier / first, self.bound_sizes());
        let (mu, most) = (self.mu, self.barrier_unit); // WB, section 3.6: 1.
        let is_near = barrier < first;
        let by_bounds = self.system.scales.by_bounds;
        for (z, s) in self.slacks.z.iter_mut().zip(&self.slacks.s) {
            *z = match is_near {
                true => mu / s,
                false if by_bounds => most.max(mu / s),
                false => most,
            };
        }
        self.estimate_equality_multipliers();
    }

    /// The first barrier parameter of a guess, relative to its unit.
    pub(super) fn first_barrier(&self) -> f64 {
        if self.system.scales.by_bounds { FIRST_BARRIER_BY_BOUNDS } else { FIRST_BARRIER }
    }

    /// What first slacks are relative to.
    pub(super) fn bound_sizes(&self) -> BoundSizes {
        if self.system.scales.by_bounds { BoundSizes::Own } else { BoundSizes::AtLeastOne }
    }

    /// Starts a filter at the present point.
    pub(super) fn start_filter(&mut self) {
        let theta = self.theta();
        self.filter.clear();
        self.filter.theta_max = LARGEST_THETA * theta.max(1.0);
        self.filter.residuals = self.slacks.inequalities.len();
    }
}

/// Moves variables inside their bounds, by a fraction of the room between the bounds at most. WB, section 3.6.
fn push_inside_bounds(x: &mut [f64], limits: &Limits, sizes: &[f64], inside: f64) {
    for (j, size) in sizes.iter().enumerate() {
        let (lower, upper) = (limits.lower[j] / size, limits.upper[j] / size);
        let room = inside * (upper - lower);
        let margin = |bound: f64| (inside * bound.abs().max(1.0)).min(room);
        if lower.is_finite() {
            x[j] = x[j].max(lower + margin(lower));
        }
        if upper.is_finite() {
            x[j] = x[j].min(upper - margin(upper));
        }
    }
}
