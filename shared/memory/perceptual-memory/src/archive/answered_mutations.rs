//! Idempotency keys of a segment: a sorted table, searched by bisection, which takes twenty bytes
//! an entry in memory and on disk.

use durable_leveldb::MutationId;
use serde::{Deserialize, Serialize};
use serde_bytes::ByteBuf;

/// Length of a row: the key, and the offset of the entry in its segment, both big-endian.
const ROW_BYTES: usize = 20;

/// Sorted table of idempotency keys with the offsets of their entries.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct AnsweredMutations(ByteBuf);

impl AnsweredMutations {
    pub(super) fn new(mut mutations: Vec<(MutationId, u32)>) -> Self {
        mutations.sort_unstable();
        let mut table = ByteBuf::with_capacity(mutations.len() * ROW_BYTES);
        for (id, offset) in mutations {
            table.extend(id.0.to_be_bytes());
            table.extend(offset.to_be_bytes());
        }
        Self(table)
    }

    /// Offset of the entry with this key.
    pub(super) fn offset_of(&self, id: MutationId) -> Option<u64> {
        let (rows, _) = self.0.as_chunks::<ROW_BYTES>();
        let key = id.0.to_be_bytes();
        let found = rows.binary_search_by(|row| row[..key.len()].cmp(&key));
        let offset = rows[found.ok()?].last_chunk::<4>()?;
        Some(u64::from(u32::from_be_bytes(*offset)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn answered_mutation_is_found_among_others(
            known in prop::collection::btree_map(any::<u128>(), any::<u32>(), 0..50),
            other in any::<u128>(),
        ) {
            let pairs = known.iter().map(|(id, offset)| (MutationId(*id), *offset));
            let table = AnsweredMutations::new(pairs.rev().collect());
            for (id, offset) in &known {
                prop_assert_eq!(table.offset_of(MutationId(*id)), Some(u64::from(*offset)));
            }
            prop_assert_eq!(table.offset_of(MutationId(other)).is_some(), known.contains_key(&other));
        }
    }
}
