//! Bounded log of the states of recent commands.

use std::collections::VecDeque;

use super::CommandState;

/// Command states by identity. When the log is full, the oldest final state is removed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommandLog {
    entries: VecDeque<(u64, CommandState)>,
}

impl CommandLog {
    /// Number of commands whose state is remembered.
    pub(super) const CAPACITY: usize = 64;

    pub(super) fn new() -> Self {
        Self {
            entries: VecDeque::with_capacity(Self::CAPACITY + 1),
        }
    }

    pub(super) fn state(&self, id: u64) -> Option<CommandState> {
        self.entries
            .iter()
            .find(|entry| entry.0 == id)
            .map(|entry| entry.1)
    }

    /// Records the state of a new or a known command.
    pub(super) fn note(&mut self, id: u64, state: CommandState) {
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.0 == id) {
            entry.1 = state;
            return;
        }
        if self.entries.len() >= Self::CAPACITY
            && let Some(oldest) = self.entries.iter().position(|entry| entry.1.is_final())
        {
            self.entries.remove(oldest);
        }
        self.entries.push_back((id, state));
    }
}
