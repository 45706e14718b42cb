//! What became of the latest commands.

use std::collections::VecDeque;

use super::CommandState;

/// States of commands by identity. Bounded: the oldest final one makes room.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommandLog {
    entries: VecDeque<(u64, CommandState)>,
}

impl CommandLog {
    /// How many commands are remembered.
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

    /// Notes the state of a command, new or known.
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
