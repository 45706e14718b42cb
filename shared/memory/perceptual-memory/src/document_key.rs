//! Keys of documents: kind and name.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

coded_enum::coded_enum! {
    /// Kind of a document.
    #[derive(PartialOrd, Ord, Hash, Serialize, Deserialize)]
    #[non_exhaustive]
    pub enum DocumentKind: u8 {
        /// Fused surface of an object, keyed by the name of the object.
        ObjectModel = 1, "object model";
        /// Knowledge for a task, keyed by its subject.
        TaskKnowledge = 2, "task knowledge";
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
