//! Processor time of what is measured by turns.

use cpu_time::ThreadTime;

/// Milliseconds of this thread.
pub(crate) fn milliseconds<T, E>(run: impl FnOnce() -> Result<T, E>) -> Result<f64, E> {
    let began = ThreadTime::now();
    run()?;
    Ok(1e3 * began.elapsed().as_secs_f64())
}

pub(crate) fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
