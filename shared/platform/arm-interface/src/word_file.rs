//! File of the stop word: its layout, and reading and writing of its words.

use rustix::io::Errno;
use rustix::time::{ClockId, clock_gettime};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Name of the file with the stop word, in the folder of a domain.
pub const STOP_WORD_FILE: &str = "arm-stop";

/// Number of the words of 64 bits in the file, in the byte order of the machine.
const N_WORDS: usize = 5;

/// Place of a word in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Word {
    /// The stop word: whoever writes another value stops the arm.
    Pressed = 0,
    /// Stop word on which the arm's loop has acted last.
    Taken = 1,
    /// Time at which braking began for that word, nanoseconds.
    Braking = 2,
    /// Time at which all joints were at rest after that, nanoseconds; 0 before.
    Rest = 3,
    /// Time of the loop's last cycle, nanoseconds.
    Cycle = 4,
}

/// Content of the file. Times are those of the monotonic clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StopRecord {
    /// The stop word: by agreement the time at which it was pressed, nanoseconds.
    pub pressed: u64,
    /// Stop word on which the arm's loop has acted last.
    pub taken: u64,
    /// Time at which braking began for the taken word, nanoseconds; 0 before the first stop.
    pub braking_ns: u64,
    /// Time at which all joints were below 0.01 rad/s after that, nanoseconds; 0 until then.
    pub rest_ns: u64,
    /// Time of the last cycle of the arm's loop, nanoseconds.
    pub cycle_ns: u64,
}

/// Error of the stop word.
#[derive(Debug, thiserror::Error)]
pub enum StopWordError {
    /// No arm has made the file.
    #[error("there is no arm to stop: {} does not exist", .0.display())]
    Absent(PathBuf),
    /// The file is not usable.
    #[error("the stop word of the arm, {}, could not be used: {cause}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Reason of the system, or what the file is.
        cause: String,
    },
}

impl StopWordError {
    pub(crate) fn new(path: &Path, cause: impl std::fmt::Display) -> Self {
        Self::File {
            path: path.to_owned(),
            cause: cause.to_string(),
        }
    }
}

/// Present time of the monotonic clock, nanoseconds: that of C's `CLOCK_MONOTONIC` and of Python's
/// `time.monotonic_ns`.
pub fn monotonic_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec.cast_unsigned() * 1_000_000_000 + now.tv_nsec.cast_unsigned()
}

/// Reads the whole file; `None` when somebody has cut it off.
pub(crate) fn read(file: &File) -> Result<Option<StopRecord>, Errno> {
    let mut bytes = [[0; 8]; N_WORDS];
    let n_read = rustix::io::pread(file, bytes.as_flattened_mut(), 0)?;
    let [pressed, taken, braking_ns, rest_ns, cycle_ns] = bytes.map(u64::from_ne_bytes);
    Ok((n_read == 8 * N_WORDS).then_some(StopRecord {
        pressed,
        taken,
        braking_ns,
        rest_ns,
        cycle_ns,
    }))
}

/// Writes one word.
pub(crate) fn write(file: &File, word: Word, value: u64) -> Result<(), Errno> {
    rustix::io::pwrite(file, &value.to_ne_bytes(), 8 * word as u64).map(drop)
}
