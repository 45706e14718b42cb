//! Errors of writing and reading recordings.

use message::InvalidFrame;

/// Error of writing or reading a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Medium that cannot be read or written.
    #[error("the recording could not be read or written: {0}")]
    Io(#[from] std::io::Error),
    /// File that does not begin as an MCAP file.
    #[error("the file is no recording: it does not begin as an MCAP file")]
    NotMcap,
    /// Recording that the MCAP library refuses to write.
    #[error("the recording could not be written: {0}")]
    Mcap(mcap::McapError),
    /// Document that cannot be written as JSON.
    #[error("a message could not be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl From<mcap::McapError> for Error {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(error) => Self::Io(error),
            mcap::McapError::BadMagic => Self::NotMcap,
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
