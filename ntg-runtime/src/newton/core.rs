//! The state of a solve, how far it has come, and the steps of the loop that the other files do not
//! hold (docs/maths.md, section 11).

use super::filter::{Filter, LARGEST_THETA};
use super::several::{largest, sum};
use super::sides::{Sides, log_sum};
use super::system::System;
use crate::method::Start;
use crate::nlp::{Limits, Nlp, NotFinite, Scales};
use crate::outcome::IterationRecord;
use crate::settings::Settings;
use crate::status::Status;
use crate::stops::Stage;
use std::time::Instant;

/// The first barrier parameter (scaled): of 1, 0.1, 0.01 and 0.001 the one that took the fewest
/// iterations on the flights of `examples/robustness.rs`.
const FIRST_BARRIER: f64 = 0.01;
/// Where there are more sides than this, the barrier parameter is smaller in proportion: finer points
/// must not weigh more than coarse ones beside an integral, whose weights become smaller.
const MANY_SIDES: f64 = 160.0;
/// How far inside their bounds the first point lies, relative to bound and room.
const INSIDE: f64 = 1e-2;
/// Where the mean multiplier exceeds this, dual residuals are measured relative to it.
const LARGE: f64 = crate::nlp::kkt::LARGE_MULTIPLIER;
/// Most history records for which room is made at once.
const HISTORY: usize = 4096;

/// What one solve needs, sized once; all vectors are scaled.
pub(super) struct Core<'a, N: Nlp> {
    pub(super) nlp: &'a N,
    pub(super) settings: &'a Settings,
    pub(super) system: System<N::Workspace>,
    /// Where the system goes in the end.
    pub(super) memory: &'a mut Memory<N::Workspace>,
    pub(super) sides: Sides,
    /// The variables, and a 0 for nobody.
    pub(super) x: Vec<f64>,
    /// All quantities at `x`.
    pub(super) quantities: Vec<f64>,
    /// Minus the gradient of the Lagrangian, and a 0 for nobody.
    pub(super) descent: Vec<f64>,
    /// Multipliers of all quantities.
    pub(super) multipliers: Vec<f64>,
    pub(super) mu: f64,
    /// What residuals are relative to, equation (6.5).
    pub(super) relax: f64,
    /// What barrier parameters are relative to.
    pub(super) unit: f64,
    pub(super) filter: Filter,
    /// A point that met all tolerances.
    pub(super) best: super::polish::Best,
    /// The share of what makes elements convex that the last matrix needed.
    pub(super) share: f64,
    /// Set once bounds are elastic.
    pub(super) elastic: Option<super::elastic::Elastic>,
    pub(super) step: super::direction::Direction,
    /// Room for a direction that is returned to.
    pub(super) kept: super::direction::Direction,
    /// A trial point: variables, quantities, distances.
    pub(super) trial: Trial,
    pub(super) record: IterationRecord,
    pub(super) history: Vec<IterationRecord>,
    pub(super) iterations: usize,
    pub(super) begin: Instant,
}

/// What one solve leaves to the next: the plans of the last program and its workspace. They are made anew
/// where the next program differs in more than its numbers.
pub struct Memory<W> {
    pub(super) system: Option<System<W>>,
    /// Whether the next program has the very numbers of the last one, but for the sizes of its variables.
    pub(crate) is_same_program: bool,
}

impl<W> Default for Memory<W> {
    fn default() -> Self {
        Self { system: None, is_same_program: false }
    }
}

/// A point that is tried.
#[derive(Clone, Debug, Default)]
pub(super) struct Trial {
    pub(super) x: Vec<f64>,
    pub(super) quantities: Vec<f64>,
    pub(super) w: Vec<f64>,
    /// Distances in truth.
    pub(super) d: Vec<f64>,
    /// The multipliers with which derivatives were computed there.
    pub(super) multipliers: Vec<f64>,
    /// Whether the last trial has derivatives.
    pub(super) is_ahead: bool,
    /// Whether the first trial of the last search was accepted: then derivatives are computed at once.
    pub(super) was_good: bool,
    /// Why the last trial had no value.
    pub(super) failure: Option<NotFinite>,
}

impl Trial {
    fn new(x: &[f64], quantities: usize, w: Vec<f64>) -> Self {
        let quantities = vec![0.0; quantities];
        let (d, multipliers) = (w.clone(), quantities.clone());
        Self { x: x.to_vec(), quantities, w, d, multipliers, is_ahead: false, was_good: true, failure: None }
    }
}

impl<'a, N: Nlp> Core<'a, N> {
    /// Plans a program, moves `start` inside its bounds, and evaluates there.
    pub(super) fn new(
        nlp: &'a N,
        start: &[f64],
        from: Start<'_>,
        settings: &'a Settings,
        memory: &'a mut Memory<N::Workspace>,
    ) -> Result<Self, NotFinite> {
        let begin = Instant::now();
        let mut system = System::for_program(memory.system.take(), nlp, memory.is_same_program);
        let n = nlp.variables();
        let sizes = Scales::sizes(nlp.limits());
        let mut x: Vec<f64> = start.iter().zip(&sizes).map(|(x, size)| x / size).collect();
        x.push(0.0);
        move_inside(
            &mut x,
            nlp.limits(),
            &sizes,
            if matches!(from, Start::Cold) { INSIDE } else { super::warm::INSIDE },
        );
        system.rescale(nlp, &x, settings.scaling)?;
        let sides = Sides::new(&system.scales.limits(nlp.limits()), system.first_variable());
        system.find_equalities(&sides.equality);
        let unit = (MANY_SIDES / sides.side.len().max(1) as f64).min(1.0);
        let count = system.quantities();
        let (step, rows) = (super::direction::Direction::new(n, count, &sides, &system), sides.w.clone());
        let mut core = Self {
            nlp,
            settings,
            memory,
            quantities: vec![0.0; count],
            descent: vec![0.0; n + 1],
            multipliers: vec![0.0; count],
            mu: FIRST_BARRIER * unit,
            relax: 1.0,
            unit,
            filter: Filter::for_iterations(settings.max_iterations.min(HISTORY)),
            best: super::polish::Best::new(&x, &sides),
            kept: step.clone(),
            elastic: None,
            share: super::direction::FIRST_SHARE,
            step,
            trial: Trial::new(&x, count, rows),
            record: IterationRecord::default(),
            history: Vec::with_capacity(settings.max_iterations.min(HISTORY) + 1),
            iterations: 0,
            begin,
            x,
            sides,
            system,
        };
        core.start(from)?;
        Ok(core)
    }

    /// First distances, multipliers and derivatives.
    fn start(&mut self, from: Start<'_>) -> Result<(), NotFinite> {
        // The scales were chosen by derivatives at this point.
        self.system.quantities_here(&self.x, &mut self.quantities);
        self.sides.look(&self.quantities);
        match (from, from.multipliers(self.nlp)) {
            (_, Some(from)) => self.start_warm(from),
            (Start::Cold, None) => self.start_at(FIRST_BARRIER, INSIDE),
            (Start::Near | Start::Warm(_), None) => self.start_at(super::warm::NEAR_BARRIER, super::warm::INSIDE),
        }
        self.evaluate()?;
        self.reset_filter();
        Ok(())
    }

    /// Distances and multipliers of a point about which nothing is known but how near it is.
    fn start_at(&mut self, barrier: f64, inside: f64) {
        self.mu = barrier * self.unit;
        self.sides.place(inside);
        for (z, w) in self.sides.z.iter_mut().zip(&self.sides.w) {
            *z = self.mu / w;
        }
        self.estimate_multipliers();
    }

    /// Derivatives at the present point with the present multipliers.
    pub(super) fn evaluate(&mut self) -> Result<(), NotFinite> {
        self.sides.multipliers(self.system.objective(), &mut self.multipliers);
        if std::mem::take(&mut self.trial.is_ahead) && self.multipliers == self.trial.multipliers {
            std::mem::swap(&mut self.quantities, &mut self.trial.quantities);
            std::mem::swap(&mut self.sides.d, &mut self.trial.d);
            self.system.move_ahead();
            return Ok(());
        }
        self.system.derivatives(self.nlp, &self.x, &self.multipliers, &mut self.quantities)?;
        self.sides.look(&self.quantities);
        Ok(())
    }

    /// Starts a filter at the present point.
    pub(super) fn reset_filter(&mut self) {
        let theta = self.theta();
        self.filter.clear();
        self.filter.limit = LARGEST_THETA * theta.max(1.0);
    }

    /// Infeasibility of the present point.
    pub(super) fn theta(&self) -> f64 {
        self.sides.infeasibility(&self.quantities, (&self.sides.d, &self.sides.w))
    }

    /// The barrier objective of a point.
    pub(super) fn phi(&self, quantities: &[f64], w: &[f64]) -> f64 {
        quantities[self.system.objective()] - self.mu * log_sum(w)
    }

    /// Computes the gradient of the Lagrangian and the residuals of the present point.
    pub(super) fn measure(&mut self) {
        self.system.gradient(&self.multipliers, &mut self.descent);
        self.relax = self.relaxation();
        let relax = self.relax;
        let mut residuals = crate::status::Residuals::default();
        residuals.scaled.primal = self.sides.violation(&self.quantities);
        residuals.scaled.dual = self.dual() / relax;
        residuals.scaled.complementarity = self.sides.complementarity() / relax;
        self.record = IterationRecord {
            objective: self.quantities[self.system.objective()] / self.system.scales.objective,
            residuals,
            exact: true,
            barrier: self.mu,
            ..IterationRecord::default()
        };
    }

    fn dual(&self) -> f64 {
        let finite = sum([&self.descent], |[g]| g).is_finite();
        if finite { largest([&self.descent], |[g]| g.abs()) } else { f64::INFINITY }
    }

    /// Equation (6.5).
    fn relaxation(&self) -> f64 {
        let (sum, count) = self.sides.multiplier_sum();
        if count > 0.0 { (sum / count / LARGE).max(1.0) } else { 1.0 }
    }

    /// Whether the solve is over, and why.
    pub(super) fn stops(&self) -> Option<Status> {
        let Self { settings, record, history, iterations, begin, x, .. } = self;
        let objective = self.quantities[self.system.objective()];
        Stage { settings, record, history, iterations: *iterations, begin: *begin, objective, x }.stops()
    }
}

/// Moves variables inside their bounds, by a fraction of the room at most.
fn move_inside(x: &mut [f64], limits: &Limits, sizes: &[f64], inside: f64) {
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
