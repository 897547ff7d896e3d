//! Time that the processor has spent on this thread, which other programs do not make longer.

use std::time::Duration;

/// So far, where the system says it: on Linux.
pub(crate) fn spent() -> Option<Duration> {
    // What has been spent is written down when the thread lets others go first.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// Seconds since an earlier time.
pub(crate) fn since(earlier: Option<Duration>) -> Option<f64> {
    Some(spent()?.saturating_sub(earlier?).as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_that_is_slept_is_not_spent() {
        let Some(before) = spent() else { return };
        std::thread::sleep(Duration::from_millis(50));
        assert!(since(Some(before)).is_some_and(|seconds| seconds < 0.025));
        let mut sum = 0.0_f64;
        (0..20_000_000).for_each(|i| sum = (sum + f64::from(i)).sqrt());
        assert!(since(Some(before)).is_some_and(|seconds| seconds > 1e-3), "{sum}");
    }
}
