//! Error of a recorded folder.

use std::{fmt, io, path::PathBuf};

/// Error of a folder that fakenect cannot play.
#[derive(Debug)]
#[non_exhaustive]
pub enum RecordingError {
    /// The folder does not exist.
    NoFolder {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// A file cannot be read.
    Unreadable {
        /// Path of the file.
        file: PathBuf,
        /// Cause reported by the operating system.
        source: io::Error,
    },
    /// A line of the index names no playable file.
    WrongLine {
        /// Path of the index.
        index: PathBuf,
        /// Line number, from one.
        line_number: usize,
        /// Violated rule.
        rule: &'static str,
    },
    /// The contents of a file do not match its name.
    WrongFile {
        /// Path of the file.
        file: PathBuf,
        /// Violated rule.
        rule: &'static str,
    },
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the recording can not be played: ")?;
        match self {
            Self::NoFolder { folder } => {
                write!(
                    f,
                    "there is no folder {}; give the folder of a recording",
                    folder.display()
                )
            }
            Self::Unreadable { file, source } => write!(
                f,
                "{} can not be read ({source}); copy the recording again, or take its name out \
                 of INDEX.txt",
                file.display()
            ),
            Self::WrongLine {
                index,
                line_number,
                rule,
            } => {
                write!(
                    f,
                    "line {line_number} of {}: {rule}; correct the line",
                    index.display()
                )
            }
            Self::WrongFile { file, rule } => write!(
                f,
                "{} is damaged or cut short: {rule}; take its name out of INDEX.txt",
                file.display()
            ),
        }
    }
}

impl std::error::Error for RecordingError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Unreadable { source, .. } => Some(source),
            _ => None,
        }
    }
}
