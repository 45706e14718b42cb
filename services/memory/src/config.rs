//! The configuration, checked.

use serde::Deserialize;
use service::{ConfigFile, Failure};

/// The section `[memory]` as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    queue_requests: usize,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            queue_requests: 1024,
        }
    }
}

/// What the memory does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Config {
    /// Most requests that wait for the store; one more is refused.
    pub(crate) queue_requests: usize,
}

impl Config {
    /// The section `[memory]` of the file.
    pub(crate) fn new(file: &ConfigFile) -> Result<Self, Failure> {
        let RawConfig { queue_requests } = file.section("memory")?;
        if !(1..=1_000_000).contains(&queue_requests) {
            let rule = "[memory] queue_requests must lie between 1 and 1000000";
            return Err(file.wrong(rule).into());
        }
        Ok(Self { queue_requests })
    }
}
