//! Work that idle workers share with the one that leads it.
#![expect(
    unsafe_code,
    reason = "work that borrows from its leader has no other way to a thread that outlives it"
)]

use crate::border::guarded;
use crate::job::{JobLost, Task};
use crate::progress::Progress;
use crate::sync::{
    Arc, AtomicBool, AtomicUsize, Condvar, Mutex, MutexGuard, Ordering, PATIENCE, PoisonError,
    pause,
};

/// Work that several threads may do at once.
type Work<'a> = &'a (dyn Fn() + Sync);

/// Puts a helper into the queue of the workers.
type Call = Box<dyn Fn(Arc<Helper>) + Send + Sync>;

/// A leader and those who may help; the helpers are workers with nothing else to do.
///
/// Nobody waits for a worker that is at work elsewhere: who comes too late finds
/// nothing to do.
pub struct Team {
    meeting: Arc<Meeting>,
    helpers: Vec<Arc<Helper>>,
    call: Call,
}

impl Team {
    /// A team with so many helpers at most.
    pub(crate) fn new(n_helpers: usize, call: Call) -> Self {
        let meeting = Arc::new(Meeting::default());
        let helper = |_| Arc::new(Helper::new(Arc::clone(&meeting)));
        Self {
            helpers: (0..n_helpers).map(helper).collect(),
            meeting,
            call,
        }
    }

    /// Calls `work` on this thread, and at the same time on helpers; returns when all
    /// calls are over. A team that is together already does no more: `work` is then
    /// called on this thread only. Allocates nothing of its own.
    ///
    /// # Panics
    /// When one of the calls does.
    pub fn together(&self, work: Work<'_>) {
        // SAFETY: only the lifetime changes. Whoever gets the reference from the meeting
        // is counted until the last use of it, and `Led` does not let this function
        // return or unwind before the meeting has forgotten it and the count is 0.
        let lasting = unsafe { std::mem::transmute::<Work<'_>, Work<'static>>(work) };
        let Some(led) = self.meeting.open(lasting) else {
            return work();
        };
        for helper in &self.helpers {
            if !helper.is_called.swap(true, Ordering::AcqRel) {
                (self.call)(Arc::clone(helper));
            }
        }
        work();
        if let Some(message) = led.end() {
            std::panic::resume_unwind(Box::new(message));
        }
    }
}

impl std::fmt::Debug for Team {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Team")
            .field("n_helpers", &self.helpers.len())
            .finish_non_exhaustive()
    }
}

/// Where the leader and the helpers meet.
#[derive(Default)]
struct Meeting {
    state: Mutex<State>,
    /// Changed under the lock only.
    n_inside: AtomicUsize,
    left: Condvar,
}

#[derive(Default)]
struct State {
    /// What is being done; `None` when nobody leads.
    work: Option<Work<'static>>,
    is_led: bool,
    /// What the first panic of a helper said.
    panic: Option<String>,
}

impl Meeting {
    /// Neither work nor wakers run under the lock, so a poisoned one is whole.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets helpers in; `None` when another leads already.
    fn open(&self, work: Work<'static>) -> Option<Led<'_>> {
        let mut state = self.lock();
        if state.is_led {
            return None;
        }
        *state = State {
            work: Some(work),
            is_led: true,
            panic: None,
        };
        Some(Led(self))
    }

    /// What there is to do; who gets it must [`leave`](Self::leave).
    fn enter(&self) -> Option<Work<'static>> {
        let state = self.lock();
        let work = state.work?;
        self.n_inside.fetch_add(1, Ordering::Relaxed);
        Some(work)
    }

    fn leave(&self, panic: Option<String>) {
        let mut state = self.lock();
        state.panic = state.panic.take().or(panic);
        // Release: what was done is seen by the leader, which may not take the lock.
        if self.n_inside.fetch_sub(1, Ordering::Release) == 1 {
            self.left.notify_all();
        }
    }

    /// Lets nobody in any more and waits for those who are inside: at first without
    /// sleeping, for they are about to end. Returns what the first panic of a helper
    /// said.
    fn close(&self) -> Option<String> {
        self.lock().work = None;
        for _ in 0..PATIENCE {
            if self.n_inside.load(Ordering::Acquire) == 0 {
                break;
            }
            pause();
        }
        let mut state = self.lock();
        while self.n_inside.load(Ordering::Acquire) > 0 {
            state = self
                .left
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
        state.is_led = false;
        state.panic.take()
    }
}

/// A meeting that is open; closed when dropped, also by a panic of the leader.
struct Led<'a>(&'a Meeting);

impl Led<'_> {
    fn end(self) -> Option<String> {
        let panic = self.0.close();
        std::mem::forget(self);
        panic
    }
}

impl Drop for Led<'_> {
    fn drop(&mut self) {
        self.0.close();
    }
}

/// One place of a team, as the pool sees it.
pub(crate) struct Helper {
    meeting: Arc<Meeting>,
    /// Whether it is in the queue.
    is_called: AtomicBool,
    /// Whether the worker that helps was declared stalled and has a successor.
    is_lost: AtomicBool,
}

impl Helper {
    fn new(meeting: Arc<Meeting>) -> Self {
        Self {
            meeting,
            is_called: AtomicBool::new(false),
            is_lost: AtomicBool::new(false),
        }
    }
}

impl Task for Helper {
    fn run(&self, _: &Progress) -> bool {
        // First, so that a leader who finds it true is one whose work is seen below.
        self.is_called.store(false, Ordering::Release);
        if let Some(work) = self.meeting.enter() {
            let outcome = guarded(work);
            self.meeting.leave(outcome.err());
        }
        !self.is_lost.swap(false, Ordering::AcqRel)
    }

    fn lose(&self, _: JobLost) -> bool {
        self.is_lost.store(true, Ordering::Release);
        true
    }
}
