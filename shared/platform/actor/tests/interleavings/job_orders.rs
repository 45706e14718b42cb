//! Interleavings of running, awaiting, cancelling and losing a job.

use std::pin::Pin;
use std::sync::mpsc;
use std::task::{Context, Poll, Waker};

use loom::future::block_on;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicUsize, Ordering};
use loom::thread;

use crate::explore;
use crate::job::{Job, JobLost, JobResult, Task};
use crate::progress::Progress;

type Work = Box<dyn FnOnce(&Progress) -> u8 + Send>;

fn job(work: impl FnOnce(&Progress) -> u8 + Send + 'static) -> Arc<Job<Work, u8>> {
    Arc::new(Job::new(Box::new(work)))
}

/// Worker thread; `true` when it was not replaced.
fn worker(job: &Arc<Job<Work, u8>>) -> thread::JoinHandle<bool> {
    let job = Arc::clone(job);
    thread::spawn(move || job.run(&Progress::default()))
}

/// Watchdog thread; `true` when it declared the job lost.
fn watchdog(job: &Arc<Job<Work, u8>>) -> thread::JoinHandle<bool> {
    let job = Arc::clone(job);
    thread::spawn(move || job.mark_lost(JobLost::Stalled))
}

#[test]
fn job_result_wakes_the_awaiting_task() {
    explore(|| {
        let job = job(|_| 7);
        let result = JobResult(Arc::clone(&job));
        let worker = worker(&job);
        assert_eq!(block_on(result), Ok(7));
        assert!(worker.join().unwrap());
        assert!(!job.mark_lost(JobLost::Stalled), "fetched and dropped");
    });
}

#[test]
fn job_ends_with_either_a_result_or_a_loss() {
    explore(|| {
        let job = job(|_| 7);
        let result = JobResult(Arc::clone(&job));
        let (worker, watchdog) = (worker(&job), watchdog(&job));
        let outcome = block_on(result);
        let (keeps_post, is_lost) = (worker.join().unwrap(), watchdog.join().unwrap());
        if is_lost {
            assert_eq!(outcome, Err(JobLost::Stalled));
        } else {
            assert_eq!(outcome, Ok(7));
            assert!(keeps_post, "who was not replaced goes on");
        }
        assert!(!job.mark_lost(JobLost::Stalled), "only once");
    });
}

#[test]
fn job_that_is_cancelled_does_not_start_or_drops_its_result() {
    explore(|| {
        let n_runs = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&n_runs);
        let job = job(move |_| {
            counter.fetch_add(1, Ordering::Relaxed);
            1
        });
        let result = JobResult(Arc::clone(&job));
        let worker = worker(&job);
        drop(result);
        assert!(worker.join().unwrap(), "giving up costs no worker");
        assert!(n_runs.load(Ordering::Relaxed) <= 1);
        assert!(!job.mark_lost(JobLost::Stalled));
        assert!(job.run(&Progress::default()), "it does not run twice");
        assert!(n_runs.load(Ordering::Relaxed) <= 1);
    });
}

#[test]
fn job_lost_after_cancellation_replaces_its_worker() {
    explore(|| {
        let job = job(|_| 1);
        let result = JobResult(Arc::clone(&job));
        let (worker, watchdog) = (worker(&job), watchdog(&job));
        drop(result);
        let (keeps_post, is_lost) = (worker.join().unwrap(), watchdog.join().unwrap());
        // A job lost before it began has no worker to replace.
        assert!(
            is_lost || keeps_post,
            "a post was given up without a successor"
        );
    });
}

/// Runs a job during which `event` happens to it.
fn run_with(event: impl FnOnce(JobResult<Work, u8>) + Send + 'static) -> (bool, bool) {
    let (hand_in, inside) = mpsc::channel();
    let job = job(move |_| {
        event(inside.recv().expect("handed in before it runs"));
        1
    });
    hand_in
        .send(JobResult(Arc::clone(&job)))
        .expect("the job is there");
    let is_kept = job.run(&Progress::default());
    (is_kept, job.mark_lost(JobLost::Stalled))
}

#[test]
fn job_cancelled_while_running_keeps_its_worker() {
    explore(|| assert_eq!(run_with(drop), (true, false)));
}

#[test]
fn job_lost_while_running_replaces_its_worker() {
    explore(|| {
        let mark_lost = |mut result: JobResult<Work, u8>| {
            assert!(result.0.mark_lost(JobLost::Stalled));
            assert!(!result.0.mark_lost(JobLost::Stalled), "only once");
            let mut context = Context::from_waker(Waker::noop());
            let outcome = Pin::new(&mut result).poll(&mut context);
            assert_eq!(outcome, Poll::Ready(Err(JobLost::Stalled)));
        };
        assert_eq!(run_with(mark_lost), (false, false));
    });
}

#[test]
fn job_that_hangs_is_lost_even_after_cancellation() {
    explore(|| {
        let lose_unwanted = |result: JobResult<Work, u8>| {
            let job = Arc::clone(&result.0);
            drop(result);
            assert!(job.mark_lost(JobLost::Stalled));
        };
        assert_eq!(run_with(lose_unwanted), (false, false));
    });
}
