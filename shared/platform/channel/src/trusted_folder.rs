//! Ownership checks for files in shared places such as `/dev/shm` (symlink attack, TOCTOU).
//!
//! Any user may create entries in a folder with the sticky bit, also under the
//! names that this crate is going to use. So nothing there is used before its
//! owner, kind and mode are known. Each check is made on an open descriptor, and
//! files below a folder are opened relative to its descriptor (`openat`), so that
//! no path can be exchanged between check and use.

use crate::Error;
use crate::group::socket_group;
use rustix::fs::{
    AtFlags, CWD, FileType, Gid, Mode, OFlags, Stat, chownat, fchmod, fchown, fstat, mkdirat,
    openat, renameat, statat, unlinkat,
};
use rustix::io::Errno;
use std::fs::{DirBuilder, File};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};

/// Write permission of the group and of others.
const WRITABLE_BY_OTHERS: u32 = 0o022;
/// The sticky bit: only the owner of an entry may remove or rename it.
const STICKY: u32 = 0o1000;
/// Folder of POSIX shared memory.
pub(crate) const SHARED_MEMORY_FOLDER: &str = "/dev/shm";

/// Open folder that belongs to this user or to root and that only its owner may
/// write.
#[derive(Debug)]
pub(crate) struct TrustedFolder {
    descriptor: OwnedFd,
    path: PathBuf,
}

impl TrustedFolder {
    /// Opens a folder by its path, or creates it with `mode` (less the umask)
    /// and its missing parents with mode 0755.
    ///
    /// # Errors
    /// [`Error::Untrusted`] when the folder, or the folder it is in, is under
    /// another user's control; [`Error::RunFolder`] when the system refuses.
    pub(crate) fn create(path: &Path, mode: u32) -> Result<Self, Error> {
        let parent = parent_of(path);
        DirBuilder::new()
            .recursive(true)
            .mode(0o755)
            .create(parent)
            .map_err(|source| failed(ATTEMPT, path, source))?;
        let parent = open_parent(parent)?;
        let folder = Self {
            descriptor: parent,
            path: parent_of(path).to_owned(),
        };
        folder.create_subfolder(name_of(path)?, mode)
    }

    /// Opens an existing folder by its path.
    ///
    /// # Errors
    /// As [`create`](Self::create); also when the folder does not exist.
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        let folder = Self {
            descriptor: open_parent(parent_of(path))?,
            path: parent_of(path).to_owned(),
        };
        folder.open_subfolder(name_of(path)?)
    }

    /// Opens a folder in this one, or creates it with `mode` (less the umask).
    ///
    /// # Errors
    /// As [`create`](Self::create).
    pub(crate) fn create_subfolder(&self, name: &str, mode: u32) -> Result<Self, Error> {
        match mkdirat(&self.descriptor, name, Mode::from_raw_mode(mode)) {
            Ok(()) | Err(Errno::EXIST) => self.open_subfolder(name),
            Err(error) => Err(failed(ATTEMPT, &self.path.join(name), error)),
        }
    }

    /// Opens an existing folder in this one.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub(crate) fn open_subfolder(&self, name: &str) -> Result<Self, Error> {
        let path = self.path.join(name);
        let flags = OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::RDONLY | OFlags::CLOEXEC;
        let descriptor = match openat(&self.descriptor, name, flags, Mode::empty()) {
            Ok(descriptor) => descriptor,
            Err(error) => return Err(self.not_opened(name, error, "open the run folder")),
        };
        let stat = fstat(&descriptor).map_err(|error| failed(ATTEMPT, &path, error))?;
        if !is_own_or_root(&stat) || is_writable_by_others(&stat) {
            return Err(untrusted(path, &stat));
        }
        Ok(Self { descriptor, path })
    }

    /// Opens a regular file of this user for reading and writing, without
    /// truncation; `create` makes it with mode 0600 when it does not exist.
    ///
    /// # Errors
    /// [`Error::Untrusted`] when the name is taken by a symbolic link, by
    /// anything but a regular file, by a file of another user, or by a file with
    /// a second name (hard link).
    pub(crate) fn open_file(&self, name: &str, create: bool) -> Result<File, Error> {
        let mut flags = OFlags::RDWR | OFlags::NOFOLLOW | OFlags::CLOEXEC | OFlags::NONBLOCK;
        flags.set(OFlags::CREATE, create);
        let mode = Mode::RUSR | Mode::WUSR;
        let descriptor = openat(&self.descriptor, name, flags, mode)
            .map_err(|error| self.not_opened(name, error, "open the lock file"))?;
        let path = self.path.join(name);
        let stat =
            fstat(&descriptor).map_err(|error| failed("open the lock file", &path, error))?;
        let is_regular = FileType::from_raw_mode(stat.st_mode) == FileType::RegularFile;
        // Without a name it was removed just now: the caller's own check finds that.
        if !is_regular || stat.st_uid != own_uid() || stat.st_nlink > 1 {
            return Err(untrusted(path, &stat));
        }
        Ok(File::from(descriptor))
    }

    /// Renames an entry of the folder, in place of an entry with the other name.
    ///
    /// # Errors
    /// [`Error::RunFolder`] when the system refuses.
    pub(crate) fn rename(&self, from: &str, to: &str) -> Result<(), Error> {
        renameat(&self.descriptor, from, &self.descriptor, to)
            .map_err(|error| failed("replace", &self.path.join(to), error))
    }

    /// Removes a file of the folder if it is there.
    pub(crate) fn remove_file(&self, name: &str) {
        let _ = unlinkat(&self.descriptor, name, AtFlags::empty());
    }

    /// `true` when `name` in this folder is the open file: same device and inode.
    pub(crate) fn names(&self, name: &str, file: &File) -> bool {
        let by_name = statat(&self.descriptor, name, AtFlags::SYMLINK_NOFOLLOW);
        match (by_name, fstat(file)) {
            (Ok(a), Ok(b)) => (a.st_dev, a.st_ino) == (b.st_dev, b.st_ino),
            _ => false,
        }
    }

    /// Path of the trusted folder.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Changes the permissions of the folder, whatever the umask is.
    pub(crate) fn set_mode(&self, mode: u32) {
        let _ = fchmod(&self.descriptor, Mode::from_raw_mode(mode));
    }

    /// Gives the folder to the group tabula; false without that group, or without
    /// the right to do so.
    pub(crate) fn share_with_group(&self) -> bool {
        let has_group =
            |group: Gid| fstat(&self.descriptor).is_ok_and(|stat| stat.st_gid == group.as_raw());
        // A service whose own group it is may not call `fchown` at all.
        socket_group().is_some_and(|group| {
            has_group(group) || fchown(&self.descriptor, None, Some(group)).is_ok()
        })
    }

    /// Gives an entry of the folder to the group tabula, if possible.
    pub(crate) fn share_entry_with_group(&self, name: &str) {
        if let Some(group) = socket_group() {
            let descriptor = self.descriptor.as_fd();
            let flags = AtFlags::SYMLINK_NOFOLLOW;
            let _ = chownat(descriptor, name, None, Some(group), flags);
        }
    }

    fn not_opened(&self, name: &str, error: Errno, attempt: &'static str) -> Error {
        let path = self.path.join(name);
        match statat(&self.descriptor, name, AtFlags::SYMLINK_NOFOLLOW) {
            Ok(stat) if is_obstacle(error) || !is_own_or_root(&stat) => untrusted(path, &stat),
            _ => failed(attempt, &path, error),
        }
    }
}

const ATTEMPT: &str = "make the run folder";

/// `true` for errors of `openat` caused by an entry of an unexpected kind.
fn is_obstacle(error: Errno) -> bool {
    [Errno::LOOP, Errno::NOTDIR, Errno::ISDIR, Errno::NXIO].contains(&error)
}

/// Opens the folder that holds a run folder, after the check that no other user can
/// exchange the entries of ours: it belongs to root or to us, and others who may
/// write there are restrained by the sticky bit.
fn open_parent(path: &Path) -> Result<OwnedFd, Error> {
    let flags = OFlags::DIRECTORY | OFlags::RDONLY | OFlags::CLOEXEC;
    let attempt = "open the run folder";
    let descriptor =
        openat(CWD, path, flags, Mode::empty()).map_err(|error| failed(attempt, path, error))?;
    let stat = fstat(&descriptor).map_err(|error| failed(attempt, path, error))?;
    // In a user namespace root's own folders seem to belong to nobody.
    let is_ours = is_own_or_root(&stat) || path == Path::new(SHARED_MEMORY_FOLDER);
    if !is_ours || (is_writable_by_others(&stat) && stat.st_mode & STICKY == 0) {
        return Err(untrusted(path.to_owned(), &stat));
    }
    Ok(descriptor)
}

fn parent_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => path,
    }
}

fn name_of(path: &Path) -> Result<&str, Error> {
    let name = path.file_name().and_then(|name| name.to_str());
    name.ok_or_else(|| failed(ATTEMPT, path, std::io::ErrorKind::InvalidInput))
}

fn own_uid() -> u32 {
    rustix::process::geteuid().as_raw()
}

fn is_own_or_root(stat: &Stat) -> bool {
    [0, own_uid()].contains(&stat.st_uid)
}

fn is_writable_by_others(stat: &Stat) -> bool {
    stat.st_mode & WRITABLE_BY_OTHERS != 0
}

fn untrusted(path: PathBuf, stat: &Stat) -> Error {
    let kind = match FileType::from_raw_mode(stat.st_mode) {
        FileType::Symlink => "a symbolic link",
        FileType::Directory if is_own_or_root(stat) && is_writable_by_others(stat) => {
            "a folder that others may write"
        }
        FileType::Directory => "a folder",
        FileType::RegularFile if stat.st_nlink > 1 => "a file with several names",
        FileType::RegularFile => "a file",
        _ => "neither a folder nor a file",
    };
    Error::Untrusted {
        path,
        kind,
        owner: stat.st_uid,
    }
}

fn failed(attempt: &'static str, path: &Path, source: impl Into<std::io::Error>) -> Error {
    Error::RunFolder {
        attempt,
        path: path.to_owned(),
        source: source.into(),
    }
}

#[cfg(test)]
mod tests;
