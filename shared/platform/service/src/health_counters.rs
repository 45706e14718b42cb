//! Health counters of a process.

use message::{ProcessState, Text};
use parking_lot::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// Counters and state of a process, written by its loops and read by the health report every half
/// second.
#[derive(Debug)]
pub struct HealthCounters {
    state: Mutex<(ProcessState, Text)>,
    state_changed: Notify,
    /// Number of frames published or processed, or of scenes received.
    pub frames: AtomicU64,
    /// Number of frames that were dropped.
    pub frames_dropped: AtomicU64,
    /// Number of frames published more than a period late.
    pub frames_late: AtomicU64,
    /// Shared memory reserved by the process's publishers, bytes.
    pub shared_memory_bytes: AtomicU64,
    /// Number of restarts of actors, and of lost jobs of the worker pool.
    pub restarts: AtomicU64,
    /// Number of live actors now.
    pub actors: AtomicU64,
    /// Number of worker threads abandoned because they made no progress.
    pub abandoned: AtomicU64,
    progress: AtomicU64,
}

impl Default for HealthCounters {
    fn default() -> Self {
        Self {
            state: Mutex::new((ProcessState::Starting, Text::default())),
            state_changed: Notify::new(),
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
    /// Sets the state and its explanation; empty when all is well. Another state is reported at
    /// once.
    pub fn set_state(&self, state: ProcessState, note: &str) {
        let known = std::mem::replace(&mut *self.state.lock(), (state, Text::truncated(note)));
        if known.0 != state {
            self.state_changed.notify_one();
        }
    }

    /// Waits until the state has changed since the last call.
    pub(crate) async fn state_change(&self) {
        self.state_changed.notified().await;
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

    /// Runs a step that may take longer than the watchdog allows, such as the opening of a device,
    /// and records progress meanwhile, for at most `limit`.
    pub fn record_progress_during<T>(&self, limit: Duration, step: impl FnOnce() -> T) -> T {
        /// Time between two records of progress.
        const PERIOD: Duration = Duration::from_millis(250);
        let (running, is_over) = channel::<()>();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                let began = Instant::now();
                while began.elapsed() < limit
                    && is_over.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout)
                {
                    self.record_progress();
                }
            });
            let done = step();
            drop(running);
            done
        })
    }

    /// Number of steps of the main loop.
    pub fn progress(&self) -> u64 {
        self.progress.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_recorded_during_a_long_step_until_its_limit() {
        let health = HealthCounters::default();
        let step = || std::thread::sleep(Duration::from_millis(900));
        health.record_progress_during(Duration::from_secs(60), step);
        assert!((1..=3).contains(&health.progress()));
        let before = health.progress();
        health.record_progress_during(Duration::from_millis(300), step);
        assert!(health.progress() <= before + 2);
    }

    #[tokio::test]
    async fn state_change_is_noticed_and_another_note_is_not() {
        let health = HealthCounters::default();
        health.set_state(ProcessState::Degraded, "no frame for 1 s");
        health.state_change().await;
        health.set_state(ProcessState::Degraded, "no frame for 2 s");
        let again = tokio::time::timeout(Duration::from_millis(20), health.state_change());
        assert!(again.await.is_err());
        health.set_state(ProcessState::Ready, "");
        health.state_change().await;
    }
}
