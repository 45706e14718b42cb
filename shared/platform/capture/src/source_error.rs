//! Errors of camera sources.

/// Unusable frame or source.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The source cannot be used at all.
    #[error("{0}")]
    Unusable(String),
    /// One frame cannot be used; the next one may.
    #[error("the frame {frame} is left out: {cause}")]
    Frame {
        /// Name of the frame.
        frame: String,
        /// Reason.
        cause: String,
    },
    /// End of the recording.
    #[error("the recording has come to its end")]
    EndOfRecording,
    /// The device is not connected; it may come back.
    #[error("{0}")]
    Disconnected(String),
}
