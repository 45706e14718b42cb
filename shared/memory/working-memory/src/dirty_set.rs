//! Dirty set: records that have to be written to disk.

use std::collections::BTreeSet;

use crate::record_key::RecordKey;

/// Set of records that differ from those on disk. Repeated changes of a record count once, so that
/// the set is never larger than the model.
#[derive(Debug, Default)]
pub(crate) struct DirtySet {
    entries: BTreeSet<RecordKey>,
    version: u64,
}

impl DirtySet {
    pub(crate) fn add(&mut self, entry: RecordKey) {
        self.version += 1;
        self.entries.insert(entry);
    }

    /// Version counter of the model, incremented by each change.
    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Removes and returns one key of a changed record.
    pub(crate) fn take(&mut self) -> Option<RecordKey> {
        self.entries.pop_first()
    }
}
