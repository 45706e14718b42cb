//! Restart policy: restart intensity within a sliding window, and exponential
//! back-off. Pure functions of passed-in instants.
//!
//! Used for the actors inside a process.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::error::Error;

/// Restart limit within a sliding window, with exponential back-off.
///
/// A back-off maximum above `window / max_restarts` makes the limit unreachable for
/// one child that fails at once each time; it then goes on retrying slowly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RestartPolicy {
    max_restarts: u32,
    window: Duration,
    backoff_min: Duration,
    backoff_max: Duration,
}

/// Decision of the restart policy about a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RestartDecision {
    /// Restart the actor after a back-off.
    Restart {
        /// Back-off delay before the restart.
        after: Duration,
    },
    /// Escalate: the limit is exceeded.
    Escalate,
}

impl RestartPolicy {
    /// Creates a policy of at most `max_restarts` (0 = never restart) within any
    /// `window`. The first restart comes after `backoff_min`, each further one within
    /// the window after twice the time, up to `backoff_max`.
    ///
    /// # Errors
    /// [`Error::InvalidRestartPolicy`] for an empty window or a minimum above
    /// the maximum.
    pub fn new(
        max_restarts: u32,
        window: Duration,
        backoff_min: Duration,
        backoff_max: Duration,
    ) -> Result<Self, Error> {
        if window.is_zero() {
            return Err(Error::InvalidRestartPolicy {
                rule: "the window must not be empty",
            });
        }
        if backoff_min > backoff_max {
            return Err(Error::InvalidRestartPolicy {
                rule: "the shortest back-off must not exceed the longest",
            });
        }
        Ok(Self {
            max_restarts,
            window,
            backoff_min,
            backoff_max,
        })
    }

    /// Number of restarts allowed within the window.
    pub fn max_restarts(&self) -> u32 {
        self.max_restarts
    }

    /// Length of the sliding window of restarts.
    pub fn window(&self) -> Duration {
        self.window
    }

    /// Exponential back-off after `n_recent` remembered restarts: `min(backoff_min *
    /// 2^n_recent, backoff_max)`.
    pub fn backoff(&self, n_recent: usize) -> Duration {
        // 64 doublings of a nanosecond are centuries.
        (0..n_recent.min(64)).fold(self.backoff_min, |grown, _| {
            grown.saturating_mul(2).min(self.backoff_max)
        })
    }
}

/// Sliding window of recent restarts, of one child or of all children of one
/// supervisor. Holds at most `max_restarts` instants of the greatest policy that it had, and
/// allocates at the first failure.
#[derive(Debug, Clone)]
pub struct RestartHistory {
    policy: RestartPolicy,
    restarts: VecDeque<Instant>,
}

impl RestartHistory {
    /// Creates a restart history without restarts.
    pub fn new(policy: RestartPolicy) -> Self {
        Self {
            policy,
            restarts: VecDeque::new(),
        }
    }

    /// Policy in use.
    pub fn policy(&self) -> RestartPolicy {
        self.policy
    }

    /// Replaces the policy; the remembered restarts count on.
    pub fn set_policy(&mut self, policy: RestartPolicy) {
        self.policy = policy;
    }

    /// Decides about a failure at `now` and records the restart that it allows. A
    /// restart exactly one window ago is forgotten. An instant before the previous
    /// one counts as the same moment.
    pub fn on_failure(&mut self, now: Instant) -> RestartDecision {
        let window = self.policy.window;
        while self
            .restarts
            .front()
            .is_some_and(|t| now.saturating_duration_since(*t) >= window)
        {
            self.restarts.pop_front();
        }
        let n_recent = self.restarts.len();
        if n_recent >= self.policy.max_restarts as usize {
            return RestartDecision::Escalate;
        }
        self.restarts.push_back(now);
        RestartDecision::Restart {
            after: self.policy.backoff(n_recent),
        }
    }
}

#[cfg(test)]
mod tests;
