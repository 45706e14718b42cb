//! Use of `/dev/shm` by a domain: sizes, checks, removal of leftovers.

use crate::trusted_folder::SHARED_MEMORY_FOLDER as FOLDER;
use crate::{DomainName, Error, domain_bytes, fitting_guest_places};
use message::ProcessKind;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// Unit of the allocated size of a file (`st_blocks`), bytes.
const BLOCK_BYTES: u64 = 512;

/// State of the machine's shared memory from the view of one domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SharedMemory {
    /// Size of the shared-memory file system, bytes.
    pub total_bytes: u64,
    /// Free space of the shared-memory file system, bytes.
    pub free_bytes: u64,
    /// Shared-memory bytes used by the domain's files.
    pub used_by_domain: u64,
    /// Upper bound of the domain's use, bytes.
    pub needed: u64,
}

impl SharedMemory {
    /// Measures `/dev/shm` for a domain with frames of so many points, and so many guest places;
    /// `None` when it does not exist.
    pub fn of_domain(domain: &DomainName, frame_points: usize, guest_places: u32) -> Option<Self> {
        let fs = rustix::fs::statvfs(FOLDER).ok()?;
        let mut state = Self {
            total_bytes: fs.f_blocks * fs.f_frsize,
            free_bytes: fs.f_bavail * fs.f_frsize,
            used_by_domain: 0,
            needed: domain_bytes(frame_points, guest_places),
        };
        let own_prefix = domain.shared_memory_prefix();
        for entry in std::fs::read_dir(FOLDER).ok()?.flatten() {
            let is_own = entry.file_name().to_string_lossy().starts_with(&own_prefix);
            if let (true, Ok(file)) = (is_own, entry.metadata()) {
                state.used_by_domain += file.blocks() * BLOCK_BYTES;
            }
        }
        Some(state)
    }

    /// Shared-memory bytes available to this domain. The size of sparse files of others does
    /// not count: nobody has to give them that memory, and segments of a domain are backed.
    pub fn available(&self) -> u64 {
        self.free_bytes.saturating_add(self.used_by_domain)
    }

    /// `true` when the upper bound of the domain's use is available.
    pub fn is_sufficient(&self) -> bool {
        self.available() >= self.needed
    }
}

/// Checks that what a domain with frames of so many points and so many guest places may use is
/// free.
///
/// # Errors
/// [`Error::SharedMemory`], with the number of places that would fit.
pub fn check_shared_memory(
    name: &DomainName,
    frame_points: usize,
    guest_places: u32,
) -> Result<(), Error> {
    let state = SharedMemory::of_domain(name, frame_points, guest_places);
    let Some(state) = state.filter(|state| !state.is_sufficient()) else {
        return Ok(());
    };
    let available = state.available();
    Err(Error::SharedMemory {
        needed: state.needed,
        available,
        fitting_places: fitting_guest_places(frame_points, guest_places, available),
    })
}

/// Shared-memory files of the domain in `/dev/shm`.
pub(crate) fn files_of(domain: &DomainName) -> Vec<PathBuf> {
    let prefix = domain.shared_memory_prefix();
    let Ok(entries) = std::fs::read_dir(FOLDER) else {
        return Vec::new();
    };
    entries
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix))
        .map(|entry| entry.path())
        .collect()
}

/// Refuses a domain whose names in `/dev/shm` another user has taken: iceoryx2 would
/// map that user's memory. Files of the prefix carry this user's id in their names,
/// so that an honest user never makes one.
pub(crate) fn refuse_foreign_files(domain: &DomainName) -> Result<(), Error> {
    let own = rustix::process::geteuid().as_raw();
    for path in files_of(domain) {
        match std::fs::symlink_metadata(&path) {
            Ok(file) if file.uid() != own || !file.is_file() => {
                let kind = if file.is_symlink() {
                    "a symbolic link"
                } else if file.is_file() {
                    "a file"
                } else {
                    "no regular file"
                };
                return Err(Error::Untrusted {
                    owner: file.uid(),
                    path,
                    kind,
                });
            }
            _ => {}
        }
    }
    Ok(())
}

/// Removes the leftovers of a crashed domain: only for the holder of the domain's
/// exclusive lock. Returns the number of files.
pub(crate) fn remove_leftovers(domain: &DomainName, domain_folder: &Path) -> usize {
    let files = files_of(domain);
    for file in &files {
        let _ = std::fs::remove_file(file);
    }
    let _ = std::fs::remove_dir_all(domain_folder.join("iox2"));
    let sockets = ProcessKind::all().map(|process| format!("{}.sock", process.word()));
    for socket in sockets.chain(["control.sock".to_owned()]) {
        let _ = std::fs::remove_file(domain_folder.join(socket));
    }
    files.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GUEST_PLACES;
    use crate::topic::MAX_FRAME_POINTS;
    use std::os::unix::fs::{chown, symlink};

    /// Name in `/dev/shm` that is removed at the end of the test.
    struct Taken(PathBuf);

    impl Drop for Taken {
        fn drop(&mut self) {
            let _ = std::fs::remove_file(&self.0);
        }
    }

    #[test]
    fn sparse_file_of_others_reserves_no_shared_memory() {
        let (name, _) = domain_with_file("free");
        let sparse = Taken(Path::new(FOLDER).join(format!("sparse-{}", std::process::id())));
        let file = std::fs::File::create(&sparse.0).unwrap();
        file.set_len(1 << 40).unwrap();
        let state = SharedMemory::of_domain(&name, MAX_FRAME_POINTS, GUEST_PLACES).unwrap();
        assert!(state.is_sufficient(), "{state:?}");
    }

    fn domain_with_file(kind: &str) -> (DomainName, Taken) {
        let name = format!("u{}-{kind}", std::process::id());
        let name: DomainName = name.parse().unwrap();
        let path = Path::new(FOLDER).join(format!("{}x.data", name.shared_memory_prefix()));
        (name, Taken(path))
    }

    #[test]
    fn shared_memory_under_a_symbolic_link_is_refused() {
        let (name, taken) = domain_with_file("link");
        std::fs::write(&taken.0, "").unwrap();
        assert!(refuse_foreign_files(&name).is_ok());
        std::fs::remove_file(&taken.0).unwrap();
        symlink("/nowhere", &taken.0).unwrap();
        let sentence = refuse_foreign_files(&name).unwrap_err().to_string();
        assert!(sentence.contains("a symbolic link"), "{sentence}");
    }

    #[test]
    #[ignore = "needs root"]
    fn as_root_shared_memory_of_another_user_is_refused() {
        assert!(
            rustix::process::geteuid().is_root(),
            "this test must be run as root, or skipped with --skip as_root_"
        );
        let (name, taken) = domain_with_file("owner");
        std::fs::write(&taken.0, "").unwrap();
        chown(&taken.0, Some(54_321), None).unwrap();
        let sentence = refuse_foreign_files(&name).unwrap_err().to_string();
        assert!(sentence.contains("a file of user 54321"), "{sentence}");
    }
}
