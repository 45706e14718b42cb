//! Keeper of a lease: renews it on a thread of its own until it is dropped.

use control_client::ask_once;
use control_protocol::{ArmLease, request};
use service::{CommonArguments, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Period of renewal, as the protocol asks for.
const RENEWAL: Duration = Duration::from_millis(100);
/// Time between two renewals from which the lease may have ended, nanoseconds. Chosen: below the
/// 0.5 s of the lease.
const LATE_NS: u64 = 400_000_000;

/// Renewals of a lease. Times are monotonic, nanoseconds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Renewals {
    /// Time at which the last renewal was sent.
    pub(super) sent_ns: u64,
    /// Time of the answer to it.
    pub(super) answered_ns: u64,
    /// True if two were so far apart that the lease may have ended.
    pub(super) is_late: bool,
}

/// Thread that renews a lease.
pub(super) struct LeaseKeeper {
    is_ended: Arc<AtomicBool>,
    begun: Renewals,
    thread: Option<JoinHandle<Renewals>>,
}

impl LeaseKeeper {
    /// Starts the thread, right after the lease has begun.
    pub(super) fn start(common: &CommonArguments, lease: ArmLease) -> Self {
        let is_ended = Arc::new(AtomicBool::new(false));
        let now_ns = monotonic_ns();
        let begun = Renewals {
            sent_ns: now_ns,
            answered_ns: now_ns,
            is_late: false,
        };
        let (ended, common) = (is_ended.clone(), common.clone());
        let renewed = move || {
            let mut last = begun;
            while !ended.load(Ordering::Acquire) {
                let sent_ns = monotonic_ns();
                // A refusal is what a check may be about, such as a stop.
                if ask_once(&common, &request::hold_arm(lease.clone())).is_err() {
                    break;
                }
                let answered_ns = monotonic_ns();
                last = Renewals {
                    sent_ns,
                    answered_ns,
                    is_late: last.is_late || answered_ns - last.sent_ns > LATE_NS,
                };
                std::thread::park_timeout(RENEWAL);
            }
            last
        };
        Self {
            is_ended,
            begun,
            thread: Some(std::thread::spawn(renewed)),
        }
    }

    /// Ends the renewals, and tells of them.
    pub(super) fn end(mut self) -> Renewals {
        self.join()
    }

    fn join(&mut self) -> Renewals {
        self.is_ended.store(true, Ordering::Release);
        let Some(thread) = self.thread.take() else {
            return self.begun;
        };
        thread.thread().unpark();
        thread.join().unwrap_or(self.begun)
    }
}

impl Drop for LeaseKeeper {
    fn drop(&mut self) {
        self.join();
    }
}
