//! Why a recorded folder is not handed to fakenect.

use std::{fmt, io, path::PathBuf};

/// Why a folder can not be played.
#[derive(Debug)]
#[non_exhaustive]
pub enum RecordingError {
    /// There is no such folder.
    NoFolder {
        /// The folder.
        folder: PathBuf,
    },
    /// A file can not be read.
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A line of the index names no file fakenect can play.
    WrongLine {
        /// The index.
        index: PathBuf,
        /// Counted from one.
        line_number: usize,
        /// What is wrong with it.
        rule: &'static str,
    },
    /// A file holds something else than its name says.
    WrongFile {
        /// The file.
        file: PathBuf,
        /// What it should hold.
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
