//! Access policy of the control socket: roles by user and group.

use super::peer_groups::peer_groups;
use crate::group::group_id;
use control_protocol::{Peer, UserRole};
use std::io;
use std::sync::{Arc, PoisonError, RwLock};
use tokio::net::UnixStream;

/// Groups whose members have more than the role of a reader, by name or number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoleGroups {
    /// Group whose members are teachers.
    pub teachers: String,
    /// Group whose members are administrators.
    pub administrators: String,
}

/// Control of the groups of a running server.
#[derive(Debug, Clone)]
pub struct AccessControl(Arc<RwLock<AccessPolicy>>);

impl AccessControl {
    pub(super) fn new(groups: &RoleGroups) -> Self {
        Self(Arc::new(RwLock::new(AccessPolicy::new(groups))))
    }

    /// Replaces the groups, for new connections. Their names are looked up now.
    pub fn set_groups(&self, groups: &RoleGroups) {
        let policy = AccessPolicy::new(groups);
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = policy;
    }

    pub(super) fn policy(&self) -> AccessPolicy {
        *self.0.read().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Roles of those who may connect: the daemon's user and root administer, members of the two
/// groups have their roles, all others read.
#[derive(Debug, Clone, Copy)]
pub(super) struct AccessPolicy {
    own_uid: u32,
    teachers: Option<u32>,
    administrators: Option<u32>,
}

impl AccessPolicy {
    /// Policy of this process's user. A group that does not exist has no members.
    pub(super) fn new(groups: &RoleGroups) -> Self {
        Self {
            own_uid: rustix::process::geteuid().as_raw(),
            teachers: group_id(&groups.teachers),
            administrators: group_id(&groups.administrators),
        }
    }

    /// Peer of a connection, as the kernel names it.
    ///
    /// # Errors
    /// When the peer is gone.
    pub(super) fn peer(&self, stream: &UnixStream) -> io::Result<Peer> {
        let credentials = stream.peer_cred()?;
        let mut groups = peer_groups(stream)?;
        groups.push(credentials.gid());
        let uid = credentials.uid();
        Ok(Peer {
            uid,
            role: self.role(uid, &groups),
        })
    }

    fn role(&self, uid: u32, groups: &[u32]) -> UserRole {
        let is_member = |group: Option<u32>| group.is_some_and(|group| groups.contains(&group));
        if [0, self.own_uid].contains(&uid) || is_member(self.administrators) {
            UserRole::Administrator
        } else if is_member(self.teachers) {
            UserRole::Teacher
        } else {
            UserRole::Reader
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn role_follows_from_user_and_groups() {
        let policy = AccessPolicy {
            own_uid: 900,
            teachers: Some(990),
            administrators: Some(991),
        };
        assert_eq!(policy.role(0, &[]), UserRole::Administrator);
        assert_eq!(policy.role(900, &[]), UserRole::Administrator);
        assert_eq!(policy.role(1000, &[5, 991]), UserRole::Administrator);
        assert_eq!(policy.role(1000, &[990, 5]), UserRole::Teacher);
        assert_eq!(policy.role(1000, &[5]), UserRole::Reader);
    }

    #[test]
    fn groups_are_replaced_while_the_server_runs() {
        let groups = |administrators: &str| RoleGroups {
            teachers: "no such group".into(),
            administrators: administrators.into(),
        };
        let control = AccessControl::new(&groups("12345"));
        let role = || {
            control
                .policy()
                .role(control.policy().own_uid + 1, &[12345])
        };
        assert_eq!(role(), UserRole::Administrator);
        control.clone().set_groups(&groups("54321"));
        assert_eq!(role(), UserRole::Reader);
    }

    #[test]
    fn group_that_does_not_exist_has_no_members() {
        let policy = AccessPolicy::new(&RoleGroups {
            teachers: "no such group".into(),
            administrators: "nor this one".into(),
        });
        let other = policy.own_uid + 1;
        assert_eq!(policy.role(other, &[0, 1, 2]), UserRole::Reader);
    }
}
