//! What a robot knows besides views: object models and task knowledge.
//!
//! A document has a name and content. Replacing it keeps the version before, so
//! that the change can be undone, until it is purged.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::digest::Digest;
use crate::error::Refusal;
use crate::standing::Decided;
use crate::view::MAX_NAME_BYTES;

/// Largest document, bytes.
pub const MAX_DOCUMENT_BYTES: usize = 16 << 20;

/// What a document is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum DocumentKind {
    /// The fused surface of an object, by the object's name.
    ObjectModel,
    /// Something a task needs to know, by the name of that.
    TaskKnowledge,
}

impl DocumentKind {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::ObjectModel, Self::TaskKnowledge];

    /// In the keys of the database.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::ObjectModel => 1,
            Self::TaskKnowledge => 2,
        }
    }

    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }

    /// As people write it.
    pub fn word(self) -> &'static str {
        match self {
            Self::ObjectModel => "object model",
            Self::TaskKnowledge => "task knowledge",
        }
    }
}

/// Which document.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct DocumentKey {
    /// What it is about.
    pub kind: DocumentKind,
    /// Its name, 1 to [`MAX_NAME_BYTES`].
    pub name: Arc<str>,
}

impl fmt::Display for DocumentKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the {} {:?}", self.kind.word(), self.name)
    }
}

/// A document to be stored, or as it was stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Document {
    /// Which one.
    pub key: DocumentKey,
    /// How to read the content, such as `text/plain`; at most [`MAX_NAME_BYTES`].
    pub media_type: String,
    /// At most [`MAX_DOCUMENT_BYTES`].
    pub content: Vec<u8>,
}

impl Document {
    /// What is kept of its content in the index.
    pub(crate) fn summary(&self) -> DocumentContent {
        DocumentContent {
            digest: Digest::of(&self.content),
            n_bytes: self.content.len() as u32,
            media_type: self.media_type.clone(),
        }
    }

    /// Refuses what could not be found or read again.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        self.key.check()?;
        let refused = |reason| {
            Err(Refusal::InvalidDocument {
                document: self.key.clone(),
                reason,
            })
        };
        if self.media_type.len() > MAX_NAME_BYTES {
            return refused("its media type is too long");
        }
        if self.content.len() > MAX_DOCUMENT_BYTES {
            return refused("its content is too large");
        }
        Ok(())
    }
}

impl DocumentKey {
    /// Refuses a name that could not be found again.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let n_bytes = self.name.len();
        let reason = if n_bytes == 0 {
            "its name is empty"
        } else if n_bytes > MAX_NAME_BYTES {
            "its name is too long"
        } else if self.name.chars().any(char::is_control) {
            "its name has a control character"
        } else {
            return Ok(());
        };
        Err(Refusal::InvalidDocument {
            document: self.clone(),
            reason,
        })
    }
}

/// The content of one version.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DocumentContent {
    /// Of its bytes.
    pub digest: Digest,
    /// How many there are.
    pub n_bytes: u32,
    /// How to read them.
    pub media_type: String,
}

/// One version of a document, as it is stored; its key has the sequence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DocumentVersion {
    /// None: removed.
    pub(crate) content: Option<DocumentContent>,
    pub(crate) decided: Decided,
}

/// A document that is there, without its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DocumentSummary {
    /// Which one.
    pub key: DocumentKey,
    /// Of its present version.
    pub content: DocumentContent,
    /// Who put it there, and when.
    pub decided: Decided,
    /// Sequence of the history entry that did.
    pub sequence: u64,
}
