//! A domain's name and its run folder.

use crate::Error;
use crate::trusted_folder::SHARED_MEMORY_FOLDER;
use rustix::fs::{StatFs, statfs};
use std::fmt;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The name of a domain: 1 to 32 of a-z, 0-9 and `-`. An underscore would let
/// one domain's prefix in shared memory be the beginning of another's.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct DomainName(String);

impl FromStr for DomainName {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let allowed = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'-';
        if (1..=32).contains(&name.len()) && name.bytes().all(allowed) {
            Ok(Self(name.to_owned()))
        } else {
            Err(Error::DomainName(name.to_owned()))
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
    /// Prefix of the domain's files in shared memory.
    pub(crate) fn prefix(&self) -> String {
        format!("tabula_{}_{}_", rustix::process::geteuid().as_raw(), self.0)
    }
}

/// The folder that holds the run folders of all domains.
///
/// It must lie on tmpfs: on a disk, creating a service is 20 to 100 times slower.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFolder(PathBuf);

impl RunFolder {
    /// A given folder.
    pub fn at(folder: PathBuf) -> Self {
        Self(folder)
    }

    /// Where a daemon started by this user puts its domains: `/run/tabula` when
    /// it is there and ours (as a service), the user's runtime folder, and
    /// otherwise a folder of the user's own in `/dev/shm`.
    pub fn of_user() -> Self {
        let uid = rustix::process::geteuid().as_raw();
        let service = PathBuf::from("/run/tabula");
        let session =
            std::env::var_os("XDG_RUNTIME_DIR").map(|dir| PathBuf::from(dir).join("tabula"));
        let is_ours = |path: &Path| {
            rustix::fs::stat(path).is_ok_and(|stat| stat.st_uid == uid) && is_tmpfs(path)
        };
        if is_ours(&service) {
            return Self(service);
        }
        match session {
            Some(folder) if folder.parent().is_some_and(is_tmpfs) => Self(folder),
            _ => Self(Path::new(SHARED_MEMORY_FOLDER).join(format!("tabula-{uid}"))),
        }
    }

    /// Where a client looks for a domain, best first: its own user's folder, the
    /// service's, then those of other users in `/dev/shm`. A folder there counts
    /// only when it belongs to the user it is named after.
    pub fn candidates() -> Vec<Self> {
        let mut folders = vec![Self::of_user(), Self(PathBuf::from("/run/tabula"))];
        // Another user may have taken the name of our own folder.
        folders.retain(|folder| !folder.is_in_shared_place() || is_named_after_owner(&folder.0));
        let Ok(entries) = std::fs::read_dir(SHARED_MEMORY_FOLDER) else {
            return folders;
        };
        let mut others: Vec<_> = entries
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| is_named_after_owner(path))
            .collect();
        others.sort();
        folders.extend(others.into_iter().map(Self));
        folders.dedup();
        folders
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// `true` when every user may create entries where this folder is: `/dev/shm`.
    pub(crate) fn is_in_shared_place(&self) -> bool {
        self.0.parent() == Some(Path::new(SHARED_MEMORY_FOLDER))
    }

    /// Folder of one domain.
    pub fn of_domain(&self, domain: &DomainName) -> PathBuf {
        self.0.join(&domain.0)
    }

    /// Control socket of one domain.
    pub fn control_socket(&self, domain: &DomainName) -> PathBuf {
        self.of_domain(domain).join("control.sock")
    }
}

fn is_named_after_owner(path: &Path) -> bool {
    let owner = path
        .file_name()
        .and_then(|name| name.to_str())
        .and_then(|name| name.strip_prefix("tabula-"))
        .and_then(|uid| uid.parse::<u32>().ok());
    owner.is_some_and(|uid| {
        std::fs::symlink_metadata(path).is_ok_and(|folder| folder.is_dir() && folder.uid() == uid)
    })
}

/// Whether a folder lies in memory.
pub(crate) fn is_tmpfs(path: &Path) -> bool {
    const TMPFS_MAGIC: i64 = 0x0102_1994;
    const RAMFS_MAGIC: i64 = 0x8584_58f6;
    statfs(path).is_ok_and(|fs: StatFs| [TMPFS_MAGIC, RAMFS_MAGIC].contains(&fs.f_type))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_could_leave_the_folder_are_refused() {
        for good in ["default", "robot-2", "a"] {
            assert_eq!(good.parse::<DomainName>().unwrap().to_string(), good);
        }
        for bad in ["", "..", "a/b", "A", "a_b", "ä", "a b", &"x".repeat(33)] {
            let sentence = bad.parse::<DomainName>().unwrap_err().to_string();
            assert!(sentence.contains("choose"), "{sentence}");
        }
    }

    #[test]
    fn candidates_in_shared_memory_are_folders_of_the_user_in_their_name() {
        let own = rustix::process::geteuid().as_raw();
        let guard = tempfile::tempdir().unwrap();
        let folder = guard.path().join(format!("tabula-{own}"));
        assert!(!is_named_after_owner(&folder));
        std::os::unix::fs::symlink(guard.path(), &folder).unwrap();
        assert!(!is_named_after_owner(&folder), "a link");
        std::fs::remove_file(&folder).unwrap();
        std::fs::create_dir(&folder).unwrap();
        assert!(is_named_after_owner(&folder));
        let other = guard.path().join(format!("tabula-{}", own + 1));
        std::fs::create_dir(&other).unwrap();
        assert!(!is_named_after_owner(&other));
    }

    #[test]
    fn no_prefix_is_the_beginning_of_another() {
        let prefix = |name: &str| name.parse::<DomainName>().unwrap().prefix();
        assert!(!prefix("a-b").starts_with(&prefix("a")));
    }
}
