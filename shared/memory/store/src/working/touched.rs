//! Which records are to be written again.

use std::collections::BTreeSet;

use super::keys::Entry;

/// Records that differ from those on disk. However often one changes it is here
/// once, so that what waits is never more than what is known.
#[derive(Debug, Default)]
pub(super) struct Touched {
    entries: BTreeSet<Entry>,
    version: u64,
}

impl Touched {
    pub(super) fn add(&mut self, entry: Entry) {
        self.version += 1;
        self.entries.insert(entry);
    }

    /// Grows with each change.
    pub(super) fn version(&self) -> u64 {
        self.version
    }

    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Takes some of the records.
    pub(super) fn take(&mut self) -> Option<Entry> {
        self.entries.pop_first()
    }
}
