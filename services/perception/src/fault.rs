//! Faults on purpose, for tests of the supervision.

use std::time::{Duration, Instant};

/// When which actor panics.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaultConfig {
    /// Time between two panics; zero for none.
    pub(crate) panic_every: Duration,
    /// The track whose actor panics.
    pub(crate) track_id: u64,
}

/// Decides for each message whether its actor panics at it.
#[derive(Debug)]
pub(crate) struct Fault {
    config: FaultConfig,
    next: Option<Instant>,
}

impl Fault {
    /// The first panic is due when the actor's first message is one interval old.
    pub(crate) fn new(config: FaultConfig) -> Self {
        Self { config, next: None }
    }

    /// Whether the next message to a track's actor is to make it panic.
    pub(crate) fn strikes(&mut self, track_id: u64) -> bool {
        let FaultConfig {
            panic_every,
            track_id: chosen,
        } = self.config;
        if panic_every.is_zero() || track_id != chosen {
            return false;
        }
        let now = Instant::now();
        let next = *self.next.get_or_insert(now + panic_every);
        let strikes = next <= now;
        if strikes {
            self.next = Some(now + panic_every);
        }
        strikes
    }
}
