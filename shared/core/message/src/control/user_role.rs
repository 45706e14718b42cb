//! Roles of users and the permissions that commands need (role-based access control).

use super::{ArmCommand, Command, JobCommand, JobKind, WorldCommand};
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

impl Command {
    /// Least role that may send the command. A stop of the arm is open to everybody.
    pub fn required_role(&self) -> UserRole {
        match self {
            Self::Objects
            | Self::Ask { .. }
            | Self::Question
            | Self::Find(_)
            | Self::Health
            | Self::DepthNoise
            | Self::Categories
            | Self::Memory(_)
            | Self::Arm(ArmCommand::State | ArmCommand::Stop) => UserRole::Reader,
            Self::Teach(_)
            | Self::Correct(_)
            | Self::Forget { .. }
            | Self::Revise(_)
            | Self::Arm(_)
            | Self::LeaseTrackIds { .. }
            | Self::StoreViews { .. } => UserRole::Teacher,
            Self::World(command) => command.required_role(),
            Self::Job(command) => command.required_role(),
            Self::Snapshot { .. }
            | Self::Clouds { .. }
            | Self::Changes { .. }
            | Self::ReloadConfiguration => UserRole::Administrator,
            Self::ReadAfter { command, .. } => command.required_role(),
        }
    }
}

impl WorldCommand {
    fn required_role(&self) -> UserRole {
        match self {
            Self::Now | Self::Facts(_) | Self::Events { .. } | Self::Tasks { .. } => {
                UserRole::Reader
            }
            Self::StartTask { .. } | Self::EndTask { .. } => UserRole::Teacher,
        }
    }
}

impl JobCommand {
    /// A job is followed by whoever began it. So bytes of an import are written by administrators
    /// alone, although those of a document need a teacher only.
    fn required_role(&self) -> UserRole {
        match self {
            Self::Ask { .. } => UserRole::Reader,
            Self::Begin(JobKind::Verify | JobKind::Export | JobKind::Document)
            | Self::Read { .. }
            | Self::Write { .. } => UserRole::Teacher,
            Self::Begin(_) | Self::Import { .. } => UserRole::Administrator,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{Labelling, MutationId, Revision, RevisionChange};

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
            (Command::Arm(ArmCommand::Home), UserRole::Teacher),
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
