//! When a set-up is to have ended, where the time of a call is limited (docs/maths.md, section 11.9).
//!
//! A set-up that ends soon after the limit gives a report of its first point; one that does not ends where it is.

use super::error::SetupError;
use std::time::{Duration, Instant};

/// So long after its limit a set-up may end. A choice: what a person does not notice.
const GRACE: Duration = Duration::from_millis(100);

/// When a set-up is to have ended; never where nothing limits it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Deadline(Option<Instant>);

impl Deadline {
    /// Of a call that begins now and may take so long.
    pub(crate) fn of(limit: Option<Duration>) -> Self {
        Self(limit.and_then(|limit| Instant::now().checked_add(limit)?.checked_add(GRACE)))
    }

    /// Whether it has passed.
    pub(crate) fn is_over(self) -> bool {
        self.0.is_some_and(|until| Instant::now() >= until)
    }

    /// An error where it has passed.
    pub(crate) fn check(self) -> Result<(), SetupError> {
        if self.is_over() { Err(SetupError::TimeLimit) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nothing_limits_is_never_over_and_what_is_late_is_told() {
        assert_eq!(Deadline::default().check(), Ok(()));
        assert_eq!(Deadline::of(None).check(), Ok(()));
        assert_eq!(Deadline::of(Some(Duration::MAX)).check(), Ok(()));
        assert_eq!(Deadline::of(Some(Duration::from_secs(3600))).check(), Ok(()));
        let late = Deadline(Some(Instant::now()));
        assert!(late.is_over());
        let error = late.check().expect_err("late");
        assert_eq!(error.to_string(), "the time limit was reached before the problem was set up");
    }
}
