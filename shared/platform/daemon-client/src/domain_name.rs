//! Domain names: each names one daemon of a user.

use std::fmt;
use std::str::FromStr;

/// Name of a domain: 1 to 32 of a-z, 0-9 and `-`. An underscore would allow one
/// domain's prefix in shared memory to begin another's.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct DomainName(String);

/// Error of a text that is no name of a domain.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the domain name {0:?} is not usable; choose 1 to 32 of the characters a-z, 0-9 and -")]
pub struct InvalidDomainName(String);

impl FromStr for DomainName {
    type Err = InvalidDomainName;

    fn from_str(name: &str) -> Result<Self, InvalidDomainName> {
        let allowed = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'-';
        if (1..=32).contains(&name.len()) && name.bytes().all(allowed) {
            Ok(Self(name.to_owned()))
        } else {
            Err(InvalidDomainName(name.to_owned()))
        }
    }
}

impl fmt::Display for DomainName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Default for DomainName {
    fn default() -> Self {
        Self("default".to_owned())
    }
}

impl DomainName {
    /// Prefix of the domain's files in `/dev/shm`; contains the user id.
    pub fn shared_memory_prefix(&self) -> String {
        format!("tabula_{}_{}_", rustix::process::geteuid().as_raw(), self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_other_characters_are_refused() {
        for good in ["default", "robot-2", "a"] {
            assert_eq!(good.parse::<DomainName>().unwrap().to_string(), good);
        }
        for bad in ["", "..", "a/b", "A", "a_b", "ä", "a b", &"x".repeat(33)] {
            let sentence = bad.parse::<DomainName>().unwrap_err().to_string();
            assert!(sentence.contains("choose"), "{sentence}");
        }
    }

    #[test]
    fn prefixes_do_not_begin_each_other() {
        let prefix = |name: &str| name.parse::<DomainName>().unwrap().shared_memory_prefix();
        assert!(!prefix("a-b").starts_with(&prefix("a")));
    }
}
