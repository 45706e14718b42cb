//! Configuration section `[shared_memory]`: places for readers of clouds beside the daemon.

use crate::{ConfigError, Configuration};
use serde::Deserialize;

/// Section `[shared_memory]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawConfig {
    guest_places: u32,
}

/// Number of guest places of the domain, by the configuration.
///
/// # Errors
/// When the key is out of range.
pub fn guest_places(found: &Configuration) -> Result<u32, ConfigError> {
    let raw: RawConfig = found.section_with_defaults("shared_memory")?;
    Ok(raw.guest_places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KeyReference, check_section_reference};
    use channel::{GUEST_PLACES, MAX_GUEST_PLACES};

    #[test]
    fn guest_places_agree_with_the_key_reference_and_the_channels() {
        check_section_reference("shared_memory", guest_places).unwrap();
        assert_eq!(
            guest_places(&Configuration::default()).unwrap(),
            GUEST_PLACES
        );
        let key = KeyReference::get()
            .key("shared_memory", "guest_places")
            .unwrap();
        assert_eq!(
            key.range.as_ref().unwrap().most,
            Some(f64::from(MAX_GUEST_PLACES))
        );
    }
}
