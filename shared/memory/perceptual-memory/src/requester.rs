//! Requester of a mutation: the user as the kernel names it, and the right to undo.

use crate::history::HistoryEntry;

/// User who requests a mutation. The author of a mutation is what the client claims; this is
/// what the kernel says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Requester {
    /// User id; `None` for maintenance by the daemon itself.
    pub uid: Option<u32>,
    /// `true` if the user may undo the entries of other users.
    pub may_undo_others: bool,
}

impl Requester {
    /// User with all rights.
    pub fn administrator(uid: u32) -> Self {
        Self {
            uid: Some(uid),
            may_undo_others: true,
        }
    }

    /// `true` if this user may undo an entry: one of its own, or any with the right to.
    pub(crate) fn may_undo(&self, entry: &HistoryEntry) -> bool {
        self.may_undo_others || (self.uid.is_some() && self.uid == entry.uid)
    }
}
