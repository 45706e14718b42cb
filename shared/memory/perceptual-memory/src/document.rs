//! Versioned documents: object models and task knowledge.
//!
//! A document has a key and content. Replacing it keeps the earlier version for undo, until that is
//! purged: after a time, or when there are too many later ones.

use serde::{Deserialize, Serialize};

use crate::digest::Digest;
use crate::document_key::DocumentKey;
use crate::error::StoreRefusal;
use crate::label_status::DecisionStamp;
use crate::view::MAX_NAME_BYTES;

/// Maximum size of a document, bytes.
pub const MAX_DOCUMENT_BYTES: usize = 16 << 20;

/// Maximum number of versions of a document: a further one purges the oldest. Chosen: a program
/// that stores a document every second must not fill the memory with what it replaces.
pub const MAX_DOCUMENT_VERSIONS: usize = 100;

/// Document with its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryDocument {
    /// Key of the document.
    pub key: DocumentKey,
    /// Media type, such as `text/plain`; at most [`MAX_NAME_BYTES`].
    pub media_type: String,
    /// Content of the document, at most [`MAX_DOCUMENT_BYTES`].
    pub content: Vec<u8>,
}

impl MemoryDocument {
    /// Content reference for the index.
    pub(crate) fn summary(&self) -> DocumentContent {
        DocumentContent {
            digest: Digest::of(&self.content),
            n_bytes: self.content.len() as u32,
            media_type: self.media_type.clone(),
        }
    }

    /// Validates key, media type and size.
    pub(crate) fn check(&self) -> Result<(), StoreRefusal> {
        self.key.check()?;
        let refused = |reason| {
            Err(StoreRefusal::InvalidDocument {
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
    /// Validates the length of the document's name.
    pub(crate) fn check(&self) -> Result<(), StoreRefusal> {
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
        Err(StoreRefusal::InvalidDocument {
            document: self.clone(),
            reason,
        })
    }
}

/// Content reference of a document version.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DocumentContent {
    /// Digest of the document's content.
    pub digest: Digest,
    /// Size of the document's content, bytes.
    pub n_bytes: u32,
    /// Media type (MIME) of the content.
    pub media_type: String,
}

/// Stored version of a document; the key of its record contains the sequence number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DocumentVersion {
    /// Reference to the version's content; `None` if the document was removed.
    pub(crate) content: Option<DocumentContent>,
    pub(crate) decided: DecisionStamp,
}

/// Present document without its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DocumentSummary {
    /// Key of the document.
    pub key: DocumentKey,
    /// Content reference of the document's present version.
    pub content: DocumentContent,
    /// Author and time of the document's last change.
    pub decided: DecisionStamp,
    /// Sequence number of the history entry of the last change.
    pub sequence: u64,
}

/// Version of a document without its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DocumentRevision {
    /// Sequence number of the history entry that made the version.
    pub sequence: u64,
    /// Content reference of the version; `None` if it records a removal.
    pub content: Option<DocumentContent>,
    /// Author and time of the version.
    pub decided: DecisionStamp,
}
