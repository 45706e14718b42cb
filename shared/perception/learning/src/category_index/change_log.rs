//! Change log: the views that the newest changes of an index concern.

use crate::ViewId;
use std::collections::VecDeque;

/// Number of changes that are kept. Chosen: some minutes of busy teaching, 24 kB.
const N_CHANGES: usize = 1024;

/// Newest changes with the revision that each led to, oldest first.
#[derive(Debug, Clone)]
pub(super) struct ChangeLog {
    /// Revision before the oldest change.
    base: u64,
    changes: VecDeque<(u64, ViewId)>,
}

impl ChangeLog {
    /// Log that begins at a revision.
    pub(super) fn new(base: u64) -> Self {
        Self {
            base,
            changes: VecDeque::new(),
        }
    }

    /// Records a change of a view that led to a revision.
    pub(super) fn push(&mut self, revision: u64, view: ViewId) {
        if self.changes.len() == N_CHANGES
            && let Some((oldest, _)) = self.changes.pop_front()
        {
            self.base = oldest;
        }
        self.changes.push_back((revision, view));
    }

    /// Views changed after a revision of this index or of an ancestor, oldest change
    /// first; `None` if the log does not reach back, or the revision is of another index.
    pub(super) fn since(&self, revision: u64) -> Option<impl Iterator<Item = ViewId>> {
        let first = if revision == self.base {
            0
        } else {
            // Revisions ascend within an index.
            let place = self.changes.partition_point(|(r, _)| *r < revision);
            self.changes.get(place).filter(|(r, _)| *r == revision)?;
            place + 1
        };
        Some(self.changes.range(first..).map(|(_, view)| *view))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(track_id: u64) -> ViewId {
        ViewId {
            track_id,
            view_id: 0,
        }
    }

    #[test]
    fn changes_since_a_revision_are_those_that_followed() {
        let mut log = ChangeLog::new(10);
        for revision in [12, 15, 19] {
            log.push(revision, view(revision));
        }
        let since = |revision| Some(log.since(revision)?.map(|v| v.track_id).collect::<Vec<_>>());
        assert_eq!(since(10), Some(vec![12, 15, 19]));
        assert_eq!(since(15), Some(vec![19]));
        assert_eq!(since(19), Some(vec![]));
        for foreign in [9, 11, 16, 20] {
            assert_eq!(since(foreign), None, "{foreign}");
        }
    }

    #[test]
    fn a_full_log_forgets_its_oldest_changes() {
        let mut log = ChangeLog::new(0);
        let n = N_CHANGES as u64 + 2;
        for revision in 1..=n {
            log.push(revision, view(revision));
        }
        assert!(log.since(1).is_none());
        assert_eq!(log.since(2).map(Iterator::count), Some(N_CHANGES));
    }
}
