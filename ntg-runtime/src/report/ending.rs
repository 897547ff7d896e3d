//! How a solve ended, as the heads of texts, pages and files say it: what is missed between the points is no good end.

use super::Cost;
use super::{Confirmation, Report};
use crate::settings::Settings;
use crate::status::Status;
use crate::transcribe::names;
use ntg_splines::Side;

/// How far a solution of the transcription is one of the problem itself: what the check on the finer grid found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Resolution {
    /// Nothing is missed between the points by more than is worth a warning.
    #[default]
    Fine,
    /// Something is missed by more than [`Settings::between_tolerance`](crate::settings::Settings).
    Coarse,
    /// The solution is one of the points alone: see [`Missed::is_unresolved`].
    Unresolved,
}

/// What a solution misses between the points, relative to the size of what is missed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Missed {
    /// A constraint: by how much where it is missed most, and in the mean over all times, of which only those count at which
    /// it is missed by more than half ([`ConstraintReport::mean_between`](super::ConstraintReport::mean_between)).
    Constraint {
        /// Where it is missed most.
        most: f64,
        /// In the mean.
        mean: f64,
    },
    /// A limit of which the mean is not known, where it is missed most.
    Limit(f64),
    /// The objective and its finer integral, or the objective without and with its correction, differ by this part of the
    /// larger of both.
    Objective(f64),
}

impl Missed {
    /// What of an equation is a violation that counts for the mean.
    pub(super) const GROSS: f64 = 0.5;

    /// The largest violation or difference.
    fn most(self) -> f64 {
        match self {
            Self::Constraint { most, .. } | Self::Limit(most) | Self::Objective(most) => most,
        }
    }

    /// Whether so much is missed that the points say nothing of what is between them. An equation that is missed by half of
    /// its size or more, now here and now there, holds nowhere but at the points; in one interval of many that is an input
    /// that jumps there, as a thrust that turns round does; so it is for a limit of what jumps, which a polynomial through points
    /// within it leaves by as much as it has jumped. A limit of what does not jump, of which more than half is missed, is jumped: a
    /// path through a disc along a diameter misses `x^2 + y^2 >= R^2` by all of it. An objective of which less than half is
    /// counted is that of other curves. Choices, between the thrust reversals of the gallery on ten intervals and aliased
    /// oscillations, which miss their equations by 0.5 and more in the mean.
    pub fn is_unresolved(self) -> bool {
        let (missed, most) = match self {
            Self::Constraint { mean, .. } => (mean, 0.05),
            Self::Limit(most) | Self::Objective(most) => (most, 0.5),
        };
        missed > most || missed.is_nan() || self.most().is_nan()
    }
}

impl Resolution {
    /// The worst of all that is missed; `tolerance` is what is worth a warning.
    pub fn of(missed: impl IntoIterator<Item = Missed>, tolerance: f64) -> Self {
        let of_one = |missed: Missed| match missed {
            missed if missed.is_unresolved() => Self::Unresolved,
            missed if missed.most() > tolerance => Self::Coarse,
            _ => Self::Fine,
        };
        missed.into_iter().map(of_one).max().unwrap_or_default()
    }

    /// The resolution in one word, as files have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::Coarse => "coarse",
            Self::Unresolved => "unresolved",
        }
    }

    /// What [`Self::word`] gave; nothing for any other word.
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Fine, Self::Coarse, Self::Unresolved].into_iter().find(|resolution| resolution.word() == word)
    }

    /// The status of a solution, and how much of it holds between the points.
    pub fn ending(self, status: &str) -> String {
        match self {
            Self::Fine => status.to_owned(),
            Self::Coarse => format!("{status} at the points"),
            Self::Unresolved => format!("{status} at the points, and not between them"),
        }
    }
}

/// Where a simulation leads that does not follow the motion that was found, of a problem without an objective.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elsewhere {
    /// How far apart both are in the output in which they are most, relative to its size.
    pub(crate) apart: f64,
    /// The same in words.
    pub(crate) words: String,
}

impl Elsewhere {
    /// A motion that is to be found alone and is apart from its own simulation by more than this part of its size is none. A
    /// choice, that of objectives on shorter intervals ([`Confirmation`]).
    const OTHER: f64 = 0.25;
}

impl Report {
    /// How far the solution of the points is one of the problem; nothing where there is no solution.
    pub fn resolution(&self) -> Option<Resolution> {
        if !self.has_solution() {
            return None;
        }
        let constraints = self.constraints.iter().filter_map(|constraint| {
            let most = constraint.between.as_ref()?.relative;
            let mean = constraint.mean_between;
            Some(Missed::Constraint { most, mean })
        });
        let cost = Missed::Objective(self.cost_missed());
        let equations = Missed::Objective(self.correction_part());
        let refutes = |confirmation: &Confirmation| confirmation.refutes(self.cost());
        let is_elsewhere = self.simulation.as_ref().is_some_and(|simulated| simulated.apart > Elsewhere::OTHER);
        if is_elsewhere || !self.poles.is_empty() || self.confirmation.as_ref().is_some_and(refutes) {
            return Some(Resolution::Unresolved);
        }
        Some(Resolution::of(constraints.chain([cost, equations]), self.between_tolerance))
    }

    /// The objective, to be compared with other values of it.
    pub fn cost(&self) -> Cost {
        Cost { value: self.objective, zero: self.objective_zero }
    }

    /// What equations that are missed between the points are worth of the objective, as a part of the larger of the
    /// objectives without and with it.
    pub(crate) fn correction_part(&self) -> f64 {
        self.cost().apart(self.objective + self.objective_correction)
    }

    /// How far the objective is from its finer integral, as a part of the larger of both; after refinement as that has
    /// measured it.
    pub(super) fn cost_missed(&self) -> f64 {
        match &self.refined {
            None => self.cost().apart(self.objective_fine),
            Some(refined) => {
                let own = refined.rounds.iter().rev().find(|round| round.fine == self.objective_fine);
                own.map_or(0.0, |round| round.quadrature)
            }
        }
    }

    /// The report with advice where its solution is one of the points alone.
    pub(crate) fn advised(mut self) -> Self {
        if self.resolution() == Some(Resolution::Unresolved) && self.advice.is_empty() {
            "Use more points or intervals, let the mesh be refined (`refine`, `between`), or look for another minimum \
             (`starts`): what was found solves the problem at the points only, and not between them."
                .clone_into(&mut self.advice);
            if let Some((output, decades)) = self.many_decades() {
                self.advice += &format!(
                    " `{output}` runs through {decades:.0} decades: write its logarithm as the state, whose rate is `der({output}) / {output}`."
                );
            }
        }
        self
    }

    /// The state that keeps its sign and runs through the most decades, where these are many, and how many.
    fn many_decades(&self) -> Option<(String, f64)> {
        /// A choice, that of the defect in decades (9.3e).
        const MANY: f64 = 3.0;
        let (structure, inner) = (self.solution.structure(), &self.solution.inner);
        let layout = &inner.model.layout;
        let mut found: Option<(String, f64)> = None;
        for (phase, member) in layout.phases.iter().enumerate() {
            for (output, own) in member.outputs.iter().enumerate() {
                let declared = &structure.phases[member.phase].outputs[own.output];
                // Between the ends of intervals what is solved at the points alone may have any sign.
                let values = member.breakpoints.iter().map(|tau| {
                    let side = if *tau == 0.0 { Side::Right } else { Side::Left };
                    layout.flat(phase, output, 0, (*tau, side), &inner.x)
                });
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
                let decades = (high / low).log10().abs();
                let is_most = found.as_ref().is_none_or(|(_, most)| decades > *most);
                if declared.spline.smoothness > 0
                    && !declared.is_helper()
                    && low * high > 0.0
                    && decades > MANY
                    && is_most
                {
                    found = Some((names::output(structure, layout, phase, output), decades));
                }
            }
        }
        found
    }

    /// The report with advice where nothing but the time limit has kept its solution from the tolerances.
    pub(crate) fn advised_of_time(mut self, settings: &Settings) -> Self {
        let is_late = settings.time_limit.is_some_and(|limit| self.seconds >= limit.as_secs_f64());
        if is_late && self.status == Status::Acceptable {
            "The time limit was reached: allow more (`time_limit`) for a solution to the tolerances."
                .clone_into(&mut self.advice);
        }
        self
    }

    /// The status in a word or in words; of a solution also whether it holds between the points.
    pub fn ending(&self) -> String {
        let status = self.status.label();
        self.resolution().map_or_else(|| status.clone(), |resolution| resolution.ending(&status))
    }
}

#[cfg(test)]
mod tests {
    use super::{Missed, Resolution};

    #[test]
    fn a_head_says_what_does_not_hold_between_the_points() {
        let ending = |missed: &[Missed]| Resolution::of(missed.iter().copied(), 0.01).ending("solved");
        let equation = |most: f64, mean: f64| Missed::Constraint { most, mean };
        assert_eq!(ending(&[]), "solved");
        assert_eq!(ending(&[equation(1e-6, 0.0), Missed::Objective(0.009)]), "solved");
        assert_eq!(ending(&[equation(1.3, 0.02), Missed::Limit(0.4)]), "solved at the points");
        let gross = [equation(1.1, 0.3), Missed::Limit(0.6), Missed::Objective(0.6), Missed::Limit(f64::NAN)];
        for gross in gross {
            assert_eq!(ending(&[Missed::Limit(0.02), gross]), "solved at the points, and not between them");
        }
    }

    #[test]
    fn words_come_back() {
        for resolution in [Resolution::Fine, Resolution::Coarse, Resolution::Unresolved] {
            assert_eq!(Resolution::from_word(resolution.word()), Some(resolution));
        }
        assert_eq!(Resolution::from_word("solved"), None);
    }
}
