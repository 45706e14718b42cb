//! Stop word as the arm's loop sees it: read in every cycle.

use crate::word_file::{self, STOP_WORD_FILE, StopWordError, Word};
use rustix::fs::{FileType, Mode, OFlags, Stat, fstat, ftruncate};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Length of the file, bytes.
const N_BYTES: u64 = 64;

/// Stop word of an arm; there is one in the folder of a domain, while its arm's loop runs.
///
/// A file that was removed or cut off by somebody could no longer stop the arm: that is a stop, too,
/// and the file is made again.
#[derive(Debug)]
pub struct StopWord {
    file: File,
    path: PathBuf,
    taken: u64,
}

impl StopWord {
    /// Creates the stop word in the folder of a domain, or takes over that of an arm whose process
    /// has died, whose last stop is done.
    ///
    /// # Errors
    /// [`StopWordError::File`] when the system refuses, or the name belongs to something else.
    pub fn create(domain_folder: &Path) -> Result<Self, StopWordError> {
        let path = domain_folder.join(STOP_WORD_FILE);
        let file = create(&path)?;
        let failed = |error| StopWordError::new(&path, error);
        let taken = word_file::read(&file)
            .map_err(failed)?
            .map_or(0, |record| record.pressed);
        for word in [Word::Braking, Word::Rest] {
            word_file::write(&file, word, 0).map_err(failed)?;
        }
        word_file::write(&file, Word::Taken, taken).map_err(failed)?;
        Ok(Self { file, path, taken })
    }

    /// Reads the word in a cycle of the loop at `now_ns`, monotonic: `true` if the arm must stop.
    ///
    /// *Cost*: three system calls on memory; no lock, no wait.
    ///
    /// # Errors
    /// When the word cannot be read or made again: the arm must stop, and the sentence is to be
    /// logged.
    pub fn poll(&mut self, now_ns: u64) -> Result<bool, StopWordError> {
        let failed = |error| StopWordError::new(&self.path, error);
        let stat = fstat(&self.file).map_err(failed)?;
        let record = word_file::read(&self.file).map_err(failed)?;
        let Some(record) = record.filter(|_| stat.st_nlink == 1) else {
            let lost = StopWordError::new(&self.path, "somebody has removed it or cut it off");
            self.file = create(&self.path)?;
            let made = word_file::read(&self.file).ok().flatten();
            self.taken = made.map_or(0, |record| record.pressed);
            return Err(lost);
        };
        word_file::write(&self.file, Word::Cycle, now_ns).map_err(failed)?;
        let is_pressed = record.pressed != self.taken;
        self.taken = record.pressed;
        Ok(is_pressed)
    }

    /// Records that the arm brakes since `now_ns`, monotonic, for the word that was read last.
    ///
    /// # Errors
    /// When the system refuses; the arm is stopped nevertheless.
    pub fn record_braking(&self, now_ns: u64) -> Result<(), StopWordError> {
        self.write(Word::Rest, 0)?;
        self.write(Word::Braking, now_ns)?;
        // Last: whoever sees the word taken sees its times.
        self.write(Word::Taken, self.taken)
    }

    /// Records that all joints are at rest since `now_ns`, monotonic.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn record_rest(&self, now_ns: u64) -> Result<(), StopWordError> {
        self.write(Word::Rest, now_ns)
    }

    fn write(&self, word: Word, value: u64) -> Result<(), StopWordError> {
        let written = word_file::write(&self.file, word, value);
        written.map_err(|error| StopWordError::new(&self.path, error))
    }
}

impl Drop for StopWord {
    /// Removes the file: an arm that has ended in order cannot be stopped any more.
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Opens or creates the file; nothing but a regular file of this user with one name will do.
fn create(path: &Path) -> Result<File, StopWordError> {
    let failed = |error| StopWordError::new(path, error);
    let flags =
        OFlags::RDWR | OFlags::CREATE | OFlags::NOFOLLOW | OFlags::CLOEXEC | OFlags::NONBLOCK;
    let descriptor = rustix::fs::open(path, flags, Mode::RUSR | Mode::WUSR).map_err(failed)?;
    let stat: Stat = fstat(&descriptor).map_err(failed)?;
    let is_regular = FileType::from_raw_mode(stat.st_mode) == FileType::RegularFile;
    let is_ours = stat.st_uid == rustix::process::geteuid().as_raw();
    if !is_regular || !is_ours || stat.st_nlink > 1 {
        let cause = "it is no file of this user alone; remove it, and start the arm again";
        return Err(StopWordError::new(path, cause));
    }
    ftruncate(&descriptor, N_BYTES).map_err(failed)?;
    Ok(File::from(descriptor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopButton;
    use std::time::Duration;

    #[test]
    fn each_press_stops_once() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(
            StopButton::open(folder.path()),
            Err(StopWordError::Absent(_))
        ));
        let mut word = StopWord::create(folder.path()).unwrap();
        assert!(!word.poll(1).unwrap());
        let button = StopButton::open(folder.path()).unwrap();
        for _ in 0..3 {
            let pressed = button.press().unwrap();
            assert_eq!(
                button.wait_until_taken(pressed, Duration::ZERO).unwrap(),
                None
            );
            assert!(word.poll(2).unwrap());
            word.record_braking(3).unwrap();
            assert!(!word.poll(4).unwrap());
            word.record_rest(5).unwrap();
            let taken = button.wait_until_taken(pressed, Duration::ZERO);
            let taken = taken.unwrap().unwrap();
            assert_eq!((taken.pressed, taken.taken), (pressed, pressed));
            let times = (taken.braking_ns, taken.rest_ns, taken.cycle_ns);
            assert_eq!(times, (3, 5, 4));
        }
    }

    #[test]
    fn word_of_an_arm_that_has_died_is_no_stop_of_the_next() {
        let folder = tempfile::tempdir().unwrap();
        let word = StopWord::create(folder.path()).unwrap();
        let button = StopButton::open(folder.path()).unwrap();
        button.press().unwrap();
        std::mem::forget(word);
        let mut next = StopWord::create(folder.path()).unwrap();
        assert!(!next.poll(1).unwrap());
        // The button of the first arm stops the next one.
        button.press().unwrap();
        assert!(next.poll(2).unwrap());
        drop(next);
        assert!(
            StopButton::open(folder.path()).is_err(),
            "it ended in order"
        );
    }

    #[test]
    fn word_that_was_removed_or_cut_off_stops_the_arm_and_is_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(STOP_WORD_FILE);
        let mut word = StopWord::create(folder.path()).unwrap();
        std::fs::remove_file(&path).unwrap();
        let sentence = word.poll(1).unwrap_err().to_string();
        assert!(sentence.contains("removed"), "{sentence}");
        assert!(!word.poll(2).unwrap());
        std::fs::write(&path, "short").unwrap();
        assert!(word.poll(3).is_err());
        assert!(!word.poll(4).unwrap());
        StopButton::open(folder.path()).unwrap().press().unwrap();
        assert!(word.poll(5).unwrap());
    }

    #[test]
    fn word_is_a_file_of_this_user_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(STOP_WORD_FILE);
        std::os::unix::fs::symlink("/dev/null", &path).unwrap();
        assert!(StopWord::create(folder.path()).is_err());
        std::fs::remove_file(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        assert!(StopWord::create(folder.path()).is_err());
        std::fs::remove_dir(&path).unwrap();
        std::fs::write(folder.path().join("other"), "").unwrap();
        std::fs::hard_link(folder.path().join("other"), &path).unwrap();
        let sentence = StopWord::create(folder.path()).unwrap_err().to_string();
        assert!(sentence.contains("this user alone"), "{sentence}");
    }
}
