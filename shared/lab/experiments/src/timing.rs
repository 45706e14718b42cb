//! Timing kernels.

use std::time::Instant;

/// How long each of `n_times` calls takes, milliseconds, on this thread, after
/// one that does not count.
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
