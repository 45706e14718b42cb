//! Model checking of mailbox, job, fork-join and worker watch under loom (Norris and Demsky 2013):
//! each test runs in every interleaving of its threads, up to a bounded number of
//! preemptions.
//!
//! The files are those of the crate, compiled here with loom's primitives.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test uses a part of the included files of the crate"
)]

mod sync {
    pub(crate) use loom::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
    pub(crate) use loom::sync::{Arc, Condvar, Mutex, MutexGuard};
    pub(crate) use std::sync::PoisonError;

    /// No spinning: the interleavings without it include all others.
    pub(crate) const SPIN_LIMIT: usize = 0;

    pub(crate) fn pause() {}
}

#[path = "../../src/mailbox"]
mod mailbox {
    pub mod endpoints;
    pub mod overflow;
    pub mod queue;
    pub mod send_error;
}

#[path = "../../src/worker_pool/fork_join.rs"]
#[expect(
    clippy::reversed_empty_ranges,
    reason = "the spin limit is 0 under loom"
)]
mod fork_join;
#[path = "../../src/job.rs"]
mod job;
#[path = "../../src/panic_boundary.rs"]
mod panic_boundary;
#[path = "../../src/progress.rs"]
mod progress;
#[path = "../../src/worker_pool/worker_watch.rs"]
mod worker_watch;

mod fork_join_orders;
mod job_orders;
mod mailbox_orders;
mod worker_watch_orders;

/// Preemption bound of one run: two find nearly every known error (Musuvathi and
/// Qadeer 2007), and a third multiplies the time by ten.
const PREEMPTIONS: usize = 2;

fn explore(test: impl Fn() + Sync + Send + 'static) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(PREEMPTIONS);
    model.check(test);
}
