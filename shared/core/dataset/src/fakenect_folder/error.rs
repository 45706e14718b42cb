//! Errors of reading and writing fakenect recordings.

use file_access::FileError;
use std::path::PathBuf;

/// Error of reading or writing a fakenect recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Invalid line of `INDEX.txt`.
    #[error("line {line} of the fakenect recording's INDEX.txt is wrong: {problem}")]
    IndexLine {
        /// Line number in `INDEX.txt`, from 1.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Index without a depth frame.
    #[error("the fakenect recording's INDEX.txt lists no depth frame; record it again")]
    NoDepth,
    /// Frame file with a wrong header.
    #[error(
        "the frame {} does not begin with \"{needed}\"; record it again",
        .path.display()
    )]
    FrameHeader {
        /// Path of the frame file.
        path: PathBuf,
        /// Header that the frame file must begin with.
        needed: &'static str,
    },
    /// Frame file with a wrong size.
    #[error(
        "the frame {} has {found} bytes and must have {needed}; copy the recording again",
        .path.display()
    )]
    FrameSize {
        /// Path of the frame file.
        path: PathBuf,
        /// Actual size of the frame file, bytes.
        found: u64,
        /// Required size of the frame file, bytes.
        needed: u64,
    },
    /// Frame to be written with a wrong number of values.
    #[error("a frame of {found} values cannot be recorded; it must have {needed}")]
    FrameLength {
        /// Number of values in the frame given by the caller.
        found: usize,
        /// Number of values that a frame must have.
        needed: usize,
    },
    /// Depth value to be written that exceeds 11 bits.
    #[error("the depth value {0} cannot be recorded; raw depth goes from 0 to 2047")]
    RawDepth(u16),
    /// Frame to be written more than a minute after its predecessor.
    #[error(
        "the frame comes more than a minute after the one before and cannot be \
         recorded; begin another recording"
    )]
    TimeGap,
}
