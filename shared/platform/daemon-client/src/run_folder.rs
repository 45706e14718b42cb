//! Run folder: locks and control sockets of the domains on this machine.

use crate::{DomainName, SHARED_MEMORY_FOLDER};
use rustix::fs::{StatFs, statfs};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// Run folder of a daemon that runs as a systemd service (`RuntimeDirectory`).
const SERVICE_FOLDER: &str = "/run/tabula";

/// Run folder, which holds the folders of all domains.
///
/// It must be on tmpfs: on a disk, creating a service is 20 to 100 times slower.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFolder(PathBuf);

impl RunFolder {
    /// Run folder at a given path.
    pub fn at(folder: PathBuf) -> Self {
        Self(folder)
    }

    /// Run folder of a daemon started by this user: `/run/tabula` when it exists and
    /// belongs to the user (as a service), the user's runtime folder, and otherwise a
    /// private folder in `/dev/shm`.
    pub fn of_user() -> Self {
        let uid = rustix::process::geteuid().as_raw();
        let service = PathBuf::from(SERVICE_FOLDER);
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

    /// Run folders in which a client looks for a domain, best first: its own user's,
    /// the service's, then those of other users in `/dev/shm`. A folder there counts
    /// only when it belongs to the user it is named after.
    pub fn candidates() -> Vec<Self> {
        let mut folders = Self::trusted();
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

    /// Run folders that no other user can have made: this user's, and the service's.
    pub fn trusted() -> Vec<Self> {
        let mut folders = vec![Self::of_user()];
        // Another user may have taken the name of our own folder; in /run only root can.
        folders.retain(|folder| belongs_where_it_is(&folder.0));
        folders.push(Self(PathBuf::from(SERVICE_FOLDER)));
        folders.dedup();
        folders
    }

    /// Path of the run folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// `true` when every user may create entries where this folder is: `/dev/shm`.
    pub fn is_in_shared_place(&self) -> bool {
        self.0.parent() == Some(Path::new(SHARED_MEMORY_FOLDER))
    }

    /// Path of one domain's folder.
    pub fn domain_folder(&self, domain: &DomainName) -> PathBuf {
        self.0.join(domain.to_string())
    }

    /// Path of one domain's control socket.
    pub fn control_socket(&self, domain: &DomainName) -> PathBuf {
        self.domain_folder(domain).join("control.sock")
    }
}

/// `true` for a folder of this user, of root, or of the owner of the folder around it.
fn belongs_where_it_is(path: &Path) -> bool {
    let owner = |path: &Path| {
        let folder = std::fs::symlink_metadata(path).ok()?;
        folder.is_dir().then(|| folder.uid())
    };
    let Some(uid) = owner(path) else {
        return false;
    };
    let own = rustix::process::geteuid().as_raw();
    [0, own].contains(&uid)
        || (path.parent() != Some(Path::new(SHARED_MEMORY_FOLDER))
            && path.parent().and_then(owner) == Some(uid))
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

/// `true` when a folder is on tmpfs or ramfs.
fn is_tmpfs(path: &Path) -> bool {
    const TMPFS_MAGIC: i64 = 0x0102_1994;
    const RAMFS_MAGIC: i64 = 0x8584_58f6;
    statfs(path).is_ok_and(|fs: StatFs| [TMPFS_MAGIC, RAMFS_MAGIC].contains(&fs.f_type))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidate_of_the_user_is_a_folder() {
        let guard = tempfile::tempdir().unwrap();
        let folder = guard.path().join("tabula");
        assert!(!belongs_where_it_is(&folder), "missing");
        std::os::unix::fs::symlink(guard.path(), &folder).unwrap();
        assert!(!belongs_where_it_is(&folder), "a link");
        std::fs::remove_file(&folder).unwrap();
        std::fs::create_dir(&folder).unwrap();
        assert!(belongs_where_it_is(&folder));
    }

    #[test]
    #[ignore = "needs root"]
    fn as_root_candidate_of_another_user_is_left_out() {
        assert!(
            rustix::process::geteuid().is_root(),
            "this test must be run as root, or skipped with --skip as_root_"
        );
        let guard = tempfile::tempdir().unwrap();
        let folder = guard.path().join("tabula");
        std::fs::create_dir(&folder).unwrap();
        std::os::unix::fs::chown(&folder, Some(54_321), None).unwrap();
        assert!(!belongs_where_it_is(&folder));
        std::os::unix::fs::chown(guard.path(), Some(54_321), None).unwrap();
        assert!(belongs_where_it_is(&folder), "in a folder of the same user");
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
}
