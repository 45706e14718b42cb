//! Where a process writes how it is.

use message::{ProcessState, Text};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counters and state of a process, written by its loops and read by the
/// health report about once a second.
#[derive(Debug)]
pub struct HealthBoard {
    state: Mutex<(ProcessState, Text)>,
    /// Frames published, processed or persisted.
    pub frames: AtomicU64,
    /// Frames that should have been handled and were not.
    pub frames_dropped: AtomicU64,
    /// Frames published more than a period late.
    pub frames_late: AtomicU64,
    /// Shared memory reserved by the process's publishers, bytes.
    pub shared_memory_bytes: AtomicU64,
    /// Restarts inside the process.
    pub restarts: AtomicU64,
    /// Actors now.
    pub actors: AtomicU64,
    /// Worker threads that were left behind.
    pub abandoned: AtomicU64,
    progress: AtomicU64,
}

impl Default for HealthBoard {
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

impl HealthBoard {
    /// Sets the state and the sentence that explains it; empty when all is well.
    pub fn set_state(&self, state: ProcessState, note: &str) {
        let mut held = self
            .state
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        *held = (state, Text::truncated(note));
    }

    /// The state and its sentence.
    pub fn state(&self) -> (ProcessState, Text) {
        *self
            .state
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Says that the process's main loop has made a step: a frame finished or,
    /// without frames, a probe answered. Nothing else feeds the watchdog.
    pub fn tick(&self) {
        self.progress.fetch_add(1, Ordering::Relaxed);
    }

    /// How many steps the main loop has made.
    pub fn progress(&self) -> u64 {
        self.progress.load(Ordering::Relaxed)
    }
}
