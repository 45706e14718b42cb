//! Configuration section `[shared_memory]`: places for readers of clouds beside the daemon.

use crate::{BrokenRule, ConfigError, Configuration, check_rules};
use channel::{GUEST_PLACES, MAX_GUEST_PLACES};
use serde::Deserialize;

/// Section `[shared_memory]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    guest_places: u32,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            guest_places: GUEST_PLACES,
        }
    }
}

/// Number of guest places of the domain, by the configuration.
///
/// # Errors
/// When the key is out of range.
pub fn guest_places(found: &Configuration) -> Result<u32, ConfigError> {
    let raw: RawConfig = found.section("shared_memory")?;
    let rules: Result<(), BrokenRule> = check_rules([(
        raw.guest_places <= MAX_GUEST_PLACES,
        "guest_places",
        "must lie between 0 and 32",
    )]);
    rules.map_err(|broken| found.wrong("shared_memory", &[broken.key], broken))?;
    Ok(raw.guest_places)
}
