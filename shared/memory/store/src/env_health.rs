//! What the durable environment has seen go wrong, shared with the engine above it.
//!
//! rusty-leveldb swallows errors where it must not: a compaction that cannot
//! write its output, or cannot read a block of its input, deletes the input all
//! the same. So the environment remembers the first failed write and every
//! damaged read, and refuses all further changes to the folder: the files stay
//! as they are until somebody has looked.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Damages remembered in words; further ones are only counted.
const MAX_DAMAGES_TOLD: usize = 32;

/// A failed change to the folder.
#[derive(Debug, Clone)]
pub(crate) struct Failure {
    /// What was being done.
    pub(crate) doing: &'static str,
    /// To which file.
    pub(crate) path: PathBuf,
    /// What the system said.
    pub(crate) source: Arc<io::Error>,
}

/// The shared state; all methods may be called from any thread.
#[derive(Default)]
pub(crate) struct EnvHealth {
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    failure: Option<Failure>,
    damages: Vec<String>,
    n_damages: u64,
    /// Deletions put off while the database is being examined; `None` afterwards.
    held_deletions: Option<Vec<PathBuf>>,
    #[cfg(test)]
    observer: Option<Observer>,
}

/// Sees every change before it is made, and may refuse it.
#[cfg(test)]
pub(crate) type Observer = Box<dyn FnMut(&Change<'_>) -> io::Result<()> + Send>;

/// A change to the folder, as an observer sees it.
#[derive(Debug)]
#[expect(
    dead_code,
    reason = "only the observers of tests read it, and not every field"
)]
pub(crate) enum Change<'a> {
    Create(&'a Path),
    Write(&'a Path, &'a [u8]),
    Sync(&'a Path),
    Rename(&'a Path, &'a Path),
    Delete(&'a Path),
    SyncFolder(&'a Path),
}

impl EnvHealth {
    /// A health that holds deletions back until [`Self::release_deletions`].
    pub(crate) fn examining() -> Self {
        let state = State {
            held_deletions: Some(Vec::new()),
            ..State::default()
        };
        Self {
            state: Mutex::new(state),
        }
    }

    /// The state stays usable after a panic elsewhere: it is only ever appended to.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes one change to the folder, unless an earlier one failed or, outside
    /// of an examination, damage was seen. Remembers a failure.
    pub(crate) fn change<T>(
        &self,
        doing: &'static str,
        path: &Path,
        change: &Change<'_>,
        make: impl FnOnce() -> io::Result<T>,
    ) -> io::Result<T> {
        self.refuse_if_frozen()?;
        let made = self.observe(change).and_then(|()| make());
        if let Err(error) = &made {
            self.note_failure(doing, path, error);
        }
        made
    }

    fn refuse_if_frozen(&self) -> io::Result<()> {
        let state = self.lock();
        if let Some(failure) = &state.failure {
            return Err(io::Error::new(
                failure.source.kind(),
                "an earlier write failed",
            ));
        }
        if state.n_damages > 0 && state.held_deletions.is_none() {
            return Err(io::Error::other("damage was found, so nothing may change"));
        }
        Ok(())
    }

    /// Remembers that a file could not be read: as damage when the bytes are lost,
    /// as a failure when only the system is short of something.
    pub(crate) fn note_read_error(&self, path: &Path, error: &io::Error) {
        /// What Linux says of bytes that the medium or the file system has lost.
        const EIO: i32 = 5;
        const EBADMSG: i32 = 74;
        const EUCLEAN: i32 = 117;
        let is_lost = matches!(
            error.kind(),
            io::ErrorKind::NotFound
                | io::ErrorKind::UnexpectedEof
                | io::ErrorKind::InvalidData
                // Of a name that none of our files has, read from a damaged one.
                | io::ErrorKind::InvalidInput
                | io::ErrorKind::InvalidFilename
                | io::ErrorKind::IsADirectory
                | io::ErrorKind::NotADirectory
        ) || matches!(error.raw_os_error(), Some(EIO | EBADMSG | EUCLEAN));
        if is_lost {
            self.note_damage(format!("{}: {error}", path.display()));
        } else {
            self.note_failure("reading", path, error);
        }
    }

    fn note_failure(&self, doing: &'static str, path: &Path, error: &io::Error) {
        let copy = io::Error::new(error.kind(), error.to_string());
        let failure = Failure {
            doing,
            path: path.to_owned(),
            source: Arc::new(copy),
        };
        self.lock().failure.get_or_insert(failure);
    }

    /// Remembers that something read is not what was written.
    pub(crate) fn note_damage(&self, what: String) {
        let mut state = self.lock();
        state.n_damages += 1;
        if state.damages.len() < MAX_DAMAGES_TOLD {
            state.damages.push(what);
        }
    }

    /// Puts the deletion off and returns true while the database is examined.
    pub(crate) fn holds_deletion(&self, path: &Path) -> bool {
        match &mut self.lock().held_deletions {
            Some(held) => {
                held.push(path.to_owned());
                true
            }
            None => false,
        }
    }

    /// A file whose deletion was put off is written anew: it is another one now.
    /// Numbers of tables that a crash has orphaned are given again.
    pub(crate) fn keep_created(&self, path: &Path) {
        if let Some(held) = &mut self.lock().held_deletions {
            held.retain(|deleted| deleted != path);
        }
    }

    /// Whether damage does not stop reading and deletions are put off.
    pub(crate) fn is_examining(&self) -> bool {
        self.lock().held_deletions.is_some()
    }

    /// Ends the examination; the caller deletes what was put off.
    pub(crate) fn release_deletions(&self) -> Vec<PathBuf> {
        self.lock().held_deletions.take().unwrap_or_default()
    }

    /// The first failed change.
    pub(crate) fn failure(&self) -> Option<Failure> {
        self.lock().failure.clone()
    }

    /// Number of damages seen, and the first ones in words.
    pub(crate) fn damages(&self) -> (u64, Vec<String>) {
        let state = self.lock();
        (state.n_damages, state.damages.clone())
    }

    /// Number of damages seen.
    pub(crate) fn n_damages(&self) -> u64 {
        self.lock().n_damages
    }

    #[cfg(not(test))]
    #[expect(
        clippy::unused_self,
        clippy::unnecessary_wraps,
        reason = "the tests' one observes"
    )]
    fn observe(&self, _change: &Change<'_>) -> io::Result<()> {
        Ok(())
    }

    #[cfg(test)]
    fn observe(&self, change: &Change<'_>) -> io::Result<()> {
        self.lock()
            .observer
            .as_mut()
            .map_or(Ok(()), |observer| observer(change))
    }

    /// Lets a test see, and refuse, every change.
    #[cfg(test)]
    pub(crate) fn set_observer(&self, observer: Observer) {
        self.lock().observer = Some(observer);
    }
}
