//! Repeated timing of a kernel.

use std::time::Instant;

/// Durations of `n_times` calls on this thread, milliseconds, after one warm-up call.
///
/// # Errors
/// The first error of the work.
pub(crate) fn durations_ms<E>(
    n_times: u32,
    mut work: impl FnMut() -> Result<(), E>,
) -> Result<Vec<f64>, E> {
    let mut timed = || {
        let begin = Instant::now();
        work()?;
        Ok(begin.elapsed().as_secs_f64() * 1e3)
    };
    timed()?;
    (0..n_times).map(|_| timed()).collect()
}
