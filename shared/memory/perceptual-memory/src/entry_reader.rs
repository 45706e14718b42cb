//! Reader of a range of history entries in either direction, some at once.

use std::collections::VecDeque;
use std::ops::{Range, RangeInclusive};

use crate::error::Error;
use crate::history::HistoryEntry;
use crate::perceptual_memory::PerceptualMemory;

/// Number of entries that are read at once.
const READ_ENTRIES: u64 = 64;

/// Reader of the intact entries of a range.
pub(crate) struct EntryReader {
    /// Entries that were not read yet.
    left: Range<u64>,
    is_backward: bool,
    read: VecDeque<HistoryEntry>,
}

impl EntryReader {
    /// Reader from the first to the last entry of a range.
    pub(crate) fn forward(range: RangeInclusive<u64>) -> Self {
        Self {
            left: *range.start()..range.end() + 1,
            is_backward: false,
            read: VecDeque::new(),
        }
    }

    /// Reader from the last to the first entry of a range.
    pub(crate) fn backward(range: RangeInclusive<u64>) -> Self {
        Self {
            is_backward: true,
            ..Self::forward(range)
        }
    }

    /// Next entry; lost ones are left out. `None` at the end.
    pub(crate) fn next(
        &mut self,
        memory: &mut PerceptualMemory,
    ) -> Result<Option<HistoryEntry>, Error> {
        while self.read.is_empty() && !self.left.is_empty() {
            let known = self.next_range();
            let known = known.filter(|sequence| !memory.index.is_lost(*sequence));
            self.read = memory.entries(known.collect())?.into();
        }
        Ok(if self.is_backward {
            self.read.pop_back()
        } else {
            self.read.pop_front()
        })
    }

    /// Takes the sequence numbers that are read next.
    fn next_range(&mut self) -> Range<u64> {
        let Range { start, end } = self.left;
        if self.is_backward {
            let from = start.max(end.saturating_sub(READ_ENTRIES));
            self.left.end = from;
            from..end
        } else {
            let to = end.min(start + READ_ENTRIES);
            self.left.start = to;
            start..to
        }
    }
}
