//! Documents of the perceptual memory, whose content crosses the protocol in pages.

use crate::learning::hex_id;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Maximum size of the content of a document, bytes.
pub const MAX_DOCUMENT_BYTES: u64 = 16 << 20;

/// Maximum number of content bytes in one request or reply; the rest of the message needs room
/// too.
pub const DOCUMENT_PAGE_BYTES: usize = crate::MAX_MESSAGE_BYTES / 2;

/// Kind of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum DocumentKind {
    /// Fused surface model of an object.
    ObjectModel,
    /// Knowledge document for a task.
    TaskKnowledge,
}

/// Name of a document, unique within its kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DocumentName {
    /// Kind of the document.
    pub kind: DocumentKind,
    /// Name of the document within its kind.
    pub name: String,
}

/// Digest of a document's content: the first 128 bits of BLAKE3 (O'Connor, Aumasson, Neves and
/// Wilcox-O'Hearn 2020). Serialised as the first 32 hexadecimal digits of the hash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ContentDigest(#[serde(with = "hex_id")] pub u128);

impl ContentDigest {
    /// Digest of a content.
    pub fn of(content: &[u8]) -> Self {
        let hash = blake3::hash(content);
        let first = hash.as_bytes().first_chunk().copied();
        Self(u128::from_be_bytes(first.unwrap_or_default()))
    }
}

impl fmt::Display for ContentDigest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// Request for one page of a document's content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PageRequest {
    /// Name of the document to read.
    pub document: DocumentName,
    /// Digest of the version that is being read; null for the first page of the present version.
    /// A version that is no longer the present one is refused.
    pub digest: Option<ContentDigest>,
    /// Offset in the content of the first byte to read, up to the size of the content.
    pub offset: u64,
}

/// Page of a document's content, with the metadata of its version.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DocumentPage {
    /// Metadata of the version that the page belongs to.
    pub document: DocumentReport,
    /// Offset in the content of the first byte of the page.
    pub offset: u64,
    /// Bytes of the page, at most [`DOCUMENT_PAGE_BYTES`]; the content ends where they do when
    /// there are fewer.
    #[serde(with = "serde_bytes")]
    pub content: Vec<u8>,
}

/// Metadata of a document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DocumentReport {
    /// Name of the document.
    #[serde(flatten)]
    pub document: DocumentName,
    /// Media type (MIME) of the document.
    pub media_type: String,
    /// Size of the document's content, bytes.
    pub bytes: u64,
    /// Digest of the document's content.
    pub digest: ContentDigest,
    /// Author of the document's present version.
    pub author: String,
    /// Time at which the document was stored, nanoseconds since 1970.
    pub decided_ns: u64,
    /// Sequence number of the history entry that stored the document.
    pub sequence: u64,
}

/// Version of a document that the memory keeps.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DocumentVersionReport {
    /// Sequence number of the history entry that made the version.
    pub sequence: u64,
    /// Time of the version, nanoseconds since 1970.
    pub decided_ns: u64,
    /// Author of the version.
    pub author: String,
    /// Size of the content, bytes; null for a version that records a removal.
    pub bytes: Option<u64>,
    /// Digest of the content; null for a version that records a removal.
    pub digest: Option<ContentDigest>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> DocumentPage {
        DocumentPage {
            document: DocumentReport {
                document: DocumentName {
                    kind: DocumentKind::ObjectModel,
                    name: "n".repeat(256),
                },
                media_type: "m".repeat(256),
                bytes: u64::MAX,
                digest: ContentDigest(u128::MAX),
                author: "a".repeat(256),
                decided_ns: u64::MAX,
                sequence: u64::MAX,
            },
            offset: u64::MAX,
            content: vec![255; DOCUMENT_PAGE_BYTES],
        }
    }

    #[test]
    fn longest_page_fits_into_a_message_and_survives_it() {
        let mut bytes = Vec::new();
        ciborium::into_writer(&page(), &mut bytes).unwrap();
        assert!(bytes.len() + 1024 < crate::MAX_MESSAGE_BYTES);
        let read: DocumentPage = ciborium::from_reader(&bytes[..]).unwrap();
        assert_eq!(read, page());
    }

    /// Test vector of the BLAKE3 specification: the hash of no bytes.
    #[test]
    fn content_digest_is_the_beginning_of_blake3() {
        let empty = ContentDigest::of(b"");
        assert_eq!(empty.to_string(), "af1349b9f5f9a1a6a0404dea36dcc949");
        assert_ne!(ContentDigest::of(b"\0"), empty);
    }
}
