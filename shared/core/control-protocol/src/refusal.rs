//! Refusals of control commands.

use serde::{Deserialize, Serialize};

/// Kind of a refusal, for scripts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RefusalKind {
    /// Unknown track or category.
    NotFound,
    /// Invalid argument, such as a label with control characters.
    Invalid,
    /// Refusal by conflict with existing data, such as another label of the track.
    Conflict,
    /// Responsible process absent or not ready; a retry may succeed.
    Unavailable,
    /// Responsible process that has not answered in time; nothing was changed.
    TimedOut,
    /// Command that the role of the user does not allow.
    Forbidden,
    /// Incompatible protocol version.
    Version,
    /// Internal failure.
    Internal,
    /// Failure of a change after which it may be on disk or not. The same mutation id is to be
    /// sent again until its outcome is known.
    UnknownOutcome,
}

/// Refusal of a command: kind for scripts, sentence for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{sentence}")]
pub struct Refusal {
    /// Kind of the refusal, for scripts.
    pub kind: RefusalKind,
    /// Sentence for people: cause, subject and next step.
    pub sentence: String,
}

impl Refusal {
    /// Creates a refusal with its sentence.
    pub fn new(kind: RefusalKind, sentence: impl Into<String>) -> Self {
        Self {
            kind,
            sentence: sentence.into(),
        }
    }
}
