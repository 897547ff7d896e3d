//! What solves on shorter intervals say of a solution that leaves its own equations of motion, its limits between the points, or
//! the objective that it has there (docs/maths.md, section 9).

use super::ending::Missed;
use super::{Cost, Resolution};
use crate::digits::brief;
use crate::status::Status;

/// What a solution may not keep although it keeps it at the points.
#[derive(Clone, Debug, PartialEq)]
pub enum Doubt {
    /// Its equations of motion: the output that leaves them most.
    Motion(String),
    /// A limit of what is continuous: of those the one that is missed most between the points, by its number in
    /// [`Report::constraints`](crate::report::Report).
    Limit(usize),
    /// Its objective: with what equations miss between the points it is another one, or equations are missed of a motion that
    /// cannot be simulated, since they do not decide the highest derivatives.
    Objective,
}

/// What solves on intervals half as long, and half as long again, have found.
#[derive(Clone, Debug, PartialEq)]
pub struct Confirmation {
    /// What is in doubt.
    pub doubt: Doubt,
    /// By how much it is missed by the solution, and by each on shorter intervals. An output leaves its equations relative to
    /// what it varies by (docs/maths.md, equation 9.3d), infinitely where a motion cannot be followed; a limit is missed
    /// relative to the scale of its bounds (9.3), an objective relative to the larger one.
    pub missed: Vec<f64>,
    /// How often intervals were halved.
    pub halvings: usize,
    /// How the last solve ended.
    pub status: Status,
    /// How far what it found is a solution of the problem; nothing where it found none.
    pub resolution: Option<Resolution>,
    /// Its objective, in the user's sense and unit.
    pub objective: f64,
    /// Iterations on shorter intervals, which are not among those of the report.
    pub iterations: usize,
    /// Seconds of the confirmation, which are among those of the report.
    pub seconds: f64,
}

impl Confirmation {
    /// A defect that is not below this part of itself on intervals half as long does not vanish on fine ones. The defect of a
    /// motion falls with the length of intervals where its inputs jump within them, to half. A fit: of 199 specs 14 have a
    /// defect of 1 % and more, which falls to 0.59 and less but for `pmsm`, which oscillates between all points and is
    /// unresolved by itself; that of a goal out of reach falls at most by chance.
    const FALLS: f64 = 0.7;

    /// Whether one more solve, on intervals half as long again, has something to tell. `cost` is the objective of the solution,
    /// `tolerance` what is worth a warning. A limit is missed less on shorter intervals wherever it can be kept, but how fast
    /// the miss falls tells nothing: it does not at all where what is limited would jump, as an acceleration. The objective
    /// does: the way through what is closed hangs on the length of the intervals.
    pub(crate) fn asks_more(&self, cost: Cost, tolerance: f64) -> bool {
        match self.doubt {
            Doubt::Motion(_) => self.falls() && self.missed.last() > Some(&tolerance),
            Doubt::Limit(_) | Doubt::Objective if self.halvings == 0 => true,
            Doubt::Limit(_) | Doubt::Objective => !self.refutes(cost) && cost.apart(self.objective) > tolerance,
        }
    }

    /// Whether the last defect is that of a motion which is met better and better.
    fn falls(&self) -> bool {
        self.missed.windows(2).all(|pair| pair[1] <= Self::FALLS * pair[0])
    }

    /// Objectives on shorter intervals that differ by more than this part of the larger are those of other curves. A choice: of
    /// 199 specs none differs by more than 0.06.
    const APART: f64 = 0.25;

    /// Where so much is in doubt, objectives that differ by more than this are those of other motions. A law: what is worth a warning.
    const OTHER: f64 = 0.01;

    /// Whether so much of the solution is in doubt that any other objective refutes it: more than half of what an output varies by, a
    /// quarter of the objective or of the decades that an output runs through. Choices.
    fn is_gross(&self) -> bool {
        let most = if matches!(self.doubt, Doubt::Objective) { Self::APART } else { Missed::GROSS };
        self.missed.first().is_some_and(|missed| *missed > most)
    }

    /// Whether the solution is one of the points alone, as far as is known: nothing like it was found on shorter intervals.
    /// `cost` is the objective of the solution.
    pub fn refutes(&self, cost: Cost) -> bool {
        let is_apart = || cost.apart(self.objective) > Self::APART;
        match (&self.doubt, self.status.has_solution()) {
            (Doubt::Motion(_), true) => {
                !self.falls() || is_apart() || self.is_gross() && cost.apart(self.objective) > Self::OTHER
            }
            (Doubt::Motion(_), false) => self.status != Status::Cancelled,
            (Doubt::Objective, true) => is_apart() || self.is_gross() && cost.apart(self.objective) > Self::OTHER,
            (Doubt::Limit(_), true) => self.resolution == Some(Resolution::Unresolved) || is_apart(),
            // A solve that comes to no end tells nothing of a limit, nor of an objective that is little in doubt.
            (Doubt::Limit(_), false) => matches!(self.status, Status::Infeasible { .. } | Status::Contradiction { .. }),
            (Doubt::Objective, false) => self.is_gross() && self.status != Status::Cancelled,
        }
    }

    /// Whether the objective on shorter intervals is another one than `cost` by more than `tolerance`, or nothing is.
    pub(super) fn is_another(&self, cost: Cost, tolerance: f64) -> bool {
        self.refutes(cost) || self.status.has_solution() && cost.apart(self.objective) > tolerance
    }

    /// What a person should know; of a limit, and of an objective, what follows upon how it is missed.
    pub(super) fn words(&self, cost: Cost) -> String {
        let percent = |part: &f64| match part.is_finite() {
            true => format!("by {} %", brief((1e3 * part).round() / 10.0)),
            false => "by more than can be followed".to_owned(),
        };
        let first = self.missed.first().map_or(String::new(), percent);
        let left = match &self.doubt {
            Doubt::Motion(output) => format!(
                "`{output}` leaves its equations of motion: simulated from the start of each interval with the solution's inputs, \
                 it misses the ends {first} of its variation in all"
            ),
            // What is missed is told before.
            Doubt::Limit(_) | Doubt::Objective => String::new(),
        };
        let length = match self.halvings {
            1 => "half as long".to_owned(),
            2 => "a quarter as long".to_owned(),
            halvings => format!("1/{} as long", 1_usize << halvings),
        };
        let last = self.missed.get(1..).and_then(<[f64]>::last).map_or(String::new(), percent);
        let found = match self.doubt {
            Doubt::Objective => format!("it is {}", brief(self.objective)),
            _ => format!("{last}, where the objective is {}", brief(self.objective)),
        };
        let doubt = match self.doubt {
            Doubt::Objective => "more points in each interval are needed, or more intervals",
            _ => "the points are too few, and what is asked may be out of reach",
        };
        match (self.status.has_solution(), self.refutes(cost)) {
            (true, false) => format!("{left}; on intervals {length} {found}"),
            (true, true) => format!("{left}; on intervals {length} {found}: {doubt}"),
            (false, true) if self.status == Status::TimeLimit => {
                format!("{left}; the time limit leaves no time to see whether that vanishes on intervals {length}")
            }
            (false, true) => {
                format!("{left}; on intervals {length} nothing was found ({}): {doubt}", self.status.label())
            }
            (false, false) => {
                format!(
                    "{left}; a solve on intervals {length} did not end ({}): it does not tell whether that vanishes",
                    self.status.label()
                )
            }
        }
    }
}
