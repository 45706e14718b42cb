//! Every order of running, awaiting, giving up and declaring lost.

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

/// A worker's thread; true when it keeps its post.
fn worker(job: &Arc<Job<Work, u8>>) -> thread::JoinHandle<bool> {
    let job = Arc::clone(job);
    thread::spawn(move || job.run(&Progress::default()))
}

/// The watchdog's thread; true when it declared the job lost.
fn watchdog(job: &Arc<Job<Work, u8>>) -> thread::JoinHandle<bool> {
    let job = Arc::clone(job);
    thread::spawn(move || job.lose(JobLost::Stalled))
}

#[test]
fn who_awaits_is_woken_by_the_result() {
    explore(|| {
        let job = job(|_| 7);
        let result = JobResult(Arc::clone(&job));
        let worker = worker(&job);
        assert_eq!(block_on(result), Ok(7));
        assert!(worker.join().unwrap());
        assert!(!job.lose(JobLost::Stalled), "fetched and dropped");
    });
}

#[test]
fn a_result_or_a_loss_but_never_both_nor_neither() {
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
        assert!(!job.lose(JobLost::Stalled), "only once");
    });
}

#[test]
fn what_nobody_awaits_is_not_begun_or_its_result_is_dropped() {
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
        assert!(!job.lose(JobLost::Stalled));
        assert!(job.run(&Progress::default()), "it does not run twice");
        assert!(n_runs.load(Ordering::Relaxed) <= 1);
    });
}

#[test]
fn a_worker_declared_lost_leaves_its_post_even_if_nobody_awaits() {
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

/// Runs a job in whose middle `event` happens to it.
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
    (is_kept, job.lose(JobLost::Stalled))
}

#[test]
fn who_runs_a_job_that_nobody_awaits_any_more_keeps_the_post() {
    explore(|| assert_eq!(run_with(drop), (true, false)));
}

#[test]
fn who_runs_a_job_declared_lost_has_been_replaced() {
    explore(|| {
        let lose = |mut result: JobResult<Work, u8>| {
            assert!(result.0.lose(JobLost::Stalled));
            assert!(!result.0.lose(JobLost::Stalled), "only once");
            let mut context = Context::from_waker(Waker::noop());
            let outcome = Pin::new(&mut result).poll(&mut context);
            assert_eq!(outcome, Poll::Ready(Err(JobLost::Stalled)));
        };
        assert_eq!(run_with(lose), (false, false));
    });
}

#[test]
fn a_job_that_hangs_is_lost_though_nobody_awaits_it() {
    explore(|| {
        let lose_unwanted = |result: JobResult<Work, u8>| {
            let job = Arc::clone(&result.0);
            drop(result);
            assert!(job.lose(JobLost::Stalled));
        };
        assert_eq!(run_with(lose_unwanted), (false, false));
    });
}
