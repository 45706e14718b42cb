//! What lies in `/dev/shm`.

use crate::{DomainName, Reservation, domain_reservation};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

const FOLDER: &str = "/dev/shm";

/// State of the machine's shared memory as one domain sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SharedMemory {
    /// Size of the file system.
    pub total_bytes: u64,
    /// Bytes not used by anybody.
    pub free_bytes: u64,
    /// Bytes the domain's files use now.
    pub used_by_domain: u64,
    /// Bytes promised to others: sparse files use memory only when touched, and
    /// then find it gone with SIGBUS if somebody else has taken it.
    pub promised_to_others: u64,
    /// Bytes this domain can come to use.
    pub needed: u64,
}

impl SharedMemory {
    /// Measures `/dev/shm`; `None` when it is not there.
    pub fn of_domain(domain: &DomainName) -> Option<Self> {
        let fs = rustix::fs::statvfs(FOLDER).ok()?;
        let mut state = Self {
            total_bytes: fs.f_blocks * fs.f_frsize,
            free_bytes: fs.f_bavail * fs.f_frsize,
            used_by_domain: 0,
            promised_to_others: 0,
            needed: domain_reservation().iter().map(Reservation::bytes).sum(),
        };
        let own_prefix = domain.prefix();
        for entry in std::fs::read_dir(FOLDER).ok()?.flatten() {
            let Ok(file) = entry.metadata() else { continue };
            let allocated = file.blocks() * 512;
            if entry.file_name().to_string_lossy().starts_with(&own_prefix) {
                state.used_by_domain += allocated;
            } else if file.is_file() {
                state.promised_to_others += file.size().saturating_sub(allocated);
            }
        }
        Some(state)
    }

    /// Bytes this domain can count on.
    pub fn available(&self) -> u64 {
        (self.free_bytes + self.used_by_domain).saturating_sub(self.promised_to_others)
    }

    /// Whether the domain's limits fit.
    pub fn is_enough(&self) -> bool {
        self.available() >= self.needed
    }
}

/// Files of the domain in `/dev/shm`.
pub(crate) fn files_of(domain: &DomainName) -> Vec<PathBuf> {
    let prefix = domain.prefix();
    let Ok(entries) = std::fs::read_dir(FOLDER) else {
        return Vec::new();
    };
    entries
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix))
        .map(|entry| entry.path())
        .collect()
}

/// Removes everything that a dead domain has left: only for the one that holds
/// the domain's lock alone. Returns how many files there were.
pub fn remove_leftovers(domain: &DomainName, domain_folder: &Path) -> usize {
    let files = files_of(domain);
    for file in &files {
        let _ = std::fs::remove_file(file);
    }
    let _ = std::fs::remove_dir_all(domain_folder.join("iox2"));
    let _ = std::fs::remove_file(domain_folder.join("control.sock"));
    files.len()
}
