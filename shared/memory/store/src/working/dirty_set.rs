//! Dirty set: records that have to be written to disk.

use std::collections::BTreeSet;

use super::record_key::RecordKey;

/// Set of records that differ from those on disk. Repeated changes of a record count once, so that
/// the set is never larger than the model.
#[derive(Debug, Default)]
pub(super) struct DirtySet {
    entries: BTreeSet<RecordKey>,
    version: u64,
}

impl DirtySet {
    pub(super) fn add(&mut self, entry: RecordKey) {
        self.version += 1;
        self.entries.insert(entry);
    }

    /// Version counter of the model, incremented by each change.
    pub(super) fn version(&self) -> u64 {
        self.version
    }

    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Removes and returns one record key.
    pub(super) fn take(&mut self) -> Option<RecordKey> {
        self.entries.pop_first()
    }
}
