//! Database keys of the perceptual memory: a table letter and big-endian numbers, so that byte
//! order equals semantic order.

use learning::ViewId;

use crate::digest::Digest;
use crate::document_key::{DocumentKey, DocumentKind};
use crate::error::{Error, StorageError};
use crate::view_phrase::view_phrase;

/// Record about the archived part of the history: `a`.
pub(crate) const ARCHIVE: u8 = b'a';
/// Table of point clouds and documents: `b`, content digest.
pub(crate) const BLOB: u8 = b'b';
/// Database table of descriptors: `d`, content digest.
pub(crate) const DESCRIPTOR: u8 = b'd';
/// Table of history entries: `h`, sequence number.
pub(crate) const HISTORY: u8 = b'h';
/// Record of the store's sizes: `s`.
pub(crate) const SIZES: u8 = b's';
/// Table of index rows: `i`, track-id, view id.
pub(crate) const ROW: u8 = b'i';
/// Table of label registers of schema 2, only for views with a decision: `l`, track-id, view id.
pub(crate) const REGISTER_2: u8 = b'l';
/// Metadata record: `m`.
pub(crate) const META: u8 = b'm';
/// Table of document versions: `o`, kind, length and bytes of the name, sequence number.
pub(crate) const DOCUMENT: u8 = b'o';
/// Table of tombstones of purged views: `n`, content digest.
pub(crate) const TOMBSTONE: u8 = b'n';
/// Table of tombstones of schema 2: `t`, content digest.
pub(crate) const TOMBSTONE_2: u8 = b't';
/// Table of view metadata: `v`, track-id, view id.
pub(crate) const VIEW: u8 = b'v';

/// Key of a record about a view.
pub(crate) fn view_key(table: u8, view: ViewId) -> [u8; 13] {
    let mut key = [table; 13];
    key[1..9].copy_from_slice(&view.track_id.to_be_bytes());
    key[9..].copy_from_slice(&view.view_id.to_be_bytes());
    key
}

/// View id contained in a database key.
pub(crate) fn view_of(key: &[u8]) -> Option<ViewId> {
    let key: &[u8; 13] = key.try_into().ok()?;
    Some(ViewId {
        track_id: u64::from_be_bytes(*key[1..].first_chunk()?),
        view_id: u32::from_be_bytes(*key[9..].first_chunk()?),
    })
}

/// Database key of a history entry.
pub(crate) fn history_key(sequence: u64) -> [u8; 9] {
    let mut key = [HISTORY; 9];
    key[1..].copy_from_slice(&sequence.to_be_bytes());
    key
}

/// Sequence number contained in a history key.
pub(crate) fn sequence_of(key: &[u8]) -> Option<u64> {
    let key: &[u8; 9] = key.try_into().ok()?;
    Some(u64::from_be_bytes(*key[1..].first_chunk()?))
}

/// Key of a record under a content digest.
pub(crate) fn digest_key(table: u8, digest: Digest) -> [u8; 17] {
    let mut key = [table; 17];
    key[1..].copy_from_slice(&digest.0.to_be_bytes());
    key
}

/// Content digest contained in a database key.
pub(crate) fn digest_of(key: &[u8]) -> Option<Digest> {
    let key: &[u8; 17] = key.try_into().ok()?;
    Some(Digest(u128::from_be_bytes(*key[1..].first_chunk()?)))
}

/// Key of a document version. The length of the name comes first, so that names and sequence
/// numbers cannot be confused.
pub(crate) fn document_key(document: &DocumentKey, sequence: u64) -> Vec<u8> {
    let name = document.name.as_bytes();
    let mut key = Vec::with_capacity(4 + name.len() + 8);
    key.extend([DOCUMENT, document.kind.code()]);
    key.extend((name.len() as u16).to_be_bytes());
    key.extend(name);
    key.extend(sequence.to_be_bytes());
    key
}

/// Document key and sequence number in a key.
pub(crate) fn document_of(key: &[u8]) -> Option<(DocumentKey, u64)> {
    let (&[_, kind, high, low], rest) = key.split_first_chunk::<4>()?;
    let (name, sequence) = rest.split_at_checked(u16::from_be_bytes([high, low]) as usize)?;
    let document = DocumentKey {
        kind: DocumentKind::from_code(kind)?,
        name: str::from_utf8(name).ok()?.into(),
    };
    Some((document, u64::from_be_bytes(sequence.try_into().ok()?)))
}

/// Phrase for the record under a key, for error messages.
pub(crate) fn in_words(key: &[u8]) -> String {
    let table = key.first().copied().unwrap_or_default();
    let view = view_of(key).map(view_phrase);
    let digest = digest_of(key);
    match (table, view, digest, sequence_of(key), document_of(key)) {
        (VIEW, Some(view), ..) => view,
        (ROW, Some(view), ..) => format!("the index row of {view}"),
        (DESCRIPTOR, _, Some(digest), ..) => format!("the descriptor {digest}"),
        (BLOB, _, Some(digest), ..) => format!("the cloud or document {digest}"),
        (TOMBSTONE, _, Some(digest), ..) => format!("the note of the forgotten view {digest}"),
        (HISTORY, _, _, Some(sequence), _) => format!("history entry {sequence}"),
        (DOCUMENT, .., Some((document, sequence))) => {
            format!("{document}, as of entry {sequence}")
        }
        (META, ..) => "the record about the store".to_owned(),
        (SIZES, ..) => "the record of the store's sizes".to_owned(),
        (ARCHIVE, ..) => "the record about the archived history".to_owned(),
        _ => format!("the record {}", key.escape_ascii()),
    }
}

/// [`StorageError::Damaged`] about the record under `key`.
pub(crate) fn record_error(key: &[u8], wrong: &str) -> Error {
    let what = format!("{}: {wrong}", in_words(key));
    Error::Storage(StorageError::Damaged { what })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn views() -> impl Strategy<Value = ViewId> {
        (any::<u64>(), any::<u32>()).prop_map(|(track_id, view_id)| ViewId { track_id, view_id })
    }

    proptest! {
        #[test]
        fn keys_keep_content_and_order(a in views(), b in views(), s in any::<u64>(), t in any::<u64>()) {
            prop_assert_eq!(view_of(&view_key(ROW, a)), Some(a));
            prop_assert_eq!(view_key(VIEW, a).cmp(&view_key(VIEW, b)), a.cmp(&b));
            prop_assert_eq!(sequence_of(&history_key(s)), Some(s));
            prop_assert_eq!(history_key(s).cmp(&history_key(t)), s.cmp(&t));
        }

        #[test]
        fn digests_and_documents_are_read_back(digest in any::<u128>(), name in ".{0,40}", s in any::<u64>()) {
            let digest = Digest(digest);
            prop_assert_eq!(digest_of(&digest_key(BLOB, digest)), Some(digest));
            let document = DocumentKey { kind: DocumentKind::ObjectModel, name: name.as_str().into() };
            prop_assert_eq!(document_of(&document_key(&document, s)), Some((document, s)));
        }
    }
}
