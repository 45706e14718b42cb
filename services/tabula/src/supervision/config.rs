//! Configuration section `[run]`: watchdog and restarts of the daemon's processes.

use super::progress_watch::ProgressLimits;
use message::{Duty, ProcessKind};
use serde::Deserialize;
use service::{Configuration, Failure};
use std::time::Duration;

/// Section `[run]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawConfig {
    watchdog_s: f64,
    memory_watchdog_s: f64,
    startup_watchdog_s: f64,
    watchdog_core_dump: bool,
    restart_delay_max_s: f64,
}

/// Validated configuration of the supervision of processes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SupervisionConfig {
    /// Longest time without progress of a process that is ready, but for the memory.
    watchdog: Duration,
    /// Longest time without progress of the memory when it is ready: it waits for the disk.
    memory_watchdog: Duration,
    /// Longest time without progress of a process that is starting.
    startup_watchdog: Duration,
    /// `true` to end a process without progress by SIGABRT, for a core dump.
    pub(crate) wants_core_dump: bool,
    /// Longest delay before a restart.
    pub(crate) restart_delay_max: Duration,
}

impl SupervisionConfig {
    /// Reads and validates the section of the configuration.
    ///
    /// # Errors
    /// When a key is unknown or a value is out of range.
    pub(crate) fn new(found: &Configuration) -> Result<Self, Failure> {
        let raw: RawConfig = found.section_with_defaults("run")?;
        Ok(Self {
            watchdog: Duration::from_secs_f64(raw.watchdog_s),
            memory_watchdog: Duration::from_secs_f64(raw.memory_watchdog_s),
            startup_watchdog: Duration::from_secs_f64(raw.startup_watchdog_s),
            wants_core_dump: raw.watchdog_core_dump,
            restart_delay_max: Duration::from_secs_f64(raw.restart_delay_max_s),
        })
    }

    /// Longest times without progress of a process.
    pub(crate) fn progress_limits(&self, process: ProcessKind) -> ProgressLimits {
        ProgressLimits {
            starting: self.startup_watchdog,
            ready: if process.has(Duty::Store) {
                self.memory_watchdog
            } else {
                self.watchdog
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_agrees_with_the_key_reference() {
        service::check_section_reference("run", SupervisionConfig::new).unwrap();
    }

    #[test]
    fn numbers_out_of_range_and_nan_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for setting in [
            "watchdog_s = 3.9",
            "watchdog_s = nan",
            "memory_watchdog_s = 3.9",
            "memory_watchdog_s = nan",
            "startup_watchdog_s = 3.0",
            "startup_watchdog_s = inf",
            "restart_delay_max_s = 0.0",
            "restart_delay_max_s = nan",
        ] {
            let file = folder.path().join("tabula.toml");
            std::fs::write(&file, format!("[run]\n{setting}\n")).unwrap();
            let refused = Configuration::find(Some(&file), folder.path()).unwrap_err();
            let sentence = refused.to_string();
            let (key, _) = setting.split_once(" = ").unwrap();
            assert!(sentence.contains(key), "{sentence}");
        }
    }
}
