//! What solves on shorter intervals say of a solution that leaves its own equations of motion (docs/maths.md, section 9).

use super::cost::cost_apart;
use crate::digits::brief;
use crate::status::Status;

/// What solves on intervals half as long, and half as long again, have found.
#[derive(Clone, Debug, PartialEq)]
pub struct Confirmation {
    /// The output that leaves its equations most.
    pub output: String,
    /// By how much it does, relative to what it varies by (docs/maths.md, equation 9.3d), and the largest such defect of each
    /// solution on shorter intervals; infinite where a motion cannot be followed.
    pub defects: Vec<f64>,
    /// How often intervals were halved.
    pub halvings: usize,
    /// How the last solve ended.
    pub status: Status,
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

    /// Whether the last defect is that of a motion which is met better and better.
    pub(crate) fn falls(&self) -> bool {
        self.defects.windows(2).all(|pair| pair[1] <= Self::FALLS * pair[0])
    }

    /// Objectives on shorter intervals that differ by more than this part of the larger are those of other curves. A choice: of
    /// 199 specs none differs by more than 0.06.
    const APART: f64 = 0.25;

    /// Whether the solution is one of the points alone, as far as is known: nothing like it was found on shorter intervals.
    /// `objective` is that of the solution.
    pub fn refutes(&self, objective: f64) -> bool {
        match self.status.has_solution() {
            true => !self.falls() || cost_apart(objective, self.objective) > Self::APART,
            false => self.status != Status::Cancelled,
        }
    }

    /// What a person should know.
    pub(super) fn words(&self, objective: f64) -> String {
        let percent = |part: &f64| match part.is_finite() {
            true => format!("by {} %", brief((1e3 * part).round() / 10.0)),
            false => "by more than can be followed".to_owned(),
        };
        let left = format!(
            "`{}` leaves its equations of motion: simulated from the start of each interval with the solution's inputs, it misses \
             the ends {} of its variation in all",
            self.output,
            self.defects.first().map_or(String::new(), percent)
        );
        let length = match self.halvings {
            1 => "half as long".to_owned(),
            2 => "a quarter as long".to_owned(),
            halvings => format!("1/{} as long", 1_usize << halvings),
        };
        let last = self.defects.get(1..).and_then(<[f64]>::last).map_or(String::new(), percent);
        let found = format!("{last}, where the objective is {}", brief(self.objective));
        let doubt = "the points are too few, and what is asked may be out of reach";
        match (self.status.has_solution(), self.refutes(objective)) {
            (true, false) => format!("{left}; on intervals {length} {found}"),
            (true, true) => format!("{left}; on intervals {length} {found}: {doubt}"),
            (false, true) if self.status == Status::TimeLimit => {
                format!("{left}; the time limit leaves no time to see whether that vanishes on intervals {length}")
            }
            (false, true) => {
                format!("{left}; on intervals {length} nothing was found ({}): {doubt}", self.status.label())
            }
            (false, false) => {
                format!("{left}; a solve on intervals {length} was cancelled before it told whether that vanishes")
            }
        }
    }
}
