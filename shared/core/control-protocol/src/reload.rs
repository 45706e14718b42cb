//! Outcome of a reload of the configuration by one process.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Change of the value of a key. Values are as in TOML; `(none)` for a key without one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyChange {
    /// Section and key, such as `perception.workers`.
    pub key: String,
    /// Value that the process had.
    pub from: String,
    /// Value in the configuration.
    pub to: String,
}

impl fmt::Display for KeyChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} -> {}", self.key, self.from, self.to)
    }
}

/// Outcome of a reload by one process. It has applied all changes of live keys, or, when it refuses
/// the configuration, none.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReloadReport {
    /// Name of the process, such as `camera`; `run` for `tabula run`.
    pub process: String,
    /// Process id.
    pub pid: u32,
    /// Reason why the process refuses the configuration; none when it is valid.
    pub refused: Option<String>,
    /// `true` when the process has not answered in time: it may still apply the configuration.
    #[serde(default)]
    pub is_unanswered: bool,
    /// Changes that the process has applied.
    pub applied: Vec<KeyChange>,
    /// Changes that need a restart of the process.
    pub needs_restart: Vec<KeyChange>,
}
