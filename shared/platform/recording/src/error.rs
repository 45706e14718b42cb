//! Errors of writing and reading recordings.

use message::InvalidFrame;

/// Error of writing or reading a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Medium that cannot be read.
    #[error("the recording could not be read: {0}; check the disk, or copy the file to another")]
    Read(std::io::Error),
    /// Medium that cannot be written.
    #[error("the recording could not be written: {0}; free disk space, or write to another disk")]
    Write(std::io::Error),
    /// File that does not begin as an MCAP file.
    #[error(
        "the file is no recording: it does not begin as an MCAP file; name one of `tabula record`"
    )]
    NotMcap,
    /// Message behind the end of a recording.
    #[error("the recording is finished and takes no more messages; begin a new one")]
    Finished,
    /// Recording of a newer version of the format.
    #[error("the recording has format {found}, this program reads up to {known}; update tabula")]
    Version {
        /// Version in the file.
        found: u32,
        /// Newest version that this program reads.
        known: u32,
    },
    /// Recording that the MCAP library refuses to write.
    #[error("the recording could not be written: {0}; begin a new one")]
    Mcap(mcap::McapError),
    /// Document that cannot be written as JSON.
    #[error("a message could not be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// Conversion of errors of writing; what is read is judged without the library's errors.
impl From<mcap::McapError> for Error {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(error) => Self::Write(error),
            other => Self::Mcap(other),
        }
    }
}

/// Error of a recorded message that cannot be used; the next one may.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidRecord {
    /// Message that ends within a field.
    #[error("it ends within its {0}")]
    Cut(&'static str),
    /// Encoding of another version of the format.
    #[error("its encoding has version {found}, this program reads version {known}")]
    Version {
        /// Version in the message.
        found: u32,
        /// Version that this program reads.
        known: u32,
    },
    /// Message that is longer than any state of arm or people.
    #[error("it has {0} bytes, more than any state")]
    StateLength(usize),
    /// Message that is no state of arm or people; the text is the reason.
    #[error("it is no state: {0}")]
    State(String),
    /// State with more capsules than a message has.
    #[error("it has {0} capsules, more than any state")]
    Capsules(usize),
    /// Bits that this version of the format does not define.
    #[error("it has planes that this program does not know (bits {0:#x})")]
    Planes(u32),
    /// Depth table with more words than any frame needs.
    #[error("its depth table has {0} words, more than any frame needs")]
    TableLength(usize),
    /// Text that is not UTF-8, or too long.
    #[error("its source name is no text of at most 128 bytes")]
    Name,
    /// Impossible header of a frame.
    #[error("{0}")]
    Frame(#[from] InvalidFrame),
    /// Number of bytes that does not hold the frame's points.
    #[error("it has {found} bytes of points instead of {needed}")]
    PointBytes {
        /// Number of bytes behind the header.
        found: usize,
        /// Number of bytes by the header.
        needed: usize,
    },
    /// Buffer for the points of another length than the frame.
    #[error("the buffer has {found} points instead of {needed}")]
    BufferLength {
        /// Number of points of the buffer.
        found: usize,
        /// Number of points of the frame.
        needed: usize,
    },
}
