//! Peer credentials: the user behind a connection, as the kernel names it.

use message::control::UserRole;

/// User who sent a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Peer {
    /// User id (`SO_PEERCRED`).
    pub uid: u32,
    /// Role of the user, by its groups.
    pub role: UserRole,
}

impl Peer {
    /// This process's own user, who runs the daemon.
    pub fn own() -> Self {
        Self {
            uid: rustix::process::geteuid().as_raw(),
            role: UserRole::Administrator,
        }
    }
}
