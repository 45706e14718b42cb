//! Interleavings of a worker that runs jobs and the watchdog that looks at it.

use std::sync::Arc as TaskArc;
use std::time::{Duration, Instant};

use loom::sync::Arc;
use loom::thread;

use crate::explore;
use crate::job::{JobLost, Task};
use crate::progress::Progress;
use crate::worker_watch::{WatchedWorker, Worker};

/// Time between two checks.
const BETWEEN: Duration = Duration::from_secs(10);

/// Job that may tick.
struct TickingJob {
    ticks: bool,
}

fn job(ticks: bool) -> TaskArc<dyn Task> {
    TaskArc::new(TickingJob { ticks })
}

impl Task for TickingJob {
    fn run(&self, progress: &Progress) -> bool {
        if self.ticks {
            progress.tick();
        }
        true
    }

    fn mark_lost(&self, _: JobLost) -> bool {
        true
    }
}

/// A job that begins between or during two checks is not held for silent since the first one.
#[test]
fn job_that_has_just_begun_is_not_silent() {
    explore(|| {
        let worker = Arc::new(Worker::default());
        worker.run(&job(false));
        let began = Instant::now();
        let mut watched = WatchedWorker::new(Arc::clone(&worker), began);
        assert!(watched.silent_job(began).is_none());
        let working = thread::spawn(move || {
            worker.run(&job(false));
            worker.run(&job(true));
        });
        if let Some((_, silent)) = watched.silent_job(began + BETWEEN) {
            assert_eq!(silent, Duration::ZERO);
        }
        working.join().unwrap();
    });
}

/// Whatever the order, a finished worker has no job, and a new one starts its clock anew.
#[test]
fn idle_worker_has_no_silent_job() {
    explore(|| {
        let worker = Arc::new(Worker::default());
        let began = Instant::now();
        let mut watched = WatchedWorker::new(Arc::clone(&worker), began);
        let working = thread::spawn({
            let worker = Arc::clone(&worker);
            move || worker.run(&job(true))
        });
        watched.silent_job(began);
        working.join().unwrap();
        assert!(watched.silent_job(began + BETWEEN).is_none());
        worker.run(&job(true));
        assert!(watched.silent_job(began + 2 * BETWEEN).is_none());
    });
}
