//! Stop button: stops the arm from any process of the same user.

use crate::word_file::{self, STOP_WORD_FILE, StopRecord, StopWordError, Word, monotonic_ns};
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Pause between two looks at the file. Chosen: an eighth of the loop's cycle.
const POLL_PERIOD: Duration = Duration::from_millis(1);

/// Stop button of one arm, opened for one use: an arm that begins anew may have another file.
#[derive(Debug)]
pub struct StopButton {
    file: File,
    path: PathBuf,
}

impl StopButton {
    /// Opens the stop word in the folder of a domain.
    ///
    /// # Errors
    /// [`StopWordError::Absent`] without an arm; [`StopWordError::File`] when the system refuses.
    pub fn open(domain_folder: &Path) -> Result<Self, StopWordError> {
        let path = domain_folder.join(STOP_WORD_FILE);
        let flags = OFlags::RDWR | OFlags::NOFOLLOW | OFlags::CLOEXEC | OFlags::NONBLOCK;
        match rustix::fs::open(&path, flags, Mode::empty()) {
            Ok(descriptor) => Ok(Self {
                file: File::from(descriptor),
                path,
            }),
            Err(Errno::NOENT | Errno::NOTDIR) => Err(StopWordError::Absent(path)),
            Err(error) => Err(StopWordError::new(&path, error)),
        }
    }

    /// Stops the arm: writes another word, the present time. Returns the word.
    ///
    /// # Errors
    /// [`StopWordError::File`] when the system refuses.
    pub fn press(&self) -> Result<u64, StopWordError> {
        let failed = |error| StopWordError::new(&self.path, error);
        let before = word_file::read(&self.file).map_err(failed)?;
        let now_ns = monotonic_ns();
        let word = match before {
            Some(before) if before.pressed == now_ns => now_ns + 1,
            _ => now_ns,
        };
        word_file::write(&self.file, Word::Pressed, word).map_err(failed)?;
        Ok(word)
    }

    /// Content of the file.
    ///
    /// # Errors
    /// [`StopWordError::File`] when the system refuses, or the file is cut off.
    pub fn record(&self) -> Result<StopRecord, StopWordError> {
        let record = word_file::read(&self.file);
        let record = record.map_err(|error| StopWordError::new(&self.path, error))?;
        record.ok_or_else(|| StopWordError::new(&self.path, "it is too short"))
    }

    /// Waits until the arm's loop has acted on a word or a later one; `None` when it has not within
    /// `limit`.
    ///
    /// # Errors
    /// As for [`record`](Self::record).
    pub fn wait_until_taken(
        &self,
        word: u64,
        limit: Duration,
    ) -> Result<Option<StopRecord>, StopWordError> {
        let begin = Instant::now();
        loop {
            let record = self.record()?;
            if record.taken == word || (record.taken > word && record.taken == record.pressed) {
                return Ok(Some(record));
            }
            if begin.elapsed() >= limit {
                return Ok(None);
            }
            std::thread::sleep(POLL_PERIOD);
        }
    }
}
