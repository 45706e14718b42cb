//! What can be wrong with a PCD file.

use super::{MAX_BYTES, MAX_POINTS};
use crate::{FileError, lzf};
use std::fmt;

/// Why a PCD file could not be read or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read.
    File(FileError),
    /// The text at the start has no line "DATA …".
    NoData,
    /// A line that must be in the header is not there.
    MissingLine(&'static str),
    /// A line of the header is wrong.
    HeaderLine {
        /// Its number, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The fields do not make a point.
    Fields(&'static str),
    /// The header announces more than is ever read.
    TooLarge,
    /// The header announces more than the file holds.
    Truncated {
        /// Bytes of data needed at least.
        needed: usize,
        /// Bytes of data present.
        present: usize,
    },
    /// The sizes before compressed data contradict the header.
    CompressedSize {
        /// The size that is announced for the expanded data.
        announced: usize,
        /// The size that follows from the header.
        needed: usize,
    },
    /// The compressed data is damaged.
    Compression(lzf::Error),
    /// A line of points in text is wrong.
    PointLine {
        /// Its number within the data, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// A label is not a whole number from 0 to 2^32 - 1.
    Label {
        /// Which point, from 0.
        point_idx: usize,
        /// The number found.
        value: f64,
    },
    /// The number of points, labels, columns and rows do not agree.
    SizeMismatch {
        /// Which of the caller's slices is wrong.
        what: &'static str,
        /// The length it has.
        given: usize,
        /// The length it must have.
        needed: usize,
    },
    /// Labels were asked for, and the file has none.
    NoLabels,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NoData => f.write_str(
                "this is not a PCD file: no line \"DATA …\" within the first 64 KiB; name another file",
            ),
            Self::MissingLine(key) => {
                write!(f, "the PCD header has no line \"{key} …\"; write the file as version 0.7")
            }
            Self::HeaderLine { line, problem } => {
                write!(f, "line {line} of the PCD header is wrong: {problem}")
            }
            Self::Fields(problem) => write!(f, "the fields of the PCD file are wrong: {problem}"),
            Self::TooLarge => write!(
                f,
                "the PCD file announces more than {MAX_POINTS} points or {MAX_BYTES} bytes; \
                 make the cloud smaller"
            ),
            Self::Truncated { needed, present } => write!(
                f,
                "the PCD file is cut off: its header needs at least {needed} bytes of data, \
                 and {present} are there; copy the file again"
            ),
            Self::CompressedSize { announced, needed } => write!(
                f,
                "the compressed PCD data announces {announced} bytes where the header needs \
                 {needed}; the file is damaged"
            ),
            Self::Compression(error) => write!(f, "the PCD file can not be expanded: {error}"),
            Self::PointLine { line, problem } => {
                write!(f, "line {line} of the PCD file's points is wrong: {problem}")
            }
            Self::Label { point_idx, value } => write!(
                f,
                "the label of point {point_idx} in the PCD file is {value}; labels are whole \
                 numbers from 0 to 4294967295"
            ),
            Self::SizeMismatch { what, given, needed } => write!(
                f,
                "the PCD file's size needs {needed} {what}, and {given} were given; pass as many"
            ),
            Self::NoLabels => {
                f.write_str("the PCD file has no labels; ask for its points only")
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            Self::Compression(error) => Some(error),
            _ => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}
