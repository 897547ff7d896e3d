//! What a person should know about a report although it is a solution.

use super::{ConstraintReport, Doubt, RefineStatus, Report, hints, jumped};
use crate::digits::brief;
use crate::transcribe::layout::Time;
use crate::transcribe::rows::member_words;
use crate::transcribe::times::phase_words;
use crate::transcribe::{Singular, Transcription};
use ntg_structure::{Block, Independent, Place};
use std::fmt;

/// One thing to know, in words and with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// In words.
    pub message: String,
    /// The expression or constraint; the place of nothing where it concerns the whole solve.
    pub place: Place,
    /// The name of the constraint that is violated between the points; empty for other warnings.
    pub constraint: String,
    /// The mission time, in SI units; none for what belongs to no time.
    pub time: Option<f64>,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Report {
    /// What is to be known beside the status: expressions that are singular at the guess, durations that are as short as
    /// they may be, an objective that is the same all around, variables of an estimate at their bounds, a fit that is worse than its
    /// deviations say, outputs that ran off where there is no solution, more equations than unknowns where they cannot be met, a
    /// simulated motion that the mesh does not follow, a solution that leaves its own equations of motion, constraints of a solution
    /// that are violated between the points by more than `Settings::between_tolerance`, the worst first, and a refinement that has not come to its tolerance.
    pub fn warnings(&self) -> Vec<Warning> {
        let singular = self.singular.iter().map(|singular| Warning {
            message: singular.to_string(),
            place: singular.place.clone(),
            constraint: String::new(),
            time: None,
        });
        let told = self.told.iter().map(|(message, place)| Warning {
            message: message.clone(),
            place: place.clone(),
            constraint: String::new(),
            time: None,
        });
        // What is told already was found at the points of the check.
        let is_new = |pole: &&Singular| !self.told.iter().any(|(_, place)| *place == pole.place);
        let poles = self.poles.iter().filter(is_new).map(|pole| Warning {
            message: hints::in_motion(pole),
            place: pole.place.clone(),
            constraint: String::new(),
            time: None,
        });
        let equation = self.constraints.iter().find(|constraint| constraint.block == Block::Trajectory);
        let coarse = self.simulation.iter().map(|elsewhere| Warning {
            message: elsewhere.words.clone(),
            place: equation.map_or_else(Place::default, |constraint| constraint.place.clone()),
            constraint: String::new(),
            time: None,
        });
        let motion = self.confirmation.iter().filter(|confirmation| matches!(confirmation.doubt, Doubt::Motion(_)));
        let left = motion.map(|confirmation| Warning {
            message: confirmation.words(self.cost()),
            place: equation.map_or_else(Place::default, |constraint| constraint.place.clone()),
            constraint: String::new(),
            time: None,
        });
        let independent = &self.solution.structure().independent;
        let between = self.violated().into_iter().map(|(number, constraint)| {
            let own = self.confirmation.as_ref().filter(|confirmation| confirmation.doubt == Doubt::Limit(number));
            let mut warning = violated_between(constraint, independent);
            warning.message += &own.map_or(String::new(), |own| own.words(self.cost()));
            warning
        });
        let unmet = self.refined.iter().filter(|refined| refined.status != RefineStatus::Met).map(|refined| Warning {
            message: format!("refinement to {:.0e}: {}", refined.tolerance, refined.status),
            place: Place::default(),
            constraint: String::new(),
            time: None,
        });
        let mut cost: Vec<Warning> = self.cost_is_off().into_iter().chain(self.equations_are_off()).collect();
        self.tell_objective(&mut cost);
        singular.chain(told).chain(poles).chain(coarse).chain(left).chain(cost).chain(between).chain(unmet).collect()
    }

    /// Tells that the guess keeps all constraints and has a better objective than what was found.
    pub(crate) fn guess_was_better(&mut self, is_better: bool) {
        let place = || self.solution.structure().terms.first().map_or_else(Place::default, |term| term.place.clone());
        let told = is_better.then(|| {
            let message = "the guess keeps all constraints at the points and has a better objective than what was found, \
                 perhaps another local optimum; try several starts";
            (message.to_owned(), place())
        });
        self.told.extend(told);
    }

    /// What shorter intervals say of the objective: what is measured says more than an estimate to first order.
    fn tell_objective(&self, cost: &mut Vec<Warning>) {
        let own = self.confirmation.as_ref().filter(|confirmation| confirmation.doubt == Doubt::Objective);
        let Some(own) = own else { return };
        let is_silent = cost.is_empty() && !own.status.has_solution();
        if own.is_another(self.cost(), self.between_tolerance) || is_silent {
            let lead = if is_silent { "may depend" } else { "depends" };
            let objective = brief(self.objective);
            let message = format!("the objective, {objective}, {lead} on the mesh{}", own.words(self.cost()));
            *cost = vec![self.of_objective(message)];
        } else if let Some(last) = cost.last_mut() {
            last.message += &own.words(self.cost());
        }
    }

    /// A warning of the objective.
    fn of_objective(&self, message: String) -> Warning {
        let place = self.solution.structure().terms.first().map_or_else(Place::default, |term| term.place.clone());
        Warning { message, place, constraint: String::new(), time: None }
    }

    /// Where the equations that a solution misses between the points are worth more of its objective than
    /// `Settings::between_tolerance`, to first order.
    fn equations_are_off(&self) -> Option<Warning> {
        let part = self.correction_part();
        let is_off = self.meets_points() && part > self.between_tolerance;
        let side = if self.objective_correction < 0.0 { "large" } else { "small" };
        let missed = format!(
            "the objective is about {} too {side}, {} % of the larger: the points are too few for them",
            brief(self.objective_correction.abs()),
            brief((1e3 * part).round() / 10.0)
        );
        // Equations without a value somewhere are missed by no number.
        let missed = match self.objective_correction.is_finite() {
            true => missed,
            false => "how far the objective is off is no number: somewhere they have no value".to_owned(),
        };
        is_off.then(|| self.of_objective(format!("by what equations miss between the points, {missed}")))
    }

    /// Where the objective of a solution and its finer integral differ by more than `Settings::between_tolerance`, relative to
    /// the larger of both.
    pub(super) fn cost_is_off(&self) -> Option<Warning> {
        let (points, fine) = (self.objective, self.objective_fine);
        let apart = self.cost_missed();
        let is_off = self.meets_points() && apart > self.between_tolerance;
        let message = || {
            format!(
                "finely integrated, the objective is {} instead of {}, {} % of the larger: the points are too few for it",
                brief(fine),
                brief(points),
                brief((1e3 * apart).round() / 10.0)
            )
        };
        is_off.then(|| self.of_objective(message()))
    }

    /// The limit of what is continuous that is violated most between the points, by its number, if any is by more than
    /// `Settings::between_tolerance`, with that violation.
    pub(crate) fn limit_in_doubt(&self, nlp: &Transcription) -> Option<(usize, f64)> {
        let mut limits = self.violated().into_iter().filter(|(_, own)| !own.is_equation);
        let (number, worst) = limits.find(|(number, _)| jumped::is_continuous(nlp, *number))?;
        Some((number, worst.between.as_ref()?.relative))
    }

    /// The constraints of a solution that are violated between the points of the transcription by more than
    /// `Settings::between_tolerance`, the worst first; empty where there is no solution.
    pub fn violated_between(&self) -> Vec<&ConstraintReport> {
        self.violated().into_iter().map(|(_, constraint)| constraint).collect()
    }

    /// As [`Report::violated_between`], each with its number.
    fn violated(&self) -> Vec<(usize, &ConstraintReport)> {
        if !self.meets_points() {
            return vec![];
        }
        let relative = |c: &ConstraintReport| c.between.as_ref().map_or(0.0, |worst| worst.relative);
        let is_violated =
            |(_, c): &(usize, &ConstraintReport)| relative(c) > self.between_tolerance || relative(c).is_nan();
        let mut found: Vec<_> = self.constraints.iter().enumerate().filter(is_violated).collect();
        found.sort_by(|(_, a), (_, b)| relative(b).total_cmp(&relative(a)));
        found
    }
}

/// Every duration that ends at the least length that the transcription allows it, where its own bound is below that.
pub(super) fn shortest(nlp: &Transcription, x: &[f64]) -> Vec<(String, Place)> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let ends = nlp.durations.iter().filter_map(|duration| {
        let variable = duration.variable as usize;
        let least = nlp.limits.lower[variable];
        let phase = layout.phases.iter().position(|phase| phase.duration == Time::Free(duration.variable))?;
        let is_by_bound = duration.reach == nlp.limits.upper[variable];
        duration.is_least(&nlp.limits, x).then_some((phase, least, is_by_bound))
    });
    let told = ends.map(|(phase, least, is_by_bound)| {
        let declared = &structure.phases[layout.phases[phase].phase];
        let name = match (&declared.name, &declared.duration_name) {
            (None, Some(name)) => format!("`{name}`"),
            _ => format!("the duration of {}", phase_words(structure, layout, phase)),
        };
        let least = structure.independent.amount(least, brief);
        let message = if is_by_bound {
            format!(
                "{name} is as short as a duration may be, {least}: a millionth of its upper bound; give it a lower bound \
                 above 0, or a smaller upper bound where it should be shorter"
            )
        } else {
            format!(
                "{name} is as short as a duration may be, {least}: next to nothing beside how long its motion takes; give it \
                 a lower bound above 0"
            )
        };
        (message, declared.place.clone())
    });
    told.collect()
}

fn violated_between(constraint: &ConstraintReport, independent: &Independent) -> Warning {
    let worst = constraint.between.as_ref();
    let member = worst.map_or(&[][..], |worst| &worst.indices);
    let mut message = format!("{} is violated between the points", member_words(&constraint.name, member));
    if let Some(worst) = worst {
        message += &format!(" by {}", brief(worst.violation));
        if !constraint.unit.symbol.is_empty() {
            message += &format!(" {}", constraint.unit.symbol);
        }
        message += &format!(" ({:.1e} relative)", worst.relative);
        if let Some(time) = worst.time {
            message += &format!(" at {}", independent.place(time, brief));
        }
        if !worst.phase.is_empty() {
            message += &format!(" in `{}`", worst.phase);
        }
    }
    Warning {
        message,
        place: constraint.place.clone(),
        constraint: constraint.name.clone(),
        time: worst.and_then(|worst| worst.time),
    }
}
