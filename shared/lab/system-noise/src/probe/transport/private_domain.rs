//! Private shared-memory domain of a transport probe.

use super::TransportError;
use channel::{Domain, DomainName, Error, Role, RunFolder};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

/// Prefix of the domain names, followed by the process id. It is short because the name occurs
/// twice in the path of a socket, which holds 107 bytes.
const PREFIX: &str = "m";

static N_DOMAINS: AtomicU32 = AtomicU32::new(0);

/// Private domain that only the probe joins. The last member to leave removes it.
#[derive(Debug)]
pub(super) struct PrivateDomain {
    name: DomainName,
    folder: RunFolder,
}

impl PrivateDomain {
    /// Domain with a unique name. Removes the domains of killed probes.
    pub(super) fn new() -> Result<Self, TransportError> {
        let folder = RunFolder::of_user();
        remove_abandoned(&folder);
        let number = N_DOMAINS.fetch_add(1, Ordering::Relaxed);
        let name = format!("{PREFIX}{}-{number}", std::process::id());
        Ok(Self {
            name: name.parse()?,
            folder,
        })
    }

    pub(super) fn join(&self) -> Result<Domain, Error> {
        Domain::join(&self.name, &self.folder, Role::Guest)
    }
}

/// Removes abandoned domains: joining one cleans up its files, leaving it removes its folder.
fn remove_abandoned(folder: &RunFolder) {
    let entries = std::fs::read_dir(folder.path());
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|name| is_abandoned(name)) else {
            continue;
        };
        if let Ok(name) = name.parse() {
            drop(Domain::join(&name, folder, Role::Guest));
        }
    }
}

/// `true` if a domain belongs to a probe whose process no longer exists.
fn is_abandoned(name: &str) -> bool {
    let is_number = |text: &&str| text.bytes().all(|byte| byte.is_ascii_digit());
    let numbers = name
        .strip_prefix(PREFIX)
        .and_then(|rest| rest.split_once('-'));
    let pid = numbers.map(|(pid, _)| pid).filter(is_number);
    pid.and_then(|pid| pid.parse::<u32>().ok())
        .is_some_and(|pid| !Path::new(&format!("/proc/{pid}")).exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn domains_of_ended_processes_are_abandoned() {
        assert!(is_abandoned("m4294967295-0"));
        assert!(!is_abandoned(&format!("m{}-0", std::process::id())));
        for other in [
            "default",
            "m",
            "m1x-0",
            "memory-1",
            "m4294967295",
            "m+4294967295-0",
        ] {
            assert!(!is_abandoned(other), "{other}");
        }
    }
}
