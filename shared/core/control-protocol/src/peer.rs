//! User who sent a command.

use crate::UserRole;
use serde::{Deserialize, Serialize};

/// User behind a command, as the kernel names him, with his role.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Peer {
    /// User id of the process that sent the command (`SO_PEERCRED`).
    pub uid: u32,
    /// Role of the user, by his groups.
    pub role: UserRole,
}
