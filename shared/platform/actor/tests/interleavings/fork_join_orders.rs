//! Interleavings of leading, helping and coming too late in a fork-join scope.

use std::panic::{AssertUnwindSafe, catch_unwind};

use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use loom::sync::{Arc, Mutex};
use loom::thread::{self, JoinHandle};

use crate::explore;
use crate::fork_join::{ForkJoin, Helper};
use crate::job::Task;
use crate::progress::Progress;

type Workers = Arc<Mutex<Vec<JoinHandle<bool>>>>;

/// Scope with one helper, and the threads of the queued helpers.
fn team() -> (ForkJoin, Workers) {
    let workers = Workers::default();
    let called = Arc::clone(&workers);
    let call = move |helper: Arc<Helper>| {
        let worker = thread::spawn(move || helper.run(&Progress::default()));
        called.lock().expect("the lock").push(worker);
    };
    (ForkJoin::new(1, Box::new(call)), workers)
}

fn all_keep_their_posts(workers: &Workers) {
    for worker in std::mem::take(&mut *workers.lock().expect("the lock")) {
        assert!(worker.join().expect("no panic"));
    }
}

/// Work that asserts that it is not called after its leader returned.
struct Watched {
    is_going_on: Arc<AtomicBool>,
    n_items: Arc<AtomicUsize>,
}

impl Watched {
    fn new() -> Self {
        Self {
            is_going_on: Arc::new(AtomicBool::new(true)),
            n_items: Arc::new(AtomicUsize::new(0)),
        }
    }

    fn lead(&self, team: &ForkJoin) {
        let (is_going_on, n_items) = (Arc::clone(&self.is_going_on), Arc::clone(&self.n_items));
        team.run(&move || {
            assert!(is_going_on.load(Ordering::Relaxed));
            n_items.fetch_add(1, Ordering::Relaxed);
            assert!(is_going_on.load(Ordering::Relaxed));
        });
        self.is_going_on.store(false, Ordering::Relaxed);
    }

    fn n_items(&self) -> usize {
        // The results of a helper are visible without further ordering.
        self.n_items.load(Ordering::Relaxed)
    }
}

#[test]
fn fork_join_returns_after_all_helpers() {
    explore(|| {
        let (team, workers) = team();
        let work = Watched::new();
        work.lead(&team);
        let n_calls = work.n_items();
        assert!((1..=2).contains(&n_calls));
        all_keep_their_posts(&workers);
        assert_eq!(work.n_items(), n_calls, "who came too late did nothing");
    });
}

#[test]
fn fork_join_helper_that_is_late_may_help_with_the_next_work() {
    explore(|| {
        let (team, workers) = team();
        let works = [Watched::new(), Watched::new()];
        for work in &works {
            work.lead(&team);
            // The late helper, and the one queued for this work.
            assert!((1..=3).contains(&work.n_items()));
        }
        all_keep_their_posts(&workers);
    });
}

#[test]
fn fork_join_with_another_leader_runs_alone() {
    explore(|| {
        let (team, workers) = team();
        let team = Arc::new(team);
        let other = Arc::clone(&team);
        let led = thread::spawn(move || Watched::new().lead(&other));
        let work = Watched::new();
        work.lead(&team);
        led.join().expect("no panic");
        assert!(work.n_items() >= 1);
        all_keep_their_posts(&workers);
    });
}

#[test]
fn fork_join_passes_a_helper_panic_to_the_leader() {
    explore(|| {
        let (team, workers) = team();
        let leader = thread::current().id();
        let n_panics = Arc::new(AtomicUsize::new(0));
        let panics = Arc::clone(&n_panics);
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            team.run(&move || {
                if thread::current().id() != leader {
                    panics.fetch_add(1, Ordering::Relaxed);
                    panic!("of a helper");
                }
            });
        }));
        assert_eq!(outcome.is_err(), n_panics.load(Ordering::Relaxed) == 1);
        Watched::new().lead(&team);
        all_keep_their_posts(&workers);
    });
}
