//! IPC namespace: folder and names that isolate a process pair from all others.

use channel::{DomainName, RunFolder};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Mount point of POSIX shared memory.
const SHARED_MEMORY: &str = "/dev/shm";

/// Folder in memory and the names derived from it.
#[derive(Debug, Clone)]
pub struct IpcNamespace {
    /// Folder of the sockets and run-time files.
    pub folder: PathBuf,
    /// Domain of the channel.
    pub domain: DomainName,
}

/// Namespace owned by this process; dropping it removes all files that its processes left.
#[derive(Debug)]
pub struct OwnedIpcNamespace {
    /// Namespace of the folder.
    pub namespace: IpcNamespace,
    folder: tempfile::TempDir,
}

impl IpcNamespace {
    /// Namespace of an existing folder; `None` if its name is no domain name.
    pub fn at(folder: PathBuf) -> Option<Self> {
        let name = folder.file_name()?.to_str()?;
        let domain = name.parse().ok()?;
        Some(Self { folder, domain })
    }

    /// Run folder of the channel.
    pub fn run_folder(&self) -> RunFolder {
        RunFolder::at(self.folder.join("run"))
    }

    /// Root path of iceoryx2.
    pub fn iceoryx2_root(&self) -> PathBuf {
        self.folder.join("iceoryx2")
    }

    /// File-name prefix of iceoryx2.
    pub fn iceoryx2_prefix(&self) -> String {
        format!("{}_", self.domain)
    }

    /// Path of the Unix socket.
    pub fn socket(&self) -> PathBuf {
        self.folder.join("socket")
    }

    /// Files in shared memory with the namespace's prefix: those of iceoryx2 and of our channel.
    ///
    /// # Errors
    /// If shared memory cannot be listed.
    pub fn files(&self) -> io::Result<Vec<PathBuf>> {
        let name = format!("{}_", self.domain);
        let has_prefix = |path: &PathBuf| path.is_file() && path.to_string_lossy().contains(&name);
        let entries = fs::read_dir(SHARED_MEMORY)?.flatten();
        Ok(entries
            .map(|entry| entry.path())
            .filter(has_prefix)
            .collect())
    }
}

impl OwnedIpcNamespace {
    /// New namespace, named after this process.
    ///
    /// # Errors
    /// If its folder cannot be created.
    pub fn new() -> io::Result<Self> {
        let folder = tempfile::Builder::new()
            .prefix(&format!("peers-{}-", std::process::id()))
            .rand_bytes(0)
            .tempdir_in(Path::new(SHARED_MEMORY))?;
        let namespace = IpcNamespace::at(folder.path().to_owned());
        let namespace = namespace.ok_or_else(|| io::Error::other("a folder with an odd name"))?;
        fs::create_dir(namespace.iceoryx2_root())?;
        Ok(Self { namespace, folder })
    }
}

impl Drop for OwnedIpcNamespace {
    fn drop(&mut self) {
        for file in self.namespace.files().unwrap_or_default() {
            let _ = fs::remove_file(file);
        }
        // The names of zenoh's segments are random; zenoh removes those that no process has open.
        zenoh::shm::cleanup_orphaned_shm_segments();
        let _ = fs::remove_dir_all(self.folder.path());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drop_removes_all_files_of_the_namespace() {
        let own = OwnedIpcNamespace::new().unwrap();
        let namespace = own.namespace.clone();
        assert_eq!(
            IpcNamespace::at(namespace.folder.clone()).unwrap().domain,
            namespace.domain
        );
        let file = Path::new(SHARED_MEMORY).join(format!("{}left", namespace.iceoryx2_prefix()));
        fs::write(&file, "").unwrap();
        fs::write(namespace.socket(), "").unwrap();
        assert_eq!(namespace.files().unwrap(), [file]);
        drop(own);
        assert!(namespace.files().unwrap().is_empty());
        assert!(!namespace.folder.exists());
    }
}
