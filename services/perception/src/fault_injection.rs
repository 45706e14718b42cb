//! Fault injection: periodic panics of one actor, and that of a detection, for tests of the
//! supervision.

use std::time::{Duration, Instant};

/// Fault injection settings: the panic period and the actor, and the frame of a panic.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaultConfig {
    /// Period of injected panics; zero for no panics.
    pub(crate) panic_every: Duration,
    /// Track-id of the object whose actor panics.
    pub(crate) track_id: u64,
    /// Number of the frame whose detection panics.
    pub(crate) frame: Option<u64>,
}

/// Timer that marks the messages at which an actor panics.
#[derive(Debug)]
pub(crate) struct FaultInjector {
    config: FaultConfig,
    next: Option<Instant>,
}

impl FaultInjector {
    /// Injector whose first panic is due one period after the actor's first message.
    pub(crate) fn new(config: FaultConfig) -> Self {
        Self { config, next: None }
    }

    /// True if the next message to a track's actor must make it panic.
    pub(crate) fn is_due(&mut self, track_id: u64) -> bool {
        let FaultConfig {
            panic_every,
            track_id: chosen,
            ..
        } = self.config;
        if panic_every.is_zero() || track_id != chosen {
            return false;
        }
        let now = Instant::now();
        let next = *self.next.get_or_insert(now + panic_every);
        let is_due = next <= now;
        if is_due {
            self.next = Some(now + panic_every);
        }
        is_due
    }
}
