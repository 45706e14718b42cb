//! What can go wrong with a source.

use std::fmt;

/// A frame or a source that can not be used.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum SourceError {
    /// The source can not be used at all.
    Unusable(String),
    /// One frame can not be used; the next one may.
    Frame {
        /// Its name.
        frame: String,
        /// Why not.
        cause: String,
    },
    /// The recording has come to its end.
    Ended,
    /// The device is not there, or has gone away; it may come back.
    Gone(String),
}

impl fmt::Display for SourceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ended => f.write_str("the recording has come to its end"),
            Self::Unusable(sentence) | Self::Gone(sentence) => f.write_str(sentence),
            Self::Frame { frame, cause } => write!(f, "the frame {frame} is left out: {cause}"),
        }
    }
}

impl std::error::Error for SourceError {}
