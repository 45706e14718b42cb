//! The keys of the database: one letter for the table, then big-endian numbers,
//! so that the order of the bytes is the order of what they mean.

use learning::{CategoryName, ViewId};

use crate::mutation::MutationId;

/// Category to view: `c`, length and bytes of the name, track, view.
pub(crate) const CATEGORY_INDEX: u8 = b'c';
/// Descriptor of a view: `d`, track, view.
pub(crate) const DESCRIPTOR: u8 = b'd';
/// History: `h`, sequence.
pub(crate) const HISTORY: u8 = b'h';
/// Answer to a mutation: `i`, the client's id.
pub(crate) const ANSWER: u8 = b'i';
/// Label of a view: `l`, track, view.
pub(crate) const LABEL: u8 = b'l';
/// The one meta record: `m`.
pub(crate) const META: u8 = b'm';
/// Cloud of a key view: `p`, track, view.
pub(crate) const POINTS: u8 = b'p';
/// A view without its large parts: `v`, track, view.
pub(crate) const VIEW: u8 = b'v';

/// A key of the tables that hold something of a view.
pub(crate) fn view_key(table: u8, view: ViewId) -> [u8; 13] {
    let mut key = [table; 13];
    key[1..9].copy_from_slice(&view.track_id.to_be_bytes());
    key[9..].copy_from_slice(&view.view_id.to_be_bytes());
    key
}

/// The view a key of such a table is about.
pub(crate) fn view_of(key: &[u8]) -> Option<ViewId> {
    let key: &[u8; 13] = key.try_into().ok()?;
    Some(ViewId {
        track_id: u64::from_be_bytes(*key[1..].first_chunk()?),
        view_id: u32::from_be_bytes(*key[9..].first_chunk()?),
    })
}

/// Key of a history entry.
pub(crate) fn history_key(sequence: u64) -> [u8; 9] {
    let mut key = [HISTORY; 9];
    key[1..].copy_from_slice(&sequence.to_be_bytes());
    key
}

/// The sequence of a history key.
pub(crate) fn sequence_of(key: &[u8]) -> Option<u64> {
    let key: &[u8; 9] = key.try_into().ok()?;
    Some(u64::from_be_bytes(*key[1..].first_chunk()?))
}

/// Key of the answer to a mutation.
pub(crate) fn answer_key(id: MutationId) -> [u8; 17] {
    let mut key = [ANSWER; 17];
    key[1..].copy_from_slice(&id.0.to_be_bytes());
    key
}

/// The mutation an answer's key is about.
pub(crate) fn mutation_of(key: &[u8]) -> Option<MutationId> {
    let key: &[u8; 17] = key.try_into().ok()?;
    Some(MutationId(u128::from_be_bytes(*key[1..].first_chunk()?)))
}

/// Key of an entry in the category index. The name's length comes first, so
/// that no name can run into the numbers behind it.
pub(crate) fn category_key(category: &CategoryName, view: ViewId) -> Vec<u8> {
    let name = category.as_str().as_bytes();
    let mut key = Vec::with_capacity(3 + name.len() + 12);
    key.push(CATEGORY_INDEX);
    key.extend_from_slice(&(name.len() as u16).to_be_bytes());
    key.extend_from_slice(name);
    key.extend_from_slice(&view_key(CATEGORY_INDEX, view)[1..]);
    key
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
            prop_assert_eq!(view_of(&view_key(LABEL, a)), Some(a));
            prop_assert_eq!(view_key(VIEW, a).cmp(&view_key(VIEW, b)), a.cmp(&b));
            prop_assert_eq!(sequence_of(&history_key(s)), Some(s));
            prop_assert_eq!(history_key(s).cmp(&history_key(t)), s.cmp(&t));
        }

        #[test]
        fn ids_are_read_back(id in any::<u128>()) {
            prop_assert_eq!(mutation_of(&answer_key(MutationId(id))), Some(MutationId(id)));
        }
    }
}
