//! Configuration section `[run]`: watchdog and restarts of the daemon's processes.

use super::progress_watch::ProgressLimits;
use message::ProcessKind;
use serde::Deserialize;
use service::{BrokenRule, Configuration, Failure, check_rules};
use std::time::Duration;

/// Section `[run]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    watchdog_s: f64,
    memory_watchdog_s: f64,
    startup_watchdog_s: f64,
    watchdog_core_dump: bool,
    restart_delay_max_s: f64,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            watchdog_s: 4.0,
            memory_watchdog_s: 15.0,
            startup_watchdog_s: 120.0,
            watchdog_core_dump: false,
            restart_delay_max_s: 30.0,
        }
    }
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
        let raw: RawConfig = found.section("run")?;
        raw.check()
            .map_err(|broken| found.wrong("run", &[broken.key], broken))?;
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
            ready: if process.duties().is_store {
                self.memory_watchdog
            } else {
                self.watchdog
            },
        }
    }
}

impl RawConfig {
    /// First violated rule, if any. NaN violates every range.
    fn check(&self) -> Result<(), BrokenRule> {
        check_rules([
            (
                // A process that waits for another one, or for a device, records progress
                // every 3 s at the latest, and reports it 0.5 s later.
                (4.0..=3600.0).contains(&self.watchdog_s),
                "watchdog_s",
                "must lie between 4 and 3600",
            ),
            (
                (4.0..=3600.0).contains(&self.memory_watchdog_s),
                "memory_watchdog_s",
                "must lie between 4 and 3600",
            ),
            (
                (self.watchdog_s..=86_400.0).contains(&self.startup_watchdog_s),
                "startup_watchdog_s",
                "must lie between watchdog_s and 86400",
            ),
            (
                (0.05..=3600.0).contains(&self.restart_delay_max_s),
                "restart_delay_max_s",
                "must lie between 0.05 and 3600",
            ),
        ])
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
    fn numbers_out_of_range_and_nan_violate_a_rule() {
        assert_eq!(RawConfig::default().check(), Ok(()));
        let violates = |change: &dyn Fn(&mut RawConfig)| {
            let mut raw = RawConfig::default();
            change(&mut raw);
            assert!(raw.check().is_err(), "{raw:?}");
        };
        violates(&|raw| raw.watchdog_s = 3.9);
        violates(&|raw| raw.memory_watchdog_s = 3.9);
        violates(&|raw| raw.memory_watchdog_s = f64::NAN);
        violates(&|raw| raw.watchdog_s = f64::NAN);
        violates(&|raw| raw.startup_watchdog_s = raw.watchdog_s - 1.0);
        violates(&|raw| raw.startup_watchdog_s = f64::INFINITY);
        violates(&|raw| raw.restart_delay_max_s = 0.0);
        violates(&|raw| raw.restart_delay_max_s = f64::NAN);
    }
}
