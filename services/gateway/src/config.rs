//! Configuration section `[gateway]`: groups of users and their roles.

use channel::control::RoleGroups;
use serde::Deserialize;
use service::{Configuration, Failure};

/// Section `[gateway]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawConfig {
    teacher_group: String,
    administrator_group: String,
}

/// Validated configuration of the gateway.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Config {
    /// Groups of teachers and administrators.
    pub(crate) groups: RoleGroups,
}

impl Config {
    /// Reads and validates the section of the configuration.
    pub(crate) fn new(found: &Configuration) -> Result<Self, Failure> {
        let raw: RawConfig = found.section_with_defaults("gateway")?;
        Ok(Self {
            groups: RoleGroups {
                teachers: raw.teacher_group,
                administrators: raw.administrator_group,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_agrees_with_the_key_reference() {
        service::check_section_reference("gateway", Config::new).unwrap();
    }
}
