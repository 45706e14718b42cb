//! The configuration, checked.

use serde::Deserialize;
use service::{ConfigFile, Failure};
use std::time::Duration;
use store::Limits;

/// The section `[memory]` as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    queue_requests: usize,
    max_views_per_category: usize,
    max_unnamed_views: usize,
    forgotten_kept_days: u64,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            queue_requests: 1024,
            max_views_per_category: 1000,
            max_unnamed_views: 20_000,
            forgotten_kept_days: 30,
        }
    }
}

/// What the memory does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Config {
    /// Most requests that wait for the store; one more is refused.
    pub(crate) queue_requests: usize,
    /// How much is kept.
    pub(crate) limits: Limits,
    /// How long what was forgotten can be taken back.
    pub(crate) forgotten_kept: Duration,
}

impl Config {
    /// The section `[memory]` of the file.
    pub(crate) fn new(file: &ConfigFile) -> Result<Self, Failure> {
        let RawConfig {
            queue_requests,
            max_views_per_category,
            max_unnamed_views,
            forgotten_kept_days,
        } = file.section("memory")?;
        if !(1..=1_000_000).contains(&queue_requests) {
            let rule = "[memory] queue_requests must lie between 1 and 1000000";
            return Err(file.wrong(rule).into());
        }
        if !(10..=10_000).contains(&max_views_per_category) {
            let rule = "[memory] max_views_per_category must lie between 10 and 10000";
            return Err(file.wrong(rule).into());
        }
        if !(100..=1_000_000).contains(&max_unnamed_views) {
            let rule = "[memory] max_unnamed_views must lie between 100 and 1000000";
            return Err(file.wrong(rule).into());
        }
        if forgotten_kept_days > 36_500 {
            let rule = "[memory] forgotten_kept_days must lie between 0 and 36500";
            return Err(file.wrong(rule).into());
        }
        Ok(Self {
            queue_requests,
            limits: Limits {
                max_views_per_category,
                max_unnamed_views,
            },
            forgotten_kept: Duration::from_secs(forgotten_kept_days * 24 * 3600),
        })
    }
}
