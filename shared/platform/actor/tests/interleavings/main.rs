//! The mailbox, the job and the team under loom (a model checker; Norris and Demsky 2013):
//! each test runs in every order of events that its threads can bring about,
//! up to a bounded number of preemptions.
//!
//! The files are those of the crate, compiled here with loom's primitives.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "the files are the crate's, of which a test uses a part"
)]

mod sync {
    pub(crate) use loom::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
    pub(crate) use loom::sync::{Arc, Condvar, Mutex, MutexGuard};
    pub(crate) use std::sync::PoisonError;

    /// Every number of looks is in one of the orders of no look.
    pub(crate) const PATIENCE: usize = 0;

    pub(crate) fn pause() {}
}

#[path = "../../src/mailbox"]
mod mailbox {
    pub mod ends;
    pub mod overflow;
    pub mod queue;
    pub mod send_error;
}

#[path = "../../src/border.rs"]
mod border;
#[path = "../../src/job.rs"]
mod job;
#[path = "../../src/progress.rs"]
mod progress;
#[path = "../../src/worker_pool/team.rs"]
#[expect(
    clippy::reversed_empty_ranges,
    reason = "nobody looks twice before he sleeps here"
)]
mod team;

mod of_the_job;
mod of_the_mailbox;
mod of_the_team;

/// Preemptions in one run: two find nearly every known error (Musuvathi and
/// Qadeer 2007), and a third multiplies the time by ten.
const PREEMPTIONS: usize = 2;

fn explore(test: impl Fn() + Sync + Send + 'static) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(PREEMPTIONS);
    model.check(test);
}
