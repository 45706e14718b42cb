//! What can be wrong with a fakenect folder.

use crate::FileError;
use std::fmt;
use std::path::PathBuf;

/// Why a fakenect folder could not be used or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file or the folder could not be read or written.
    File(FileError),
    /// A line of `INDEX.txt` is wrong.
    IndexLine {
        /// Its number, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The index lists no depth frame.
    NoDepth,
    /// A listed file does not begin as it must.
    FrameHeader {
        /// The file.
        path: PathBuf,
        /// How it must begin.
        needed: &'static str,
    },
    /// A listed file has the wrong size.
    FrameSize {
        /// The file.
        path: PathBuf,
        /// Bytes it has.
        found: u64,
        /// Bytes it must have.
        needed: u64,
    },
    /// A frame for writing has the wrong number of values.
    FrameLength {
        /// The number it has.
        found: usize,
        /// The number it must have.
        needed: usize,
    },
    /// A depth for writing is not an 11-bit value.
    RawDepth(u16),
    /// A frame for writing comes long after the one before.
    TimeGap,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::IndexLine { line, problem } => {
                write!(
                    f,
                    "line {line} of the fakenect recording's INDEX.txt is wrong: {problem}"
                )
            }
            Self::NoDepth => f.write_str(
                "the fakenect recording's INDEX.txt lists no depth frame; record it again",
            ),
            Self::FrameHeader { path, needed } => write!(
                f,
                "the frame {} does not begin with \"{needed}\"; record it again",
                path.display()
            ),
            Self::FrameSize {
                path,
                found,
                needed,
            } => write!(
                f,
                "the frame {} has {found} bytes and must have {needed}; copy the recording again",
                path.display()
            ),
            Self::FrameLength { found, needed } => write!(
                f,
                "a frame of {found} values can not be recorded; it must have {needed}"
            ),
            Self::RawDepth(value) => write!(
                f,
                "the depth value {value} can not be recorded; raw depth goes from 0 to 2047"
            ),
            Self::TimeGap => f.write_str(
                "the frame comes more than a minute after the one before and can not be \
                 recorded; begin another recording",
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            _ => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}
