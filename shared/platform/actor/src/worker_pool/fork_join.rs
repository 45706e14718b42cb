//! Fork-join on the worker pool: idle workers help with the work of the current job.
#![expect(
    unsafe_code,
    reason = "scoped work on threads that outlive the scope needs a lifetime transmute"
)]

use crate::job::{JobLost, Task};
use crate::panic_boundary::catch_panic;
use crate::progress::Progress;
use crate::sync::{
    Arc, AtomicBool, AtomicUsize, Condvar, Mutex, MutexGuard, Ordering, PoisonError, SPIN_LIMIT,
    pause,
};

/// Closure that several threads may call at the same time.
type Work<'a> = &'a (dyn Fn() + Sync);

/// Puts a helper into the queue of the workers.
type Enqueue = Box<dyn Fn(Arc<Helper>) + Send + Sync>;

/// Fork-join scope: one leading thread, and idle workers as helpers.
///
/// The leader does not wait for workers that are busy elsewhere: a helper that comes
/// too late finds nothing to do.
pub struct ForkJoin {
    rendezvous: Arc<Rendezvous>,
    helpers: Vec<Arc<Helper>>,
    enqueue: Enqueue,
}

impl ForkJoin {
    /// Creates a scope with at most `n_helpers` helpers.
    pub(crate) fn new(n_helpers: usize, enqueue: Enqueue) -> Self {
        let rendezvous = Arc::new(Rendezvous::default());
        let helper = |_| Arc::new(Helper::new(Arc::clone(&rendezvous)));
        Self {
            helpers: (0..n_helpers).map(helper).collect(),
            rendezvous,
            enqueue,
        }
    }

    /// Calls `work` on this thread and at the same time on helpers; returns when all
    /// calls are over. While another leader uses the scope, `work` is called on this
    /// thread only. Allocates nothing.
    ///
    /// # Panics
    /// When one of the calls does.
    pub fn run(&self, work: Work<'_>) {
        // SAFETY: only the lifetime changes. A thread that gets the reference from
        // the rendezvous is counted until its last use of it, and `JoinGuard` does
        // not let this function return or unwind before the rendezvous has forgotten
        // the reference and the count is 0.
        let extended = unsafe { std::mem::transmute::<Work<'_>, Work<'static>>(work) };
        let Some(guard) = self.rendezvous.begin(extended) else {
            return work();
        };
        for helper in &self.helpers {
            if !helper.is_queued.swap(true, Ordering::AcqRel) {
                (self.enqueue)(Arc::clone(helper));
            }
        }
        work();
        if let Some(message) = guard.end() {
            std::panic::resume_unwind(Box::new(message));
        }
    }
}

impl std::fmt::Debug for ForkJoin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Team")
            .field("n_helpers", &self.helpers.len())
            .finish_non_exhaustive()
    }
}

/// Rendezvous of the leader and its helpers.
#[derive(Default)]
struct Rendezvous {
    state: Mutex<RendezvousState>,
    /// Number of running helpers; changed under the lock only.
    n_running: AtomicUsize,
    left: Condvar,
}

#[derive(Default)]
struct RendezvousState {
    /// Current work; `None` while there is no leader.
    work: Option<Work<'static>>,
    is_active: bool,
    /// Message of a helper's first panic.
    panic: Option<String>,
}

impl Rendezvous {
    /// Neither work nor wakers run under the lock, so the data behind a poisoned lock
    /// is intact.
    fn lock(&self) -> MutexGuard<'_, RendezvousState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Publishes work to the helpers; `None` while another leader is active.
    fn begin(&self, work: Work<'static>) -> Option<JoinGuard<'_>> {
        let mut state = self.lock();
        if state.is_active {
            return None;
        }
        *state = RendezvousState {
            work: Some(work),
            is_active: true,
            panic: None,
        };
        Some(JoinGuard(self))
    }

    /// Takes part in the current work; the caller must [`finish`](Self::finish) it.
    fn join_work(&self) -> Option<Work<'static>> {
        let state = self.lock();
        let work = state.work?;
        self.n_running.fetch_add(1, Ordering::Relaxed);
        Some(work)
    }

    fn finish(&self, panic: Option<String>) {
        let mut state = self.lock();
        state.panic = state.panic.take().or(panic);
        // Release: the results are seen by the leader, which may not take the lock.
        if self.n_running.fetch_sub(1, Ordering::Release) == 1 {
            self.left.notify_all();
        }
    }

    /// Withdraws the work and waits for the running helpers: first by spinning,
    /// because they are about to end. Returns the message of a helper's first panic.
    fn wait_for_helpers(&self) -> Option<String> {
        self.lock().work = None;
        for _ in 0..SPIN_LIMIT {
            if self.n_running.load(Ordering::Acquire) == 0 {
                break;
            }
            pause();
        }
        let mut state = self.lock();
        while self.n_running.load(Ordering::Acquire) > 0 {
            state = self
                .left
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
        state.is_active = false;
        state.panic.take()
    }
}

/// Guard of active work: joins the helpers when dropped, also during a panic of the
/// leader.
struct JoinGuard<'a>(&'a Rendezvous);

impl JoinGuard<'_> {
    fn end(self) -> Option<String> {
        let panic = self.0.wait_for_helpers();
        std::mem::forget(self);
        panic
    }
}

impl Drop for JoinGuard<'_> {
    fn drop(&mut self) {
        self.0.wait_for_helpers();
    }
}

/// Helper slot of a scope, queued as a job of the pool.
pub(crate) struct Helper {
    rendezvous: Arc<Rendezvous>,
    /// `true` while it is in the queue.
    is_queued: AtomicBool,
    /// `true` when the worker that helps was declared stalled and has a successor.
    is_lost: AtomicBool,
}

impl Helper {
    fn new(rendezvous: Arc<Rendezvous>) -> Self {
        Self {
            rendezvous,
            is_queued: AtomicBool::new(false),
            is_lost: AtomicBool::new(false),
        }
    }
}

impl Task for Helper {
    fn run(&self, _: &Progress) -> bool {
        // First, so that a leader that reads `true` is one whose work is seen below.
        self.is_queued.store(false, Ordering::Release);
        if let Some(work) = self.rendezvous.join_work() {
            let outcome = catch_panic(work);
            self.rendezvous.finish(outcome.err());
        }
        !self.is_lost.swap(false, Ordering::AcqRel)
    }

    fn mark_lost(&self, _: JobLost) -> bool {
        self.is_lost.store(true, Ordering::Release);
        true
    }
}
