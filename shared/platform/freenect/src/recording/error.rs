//! Errors of a recorded folder.

use std::{io, path::PathBuf};

/// Error of a folder that fakenect cannot play.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// Recording folder that does not exist.
    #[error(
        "the recording cannot be played: there is no folder {}; give the folder of a recording",
        .folder.display()
    )]
    NoFolder {
        /// Path of the recording's folder.
        folder: PathBuf,
    },
    /// File of the recording that cannot be read.
    #[error(
        "the recording cannot be played: {} cannot be read ({source}); copy the recording again, \
         or take its name out of INDEX.txt",
        .file.display()
    )]
    Unreadable {
        /// Path of the unreadable file.
        file: PathBuf,
        /// Cause reported by the operating system.
        source: io::Error,
    },
    /// Index line that names no playable file.
    #[error(
        "the recording cannot be played: line {line_number} of {}: {rule}; correct the line",
        .index.display()
    )]
    WrongLine {
        /// Path of the index file.
        index: PathBuf,
        /// Line number in the index, from one.
        line_number: usize,
        /// Rule that the index line violates.
        rule: &'static str,
    },
    /// File whose contents do not match its name.
    #[error(
        "the recording cannot be played: {} is damaged or cut short: {rule}; take its name out of \
         INDEX.txt",
        .file.display()
    )]
    WrongFile {
        /// Path of the damaged file.
        file: PathBuf,
        /// Rule that the damaged file violates.
        rule: &'static str,
    },
}
