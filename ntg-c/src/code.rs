//! What a function of the C interface returns.

use ntg_runtime::status::Status;
use std::ffi::CStr;

/// How a call ended. The numbers are those of C: they never change their meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// Done; of a solve: there is a new plan, within the tolerances.
    Ok = 0,
    /// There is a new plan, optimal to 1e-6 and not to the tolerances, or stationary and no minimum.
    Acceptable = 1,
    /// A pointer is null.
    Null = 2,
    /// A number is out of its range, or no number.
    BadArgument = 3,
    /// The parameters state no problem: one is not finite, or bounds or conditions contradict each other.
    BadParameter = 4,
    /// Another thread is in a call with this solver.
    Busy = 5,
    /// No nearby point meets all constraints.
    Infeasible = 6,
    /// The iteration limit was reached.
    IterationLimit = 7,
    /// The time limit was reached.
    TimeLimit = 8,
    /// A function is not finite.
    NotFinite = 9,
    /// The objective falls without limit.
    Unbounded = 10,
    /// No further progress: steps too small, or a subproblem that fails.
    NoProgress = 11,
    /// A defect of the library; the solver can only be destroyed.
    Internal = 12,
}

impl Code {
    /// All codes, each at its number.
    pub const ALL: [Self; 13] = [
        Self::Ok,
        Self::Acceptable,
        Self::Null,
        Self::BadArgument,
        Self::BadParameter,
        Self::Busy,
        Self::Infeasible,
        Self::IterationLimit,
        Self::TimeLimit,
        Self::NotFinite,
        Self::Unbounded,
        Self::NoProgress,
        Self::Internal,
    ];

    /// The code of a solver's status.
    pub fn of(status: &Status) -> Self {
        match status {
            Status::Solved => Self::Ok,
            Status::Acceptable | Status::Stationary => Self::Acceptable,
            Status::Infeasible { .. } | Status::ViolatedBetween { .. } => Self::Infeasible,
            Status::IterationLimit => Self::IterationLimit,
            Status::TimeLimit => Self::TimeLimit,
            Status::NotFinite(_) => Self::NotFinite,
            Status::Unbounded => Self::Unbounded,
            Status::Contradiction { .. } => Self::BadParameter,
            Status::Cancelled | Status::StepTooSmall | Status::SubproblemFailed => Self::NoProgress,
        }
    }

    /// Its name in C, without the prefix of the problem.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "OK",
            Self::Acceptable => "ACCEPTABLE",
            Self::Null => "NULL_ARGUMENT",
            Self::BadArgument => "BAD_ARGUMENT",
            Self::BadParameter => "BAD_PARAMETER",
            Self::Busy => "BUSY",
            Self::Infeasible => "INFEASIBLE",
            Self::IterationLimit => "ITERATION_LIMIT",
            Self::TimeLimit => "TIME_LIMIT",
            Self::NotFinite => "NOT_FINITE",
            Self::Unbounded => "UNBOUNDED",
            Self::NoProgress => "NO_PROGRESS",
            Self::Internal => "INTERNAL",
        }
    }

    /// What it means, in words.
    pub fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::Acceptable => {
                c"there is a new plan, optimal to 1e-6 and not to the tolerances, or stationary and no minimum"
            }
            Self::Null => c"a pointer is null",
            Self::BadArgument => c"a number is out of its range, or not a number",
            Self::BadParameter => {
                c"the parameters state no problem: one is not finite, or bounds or conditions contradict each other"
            }
            Self::Busy => c"another thread is in a call with this solver",
            Self::Infeasible => c"no nearby point meets all constraints",
            Self::IterationLimit => c"the iteration limit was reached",
            Self::TimeLimit => c"the time limit was reached",
            Self::NotFinite => c"a function is not finite",
            Self::Unbounded => c"the objective falls without limit",
            Self::NoProgress => c"no further progress: every acceptable step is too small",
            Self::Internal => c"a defect of the library; this solver can only be destroyed",
        }
    }

    /// Whether there is a new plan after a solve that returned it.
    pub fn has_plan(self) -> bool {
        matches!(self, Self::Ok | Self::Acceptable)
    }
}

#[cfg(test)]
mod tests {
    use super::Code;

    #[test]
    fn every_code_stands_at_its_number_and_has_a_name_of_its_own() {
        for (number, code) in Code::ALL.iter().enumerate() {
            assert_eq!(*code as usize, number);
            assert!(!code.text().is_empty());
            assert_eq!(Code::ALL.iter().filter(|other| other.name() == code.name()).count(), 1);
        }
    }
}
