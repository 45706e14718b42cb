//! Errors of camera sources.

/// Error of a camera source: unusable frame or source.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// Camera source that cannot be used at all: final until the first frame, and tried again
    /// after it.
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
    /// Device, folder or shared memory that cannot be used at present; it is tried again.
    #[error("{0}")]
    Unavailable(String),
}

impl From<channel::Error> for SourceError {
    /// A failure of shared memory, which another process may have caused, and which may pass.
    fn from(error: channel::Error) -> Self {
        Self::Unavailable(error.to_string())
    }
}
