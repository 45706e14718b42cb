//! Home folder of a daemon's persistent data.

use crate::Failure;
use channel::DomainName;
use rustix::fs::{Mode, OFlags, fchmod, fstat, open};
use rustix::process::geteuid;
use std::fs::DirBuilder;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};

/// Permissions of the group and of others.
const OPEN_TO_OTHERS: u32 = 0o077;
/// Name of the folder of the perceptual memory.
const PERCEPTUAL_MEMORY: &str = "perceptual-memory";
/// Home folder of a daemon that runs as systemd services (`StateDirectory`).
const SERVICE_HOME: &str = "/var/lib/tabula";
/// Domain of the systemd services.
const SERVICE_DOMAIN: &str = "default";
/// Name of the folder of the working memory.
const WORKING_MEMORY: &str = "working-memory";

/// Folder of a daemon's persistent data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Home(PathBuf);

impl Home {
    /// Data folder at a given path.
    pub fn at(folder: PathBuf) -> Self {
        Self(folder)
    }

    /// Default home folder: the state folder given by systemd, that of the services when this is
    /// their user, otherwise a folder in the user's data folder, one for each domain.
    pub fn default_for(domain: &DomainName) -> Self {
        let folder = |name: &str| {
            std::env::var_os(name)
                .map(PathBuf::from)
                .filter(|path| path.is_absolute())
        };
        if let Some(state) = folder("STATE_DIRECTORY") {
            return Self(state);
        }
        let is_of_services = domain.to_string() == SERVICE_DOMAIN;
        if is_of_services && belongs_to_this_user(Path::new(SERVICE_HOME)) {
            return Self(SERVICE_HOME.into());
        }
        let data = folder("XDG_DATA_HOME")
            .or_else(|| folder("HOME").map(|home| home.join(".local/share")))
            .unwrap_or_else(|| PathBuf::from("/var/lib"));
        Self(data.join("tabula").join(domain.to_string()))
    }

    /// Path of the data folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Folder in the data folder that only this user can enter (mode 0700). It is created when it
    /// is missing, and closed to others when it is open to them.
    ///
    /// # Errors
    /// When it is a link or no folder, belongs to another user, or cannot be created.
    pub fn private_folder(&self, name: &str) -> Result<PathBuf, Failure> {
        let path = self.0.join(name);
        let failed = |error: &dyn std::fmt::Display| {
            Failure::general(format!(
                "{} cannot be used for what is learned: {error}; name another data folder by --home",
                path.display()
            ))
        };
        DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&path)
            .map_err(|error| failed(&error))?;
        let flags = OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::RDONLY | OFlags::CLOEXEC;
        let folder = open(&path, flags, Mode::empty())
            .map_err(|_| failed(&"it is a link, or this user may not read it"))?;
        let stat = fstat(&folder).map_err(|error| failed(&error))?;
        if stat.st_uid != geteuid().as_raw() {
            return Err(failed(&format!("it belongs to user {}", stat.st_uid)));
        }
        if stat.st_mode & OPEN_TO_OTHERS != 0 {
            fchmod(&folder, Mode::RWXU).map_err(|error| failed(&error))?;
            tracing::warn!(
                "{} was open to other users and is closed now",
                path.display()
            );
        }
        Ok(path)
    }

    /// Folder of the perceptual memory's database.
    pub fn perceptual_memory(&self) -> PathBuf {
        self.0.join(PERCEPTUAL_MEMORY)
    }

    /// Folder of the working memory's database.
    pub fn working_memory(&self) -> PathBuf {
        self.0.join(WORKING_MEMORY)
    }

    /// Creates the folders of both memories for this user only, or checks them.
    ///
    /// # Errors
    /// As [`Self::private_folder`].
    pub fn prepare_memories(&self) -> Result<(), Failure> {
        self.private_folder(PERCEPTUAL_MEMORY)?;
        self.private_folder(WORKING_MEMORY)?;
        Ok(())
    }
}

/// `true` for a folder of this user; root's do not count, who is not the services' user.
fn belongs_to_this_user(folder: &Path) -> bool {
    let own = geteuid();
    !own.is_root() && rustix::fs::lstat(folder).is_ok_and(|stat| stat.st_uid == own.as_raw())
}

/// Creates all files of this process for its user only, whatever its parent's umask.
pub fn set_private_umask() {
    rustix::process::umask(Mode::from_raw_mode(OPEN_TO_OTHERS));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{Permissions, create_dir, metadata, set_permissions};
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn private_folder_is_created_and_closed_to_others() {
        let guard = tempfile::tempdir().unwrap();
        let home = Home::at(guard.path().join("home"));
        let path = home.private_folder("memory").unwrap();
        assert_eq!(mode(&path), 0o700);
        set_permissions(&path, Permissions::from_mode(0o775)).unwrap();
        home.private_folder("memory").unwrap();
        assert_eq!(mode(&path), 0o700);
    }

    #[test]
    fn private_folder_is_neither_link_nor_file() {
        let guard = tempfile::tempdir().unwrap();
        let home = Home::at(guard.path().to_owned());
        create_dir(guard.path().join("elsewhere")).unwrap();
        symlink(guard.path().join("elsewhere"), guard.path().join("memory")).unwrap();
        let refused = home.private_folder("memory").unwrap_err();
        assert!(refused.sentence.contains("a link"), "{refused}");
        std::fs::write(guard.path().join("file"), "").unwrap();
        assert!(home.private_folder("file").is_err());
    }

    #[test]
    #[ignore = "needs root"]
    fn as_root_private_folder_of_another_user_is_refused() {
        let guard = tempfile::tempdir().unwrap();
        let home = Home::at(guard.path().to_owned());
        let path = home.private_folder("memory").unwrap();
        std::os::unix::fs::chown(&path, Some(54_321), None).unwrap();
        let refused = home.private_folder("memory").unwrap_err();
        assert!(refused.sentence.contains("54321"), "{refused}");
    }
}
