//! Inspection of a domain from outside, without joining it.

use crate::domain::DOMAIN_LOCK;
use crate::lock_file::LockFile;
use crate::shared_memory::files_of;
use crate::trusted_folder::TrustedFolder;
use crate::{DomainName, RunFolder};

/// State of a domain: running programs and remaining files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DomainState {
    /// Programs running in the domain, with their process ids.
    pub running: Vec<(String, Option<u32>)>,
    /// `true` when the domain has a member.
    pub is_alive: bool,
    /// Number of files in shared memory that belong to the domain.
    pub n_files: usize,
}

impl DomainState {
    /// Lists the programs and files of a domain.
    pub fn inspect(domain: &DomainName, run_folder: &RunFolder) -> Self {
        let path = run_folder.domain_folder(domain);
        let entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
        // A folder that another user controls holds no domain of ours.
        let Ok(folder) = TrustedFolder::open(&path) else {
            return Self {
                running: Vec::new(),
                is_alive: false,
                n_files: files_of(domain).len(),
            };
        };
        let mut running: Vec<_> = entries
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                let role = name
                    .strip_suffix(".lock")
                    .filter(|role| *role != "domain")?;
                LockFile::is_held(&folder, &name)
                    .then(|| (role.to_owned(), LockFile::read_pid(&folder, &name)))
            })
            .collect();
        running.sort();
        Self {
            running,
            is_alive: LockFile::is_held(&folder, DOMAIN_LOCK),
            n_files: files_of(domain).len(),
        }
    }
}
