//! Memtable: the newest records in memory, in key order.

use std::collections::BTreeMap;
use std::collections::btree_map::Range;
use std::ops::Bound;

use crate::write_batch::BatchRecord;

/// Estimated size of a record in memory besides key and value, bytes.
const RECORD_BYTES: usize = 64;

/// Newest writes and deletions by key.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memtable {
    records: BTreeMap<Vec<u8>, Option<Vec<u8>>>,
    n_bytes: usize,
}

impl Memtable {
    /// Applies a write or deletion.
    pub(crate) fn insert(&mut self, (key, value): BatchRecord) {
        let size = |value: &Option<Vec<u8>>| value.as_ref().map_or(0, Vec::len);
        let n_key = key.len();
        self.n_bytes += size(&value);
        match self.records.insert(key, value) {
            Some(replaced) => self.n_bytes -= size(&replaced),
            None => self.n_bytes += n_key + RECORD_BYTES,
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Size in memory, bytes.
    pub(crate) fn n_bytes(&self) -> usize {
        self.n_bytes
    }

    /// Records from `key` on, in order; deletions are `None`.
    pub(crate) fn range_from(&self, key: &[u8]) -> Range<'_, Vec<u8>, Option<Vec<u8>>> {
        let from = (Bound::Included(key), Bound::Unbounded);
        self.records.range::<[u8], _>(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaced_values_do_not_count() {
        let mut memtable = Memtable::default();
        memtable.insert((b"cup".to_vec(), Some(vec![1; 1000])));
        let n_bytes = memtable.n_bytes();
        for _ in 0..10 {
            memtable.insert((b"cup".to_vec(), Some(vec![2; 1000])));
        }
        assert_eq!(memtable.n_bytes(), n_bytes);
        memtable.insert((b"cup".to_vec(), None));
        assert_eq!(memtable.n_bytes(), n_bytes - 1000);
        assert_eq!(memtable.range_from(b"cuo").count(), 1);
        assert_eq!(memtable.range_from(b"cuq").count(), 0);
    }
}
