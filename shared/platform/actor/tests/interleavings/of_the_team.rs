//! Every order of leading, helping and coming too late.

use std::panic::{AssertUnwindSafe, catch_unwind};

use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use loom::sync::{Arc, Mutex};
use loom::thread::{self, JoinHandle};

use crate::explore;
use crate::job::Task;
use crate::progress::Progress;
use crate::team::{Helper, Team};

type Workers = Arc<Mutex<Vec<JoinHandle<bool>>>>;

/// A team of two, and the threads of those who were called.
fn team() -> (Team, Workers) {
    let workers = Workers::default();
    let called = Arc::clone(&workers);
    let call = move |helper: Arc<Helper>| {
        let worker = thread::spawn(move || helper.run(&Progress::default()));
        called.lock().expect("the lock").push(worker);
    };
    (Team::new(1, Box::new(call)), workers)
}

fn all_keep_their_posts(workers: &Workers) {
    for worker in std::mem::take(&mut *workers.lock().expect("the lock")) {
        assert!(worker.join().expect("no panic"));
    }
}

/// Work that must not be called when its leader has gone on.
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

    fn lead(&self, team: &Team) {
        let (is_going_on, n_items) = (Arc::clone(&self.is_going_on), Arc::clone(&self.n_items));
        team.together(&move || {
            assert!(is_going_on.load(Ordering::Relaxed));
            n_items.fetch_add(1, Ordering::Relaxed);
            assert!(is_going_on.load(Ordering::Relaxed));
        });
        self.is_going_on.store(false, Ordering::Relaxed);
    }

    fn n_items(&self) -> usize {
        // What a helper did before it left is seen without any order of its own.
        self.n_items.load(Ordering::Relaxed)
    }
}

#[test]
fn nobody_is_at_work_when_the_leader_goes_on() {
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
fn a_helper_who_was_late_for_one_work_may_help_with_the_next() {
    explore(|| {
        let (team, workers) = team();
        let works = [Watched::new(), Watched::new()];
        for work in &works {
            work.lead(&team);
            // The late one, and the one called for this work.
            assert!((1..=3).contains(&work.n_items()));
        }
        all_keep_their_posts(&workers);
    });
}

#[test]
fn who_finds_a_leader_works_alone() {
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
fn a_panic_of_a_helper_is_the_leaders_and_the_team_goes_on() {
    explore(|| {
        let (team, workers) = team();
        let leader = thread::current().id();
        let n_panics = Arc::new(AtomicUsize::new(0));
        let panics = Arc::clone(&n_panics);
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            team.together(&move || {
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
