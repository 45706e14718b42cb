//! Errors of camera sources.

/// Error of a camera source: unusable frame or source.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// Camera source that cannot be used at all.
    #[error("{0}")]
    Unusable(String),
    /// One frame cannot be used; the next one may.
    #[error("the frame {frame} is left out: {cause}")]
    Frame {
        /// Name of the unusable frame.
        frame: String,
        /// Reason why the frame cannot be used.
        cause: String,
    },
    /// Recording has ended.
    #[error("the recording has ended")]
    EndOfRecording,
    /// Camera device that is not connected; it may come back.
    #[error("{0}")]
    Disconnected(String),
}
