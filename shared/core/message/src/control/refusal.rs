//! Why a command was not carried out.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The kind of a refusal, for scripts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RefusalKind {
    /// There is no such track or category.
    NotFound,
    /// The command's words are wrong: a label with control characters, for example.
    Invalid,
    /// The command contradicts what is known: the track carries another label.
    Conflict,
    /// The process that would answer is not there or not ready; try again.
    Unavailable,
    /// The command is of another protocol version.
    Version,
    /// Something failed inside.
    Internal,
}

/// A refusal: its kind, and a sentence for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refusal {
    /// The kind.
    pub kind: RefusalKind,
    /// What happened, to what, and what to do next.
    pub sentence: String,
}

impl Refusal {
    /// A refusal with its sentence.
    pub fn new(kind: RefusalKind, sentence: impl Into<String>) -> Self {
        Self {
            kind,
            sentence: sentence.into(),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

impl std::error::Error for Refusal {}
