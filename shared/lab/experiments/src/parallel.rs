//! Parallel map over independent jobs, with per-worker scratch memory and a progress bar.

use command_line::{Output, progress_bar};
use indicatif::ProgressBar;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use service::Failure;

/// Results of `n_jobs` jobs in the order of the jobs, with a progress bar of its own that counts
/// in `unit`.
///
/// # Errors
/// The failure of the first job in order that fails.
pub(crate) fn try_map<T: Send>(
    n_jobs: usize,
    unit: &'static str,
    output: &Output,
    work: impl Fn(usize) -> Result<T, Failure> + Sync + Send,
) -> Result<Vec<T>, Failure> {
    let bar = progress_bar(n_jobs as u64, unit, output);
    let results = map(n_jobs, &bar, || (), |(), job| work(job));
    bar.finish_and_clear();
    results.into_iter().collect()
}

/// Results of `n_jobs` jobs in the order of the jobs, computed on all cores.
///
/// `scratch` makes the memory that a worker reuses from job to job; a result must not depend on
/// its content. A panic of a job is passed on.
pub(crate) fn map<Scratch, T: Send>(
    n_jobs: usize,
    bar: &ProgressBar,
    scratch: impl Fn() -> Scratch + Sync + Send,
    work: impl Fn(&mut Scratch, usize) -> T + Sync + Send,
) -> Vec<T> {
    let jobs = (0..n_jobs).into_par_iter();
    let results = jobs.map_init(scratch, |scratch, job| {
        let result = work(scratch, job);
        bar.inc(1);
        result
    });
    results.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_the_order_of_the_jobs() {
        let bar = ProgressBar::hidden();
        let squares = map(100, &bar, || (), |(), job| job * job);
        assert!((0..100).all(|job| squares[job] == job * job));
        assert_eq!(bar.position(), 100);
        assert!(map(0, &bar, || (), |(), job| job).is_empty());
    }
}
