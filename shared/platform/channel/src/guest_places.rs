//! Guest places: readers of clouds and images beside the daemon, for which their publishers keep
//! memory.
//!
//! A publisher reserves its memory when it is made, for every reader that may come. The number of
//! guests is therefore a property of the domain, which its first member decides; a place of a topic
//! is a lock file, which the kernel releases however its holder ends.

use crate::Error;
use crate::lock_file::LockFile;
use crate::trusted_folder::TrustedFolder;
use std::io::{Read, Write};
use std::sync::Arc;

/// Number of guest places where none is configured.
pub const GUEST_PLACES: u32 = 8;

/// Largest number of guest places of a domain. Chosen: beyond it readers share a bridge.
pub const MAX_GUEST_PLACES: u32 = 32;

/// File with the number of guest places of the domain.
const FILE: &str = "guest-places";

/// Writes the number of guest places of a new domain.
pub(crate) fn decide(folder: &TrustedFolder, places: u32) -> Result<(), Error> {
    let mut file = folder.open_file(FILE, true)?;
    let written = file.set_len(0).and_then(|()| write!(file, "{places}"));
    written.map_err(|source| Error::RunFolder {
        attempt: "write",
        path: folder.path().join(FILE),
        source,
    })
}

/// Number of guest places of a domain; the default where its file cannot be read.
pub(crate) fn of_domain(folder: &TrustedFolder) -> u32 {
    let mut digits = String::new();
    let read = folder
        .open_file(FILE, false)
        .ok()
        .and_then(|file| file.take(16).read_to_string(&mut digits).ok());
    read.and_then(|_| digits.trim().parse().ok())
        .filter(|places| *places <= MAX_GUEST_PLACES)
        .unwrap_or(GUEST_PLACES)
}

/// Place of this process among the guests of a topic.
#[derive(Debug)]
pub(crate) struct GuestPlace {
    _lock: LockFile,
}

impl GuestPlace {
    /// Takes a free place of a topic.
    ///
    /// # Errors
    /// [`Error::NoGuestPlace`] when all are taken, with the processes that have them.
    pub(crate) fn take(
        folder: &Arc<TrustedFolder>,
        service: &'static str,
        places: u32,
    ) -> Result<Self, Error> {
        let file = |place| format!("guest-{}-{place}.place", service.replace('/', "-"));
        for place in 0..places {
            if let Some(mut lock) = LockFile::try_exclusive(folder, &file(place))? {
                lock.write_pid()?;
                return Ok(Self { _lock: lock });
            }
        }
        let holder = |place| LockFile::read_pid(folder, &file(place));
        let mut holders: Vec<u32> = (0..places).filter_map(holder).collect();
        holders.sort_unstable();
        holders.dedup();
        Err(Error::NoGuestPlace {
            service,
            places,
            holders,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guest_place_is_free_again_when_its_holder_goes() {
        let guard = tempfile::tempdir().unwrap();
        let folder = Arc::new(TrustedFolder::open(guard.path()).unwrap());
        assert_eq!(of_domain(&folder), GUEST_PLACES);
        decide(&folder, 2).unwrap();
        assert_eq!(of_domain(&folder), 2);
        let take = || GuestPlace::take(&folder, "camera/cloud", 2);
        let _first = take().unwrap();
        let second = take().unwrap();
        let sentence = take().unwrap_err().to_string();
        let pid = std::process::id().to_string();
        assert!(
            sentence.contains(&pid) && sentence.contains("guest_places"),
            "{sentence}"
        );
        drop(second);
        assert!(take().is_ok());
    }
}
