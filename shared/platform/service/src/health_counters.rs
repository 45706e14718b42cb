//! Health counters of a process.

use message::{ProcessState, Text};
use parking_lot::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counters and state of a process, written by its loops and read by the health
/// report about once a second.
#[derive(Debug)]
pub struct HealthCounters {
    state: Mutex<(ProcessState, Text)>,
    /// Number of frames published, processed or persisted.
    pub frames: AtomicU64,
    /// Number of frames that were dropped.
    pub frames_dropped: AtomicU64,
    /// Number of frames published more than a period late.
    pub frames_late: AtomicU64,
    /// Shared memory reserved by the process's publishers, bytes.
    pub shared_memory_bytes: AtomicU64,
    /// Number of restarts inside the process.
    pub restarts: AtomicU64,
    /// Number of live actors now.
    pub actors: AtomicU64,
    /// Number of abandoned worker threads.
    pub abandoned: AtomicU64,
    progress: AtomicU64,
}

impl Default for HealthCounters {
    fn default() -> Self {
        Self {
            state: Mutex::new((ProcessState::Starting, Text::default())),
            frames: AtomicU64::new(0),
            frames_dropped: AtomicU64::new(0),
            frames_late: AtomicU64::new(0),
            shared_memory_bytes: AtomicU64::new(0),
            restarts: AtomicU64::new(0),
            actors: AtomicU64::new(0),
            abandoned: AtomicU64::new(0),
            progress: AtomicU64::new(0),
        }
    }
}

impl HealthCounters {
    /// Sets the state and its explanation; empty when all is well.
    pub fn set_state(&self, state: ProcessState, note: &str) {
        *self.state.lock() = (state, Text::truncated(note));
    }

    /// State of the process and its explanation.
    pub fn state(&self) -> (ProcessState, Text) {
        *self.state.lock()
    }

    /// Records progress of the main loop: a frame finished or, without frames, a
    /// probe answered. This alone feeds the watchdog.
    pub fn record_progress(&self) {
        self.progress.fetch_add(1, Ordering::Relaxed);
    }

    /// Number of steps of the main loop.
    pub fn progress(&self) -> u64 {
        self.progress.load(Ordering::Relaxed)
    }
}
