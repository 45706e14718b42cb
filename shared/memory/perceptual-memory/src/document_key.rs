//! Keys of documents: kind and name.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// Kind of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum DocumentKind {
    /// Fused surface of an object, keyed by the name of the object.
    ObjectModel,
    /// Knowledge for a task, keyed by its subject.
    TaskKnowledge,
}

impl DocumentKind {
    /// All kinds of documents.
    pub const ALL: [Self; 2] = [Self::ObjectModel, Self::TaskKnowledge];

    /// Byte code of the document kind in database keys.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::ObjectModel => 1,
            Self::TaskKnowledge => 2,
        }
    }

    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }

    /// Name of the document kind in messages to users.
    pub fn word(self) -> &'static str {
        match self {
            Self::ObjectModel => "object model",
            Self::TaskKnowledge => "task knowledge",
        }
    }
}

/// Key of a document: kind and name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct DocumentKey {
    /// Kind of the document.
    pub kind: DocumentKind,
    /// Name of the document, 1 to [`MAX_NAME_BYTES`](crate::MAX_NAME_BYTES).
    pub name: Arc<str>,
}

impl fmt::Display for DocumentKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the {} {:?}", self.kind.word(), self.name)
    }
}
