//! Looking at a domain from outside, without joining it.

use crate::domain_folder::{DomainName, RunFolder};
use crate::lock_file::LockFile;
use crate::shared_memory::files_of;
use std::path::Path;

/// What is there of a domain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DomainState {
    /// Programs that run in the domain, with their process ids.
    pub running: Vec<(String, Option<u32>)>,
    /// Whether anybody is a member.
    pub is_alive: bool,
    /// Files in shared memory that belong to the domain.
    pub n_files: usize,
}

impl DomainState {
    /// Looks at a domain.
    pub fn of(domain: &DomainName, run_folder: &RunFolder) -> Self {
        let folder = run_folder.of_domain(domain);
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let mut running: Vec<_> = entries
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                let role = name
                    .strip_suffix(".lock")
                    .filter(|role| *role != "domain")?;
                is_held(&entry.path()).then(|| (role.to_owned(), LockFile::read_pid(&entry.path())))
            })
            .collect();
        running.sort();
        Self {
            running,
            is_alive: is_held(&folder.join("domain.lock")),
            n_files: files_of(domain).len(),
        }
    }
}

/// Whether a living process holds a lock. A file that is not there is not made.
fn is_held(path: &Path) -> bool {
    path.exists() && matches!(LockFile::try_exclusive(path), Ok(None))
}
