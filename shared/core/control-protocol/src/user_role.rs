//! Roles of users (role-based access control); [`request`](crate::request) has the one that each command
//! needs.

use serde::{Deserialize, Serialize};

/// Role of a user on the control socket. A role includes the ones before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UserRole {
    /// Reads everything but the point clouds, and stops the arm.
    Reader,
    /// Teaches, undoes and redoes its own changes, moves the arm, exports and verifies.
    Teacher,
    /// Imports, repairs, deletes permanently, undoes the changes of others, and reloads the
    /// configuration.
    Administrator,
}

impl UserRole {
    /// Name of the role in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reader => "reader",
            Self::Teacher => "teacher",
            Self::Administrator => "administrator",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ArmCommand, Command, JobCommand, JobKind};
    use crate::{Labelling, MutationId, Revision, RevisionChange};

    #[test]
    fn role_includes_the_ones_before_it() {
        assert!(UserRole::Reader < UserRole::Teacher);
        assert!(UserRole::Teacher < UserRole::Administrator);
    }

    #[test]
    fn required_role_grows_with_the_effect_of_a_command() {
        let revise = |change| {
            Command::Revise(Revision {
                id: MutationId(1),
                author: String::new(),
                change,
            })
        };
        let lesson = Labelling {
            id: MutationId(1),
            author: String::new(),
            track_id: 1,
            category: "mug".into(),
            is_new: false,
        };
        let compact = JobKind::Compact { forgotten_for_s: 0 };
        for (command, role) in [
            (Command::Objects, UserRole::Reader),
            (Command::Arm(ArmCommand::Stop), UserRole::Reader),
            (
                Command::Arm(ArmCommand::Release { lease: 1 }),
                UserRole::Teacher,
            ),
            (Command::Teach(lesson), UserRole::Teacher),
            (
                revise(RevisionChange::Undo { sequence: None }),
                UserRole::Teacher,
            ),
            (revise(RevisionChange::Redo), UserRole::Teacher),
            (
                Command::Job(JobCommand::Begin(JobKind::Export)),
                UserRole::Teacher,
            ),
            (
                Command::Job(JobCommand::Begin(JobKind::Document)),
                UserRole::Teacher,
            ),
            (
                Command::Job(JobCommand::Begin(JobKind::Import)),
                UserRole::Administrator,
            ),
            (
                Command::Job(JobCommand::Begin(compact)),
                UserRole::Administrator,
            ),
            (Command::ReloadConfiguration, UserRole::Administrator),
        ] {
            assert_eq!(command.required_role(), role, "{command:?}");
        }
    }

    #[test]
    fn stop_and_health_need_no_more_than_a_reader() {
        for command in [Command::Arm(ArmCommand::Stop), Command::Health] {
            assert!(command.is_urgent());
            assert_eq!(command.required_role(), UserRole::Reader);
        }
    }
}
