//! The same work on many things at once.

use super::failed;
use indicatif::ProgressBar;
use service::Failure;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Does `n_jobs` jobs on as many threads as the machine runs at once; the results are
/// in the order of the jobs. Each thread has what it reuses from job to job.
pub(crate) fn map<Own, T: Send>(
    n_jobs: usize,
    bar: &ProgressBar,
    own: impl Fn() -> Own + Sync,
    work: impl Fn(&mut Own, usize) -> T + Sync,
) -> Result<Vec<T>, Failure> {
    let n_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let take_jobs = || {
        let (mut own, mut done) = (own(), Vec::new());
        loop {
            let job = next.fetch_add(1, Ordering::Relaxed);
            if job >= n_jobs {
                return done;
            }
            done.push((job, work(&mut own, job)));
            bar.inc(1);
        }
    };
    let done: Result<Vec<_>, Failure> = std::thread::scope(|scope| {
        let n_workers = n_threads.min(n_jobs);
        let workers: Vec<_> = (0..n_workers).map(|_| scope.spawn(take_jobs)).collect();
        let done = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        done.map(|done| done.map_err(|_| failed("a worker has panicked")))
            .collect()
    });
    let mut done: Vec<(usize, T)> = done?.into_iter().flatten().collect();
    done.sort_by_key(|(job, _)| *job);
    Ok(done.into_iter().map(|(_, result)| result).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_jobs() {
        let bar = ProgressBar::hidden();
        let squares = map(100, &bar, || (), |(), job| job * job).unwrap();
        assert!((0..100).all(|job| squares[job] == job * job));
        assert_eq!(bar.position(), 100);
        assert!(map(0, &bar, || (), |(), job| job).unwrap().is_empty());
    }
}
