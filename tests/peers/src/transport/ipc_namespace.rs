//! Where a pair of processes meets, and nothing else does.

use channel::{DomainName, RunFolder};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

const SHARED_MEMORY: &str = "/dev/shm";

/// A folder in memory and the names that go with it.
#[derive(Debug, Clone)]
pub struct Place {
    pub folder: PathBuf,
    pub domain: DomainName,
}

/// A place of this run, removed with all that processes have left in it.
#[derive(Debug)]
pub struct OwnPlace {
    pub place: Place,
    folder: tempfile::TempDir,
}

impl Place {
    /// The place in a folder that somebody else has made.
    pub fn at(folder: PathBuf) -> Option<Self> {
        let name = folder.file_name()?.to_str()?;
        let domain = name.parse().ok()?;
        Some(Self { folder, domain })
    }

    pub fn run_folder(&self) -> RunFolder {
        RunFolder::at(self.folder.join("run"))
    }

    pub fn root_of_iceoryx2(&self) -> PathBuf {
        self.folder.join("iceoryx2")
    }

    pub fn prefix_of_iceoryx2(&self) -> String {
        format!("{}_", self.domain)
    }

    pub fn socket(&self) -> PathBuf {
        self.folder.join("socket")
    }

    /// Files in shared memory that have the place's name: those of iceoryx2 and
    /// of our domain.
    pub fn files(&self) -> io::Result<Vec<PathBuf>> {
        let name = format!("{}_", self.domain);
        let is_of_it = |path: &PathBuf| path.is_file() && path.to_string_lossy().contains(&name);
        let entries = fs::read_dir(SHARED_MEMORY)?.flatten();
        Ok(entries.map(|entry| entry.path()).filter(is_of_it).collect())
    }
}

impl OwnPlace {
    pub fn new() -> io::Result<Self> {
        let folder = tempfile::Builder::new()
            .prefix(&format!("peers-{}-", std::process::id()))
            .rand_bytes(0)
            .tempdir_in(Path::new(SHARED_MEMORY))?;
        let place = Place::at(folder.path().to_owned());
        let place = place.ok_or_else(|| io::Error::other("a folder with an odd name"))?;
        fs::create_dir(place.root_of_iceoryx2())?;
        Ok(Self { place, folder })
    }
}

impl Drop for OwnPlace {
    fn drop(&mut self) {
        for file in self.place.files().unwrap_or_default() {
            let _ = fs::remove_file(file);
        }
        // zenoh's names are random; it removes those that no process has open.
        zenoh::shm::cleanup_orphaned_shm_segments();
        let _ = fs::remove_dir_all(self.folder.path());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_of_a_place() {
        let own = OwnPlace::new().unwrap();
        let place = own.place.clone();
        assert_eq!(
            Place::at(place.folder.clone()).unwrap().domain,
            place.domain
        );
        let file = Path::new(SHARED_MEMORY).join(format!("{}left", place.prefix_of_iceoryx2()));
        fs::write(&file, "").unwrap();
        fs::write(place.socket(), "").unwrap();
        assert_eq!(place.files().unwrap(), [file]);
        drop(own);
        assert!(place.files().unwrap().is_empty());
        assert!(!place.folder.exists());
    }
}
