//! Control protocol: requests and replies between people, scripts and processes.
//!
//! One request, one reply, CBOR on the wire ([`codec`]) over a Unix socket. All reports are
//! documents that `--json` prints: `snake_case`, SI units.
//!
//! # Example
//!
//! ```
//! use control_protocol::{Command, MemoryQuery, Request};
//! use process_registry::ProcessKind;
//!
//! let request = Request::from(Command::Memory(MemoryQuery::Stats));
//! assert_eq!(request.command.owner(), ProcessKind::MEMORY);
//! ```

mod arm;
pub mod codec;
mod descriptor_bytes;
mod document;
mod find;
mod learning;
mod memory;
mod packed_cloud;
mod peer;
mod printable_request;
mod question;
mod refusal;
mod reload;
mod report;
pub mod request;
mod task;
mod user_role;
mod world;

pub use arm::{ArmCommand, ArmLease, ArmMotion, ArmReport};
pub use descriptor_bytes::{DescriptorBytes, InvalidDescriptor};
pub use document::{
    ContentDigest, DOCUMENT_PAGE_BYTES, DocumentKind, DocumentName, DocumentPage, DocumentReport,
    DocumentVersionReport, MAX_DOCUMENT_BYTES, PageRequest,
};
pub use find::{FindQuery, FindReport, FoundObjectReport, WordUseReport};
pub use learning::{
    ChangesPage, LearnedChange, LearnedView, MutationId, RandomIdError, SnapshotCursor,
    SnapshotPage, StoredView, ViewId,
};
pub use memory::{
    AheadDecision, ExportReport, HistoryOperation, HistoryReport, ImportCompletion, ImportReport,
    JobCommand, JobKind, JobOutcome, JobReport, MemoryAnswer, MemoryQuery, MemoryStats, Revision,
    RevisionChange, VerificationReport, ViewReport,
};
pub use packed_cloud::{InvalidCloud, MAX_CLOUD_POINTS, PackedCloud, pack_cloud};
pub use peer::Peer;
pub use question::{QuestionKind, QuestionReport, QuestionsReport};
pub use refusal::{Refusal, RefusalKind};
pub use reload::{KeyChange, ReloadReport};
pub use report::{DepthNoiseReport, LearningReport};
pub use request::TypedRequest;
pub use task::{
    LeftObjectReport, PlannedObjectReport, TaskCommand, TaskKind, TaskOrder, TaskReport,
};
pub use user_role::UserRole;
pub use world::{
    FactFilter, MAX_EVENT_WAIT_MS, MAX_PAGE_EVENTS, MAX_PAGE_FACTS, MAX_PAGE_STEPS, MAX_PAGE_TASKS,
    MAX_PLAN_BYTES, MAX_STEP_REASON_BYTES, MAX_STEP_WORD_BYTES, MAX_TASK_PLAN_BYTES,
    MAX_TASK_STEPS, RecordedStep, TaskOutcome, WorldCommand, WorldRegion, WorldReply,
};

use process_registry::ProcessKind;
use scene_document::{CategoryDocument, HealthDocument, ObjectDocument, SceneDocument};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Version of the control protocol: requests and replies.
pub const PROTOCOL_VERSION: u32 = 2;

/// Maximum size of an encoded request or reply, bytes; longer answers are paged.
pub const MAX_MESSAGE_BYTES: usize = 512 * 1024;

/// Request: a command with the protocol version of its writer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// [`PROTOCOL_VERSION`] of the requesting program.
    pub protocol: u32,
    /// Command to be carried out.
    pub command: Command,
    /// User on whose behalf the gateway passes the command on; none for the sender himself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub user: Option<Peer>,
}

impl From<Command> for Request {
    fn from(command: Command) -> Self {
        Self {
            protocol: PROTOCOL_VERSION,
            command,
            user: None,
        }
    }
}

/// Command of the control protocol.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Command {
    /// List all tracked objects.
    Objects,
    /// Report one tracked object.
    Ask {
        /// Track-id of the object to report.
        track_id: u64,
    },
    /// Question about the object whose name would teach most.
    Question,
    /// Find objects by words.
    Find(FindQuery),
    /// Report the health of all processes.
    Health,
    /// Report the depth noise measured on the table.
    DepthNoise,
    /// Let all processes read the configuration again.
    ReloadConfiguration,
    /// Label a track that has no other label.
    Teach(Labelling),
    /// Label a track, replacing any label it has.
    Correct(Labelling),
    /// Forget a category; its views are kept without a label.
    Forget {
        /// Idempotency key of the mutation.
        id: MutationId,
        /// Author of the change.
        author: String,
        /// Name of the category to forget.
        category: String,
    },
    /// List the learned categories.
    Categories,
    /// Revise the perceptual memory other than by teaching.
    Revise(Revision),
    /// Query the perceptual memory.
    Memory(MemoryQuery),
    /// Start or follow a long-running job on the perceptual memory.
    Job(JobCommand),
    /// Command the arm.
    Arm(ArmCommand),
    /// Command the tasks of the robot.
    Task(TaskCommand),
    /// Query or update the working memory.
    World(WorldCommand),
    /// Lease a block of track-ids that are never issued again.
    LeaseTrackIds {
        /// Number of track-ids to lease.
        count: u32,
    },
    /// Store key views durably. Their track-ids must have been leased by the sender.
    StoreViews {
        /// Idempotency key of the mutation.
        id: MutationId,
        /// Key views to store.
        views: Vec<StoredView>,
    },
    /// Read one page of all labelled views.
    Snapshot {
        /// Cursor of the page, from the previous page; `None` for the first page.
        after: Option<SnapshotCursor>,
    },
    /// Read the stored clouds of views.
    Clouds {
        /// Views whose clouds are wanted.
        ids: Vec<ViewId>,
    },
    /// Read the changes of learned views since a history sequence.
    Changes {
        /// Identity of the store to which the sequence `since` belongs.
        #[serde(with = "learning::hex_id")]
        store_id: u128,
        /// Newest sequence that the reader has applied.
        since: u64,
    },
    /// Read-your-writes consistency: the command, answered with knowledge at least as new
    /// as a position of the memory's history.
    ReadAfter {
        /// Store to which the sequence number `sequence` belongs.
        #[serde(with = "learning::hex_id")]
        store_id: u128,
        /// Oldest history sequence that may answer.
        sequence: u64,
        /// Command to answer after that position.
        command: Box<Self>,
    },
}

/// Assignment of a category label to a track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Labelling {
    /// Idempotency key: a repeated id gets the answer of the first request.
    pub id: MutationId,
    /// Author of the label.
    pub author: String,
    /// Track-id of the labelled object.
    pub track_id: u64,
    /// Category name to assign.
    pub category: String,
    /// True to make a new category, even beside one whose name looks alike.
    #[serde(default)]
    pub is_new: bool,
}

/// Reply to a control command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reply {
    /// Reply to [`Command::Objects`].
    Objects(Box<SceneDocument>),
    /// Reply to [`Command::Ask`].
    Object(Box<ObjectDocument>),
    /// Reply to [`Command::Question`].
    Question(QuestionsReport),
    /// Reply to [`Command::Find`].
    Found(Box<FindReport>),
    /// Reply to [`Command::Health`].
    Health(Vec<HealthDocument>),
    /// Reply to [`Command::DepthNoise`].
    DepthNoise(DepthNoiseReport),
    /// Reply to [`Command::ReloadConfiguration`]: the outcome in each process.
    Reloaded(Vec<ReloadReport>),
    /// Reply to teach, correct, forget and revise: the change is on disk.
    Learned(LearningReport),
    /// Reply to [`Command::Memory`].
    Memory(MemoryAnswer),
    /// Reply to [`Command::Job`].
    Job(JobReport),
    /// Reply to [`JobCommand::Read`].
    JobBytes {
        /// Bytes from the requested offset; empty when none are ready yet.
        #[serde(with = "serde_bytes")]
        bytes: Vec<u8>,
    },
    /// Reply to [`Command::Categories`].
    Categories(Vec<CategoryDocument>),
    /// Reply to [`Command::Arm`]: state of the arm after it accepted the command.
    Arm(ArmReport),
    /// Reply to [`Command::Task`].
    Task(Box<TaskReport>),
    /// Reply to [`Command::World`].
    World(WorldReply),
    /// Reply to [`Command::LeaseTrackIds`]: the leased block.
    TrackIds {
        /// First track-id of the leased block; the others follow consecutively.
        first: u64,
    },
    /// Reply to [`Command::StoreViews`]: the views are on disk.
    Stored,
    /// Reply to [`Command::Snapshot`].
    Snapshot(SnapshotPage),
    /// Reply to [`Command::Clouds`]: the clouds of the first of the views, as many as fit into the
    /// message and at least one, encoded by [`pack_cloud`]; an empty one where none is kept.
    Clouds(Vec<serde_bytes::ByteBuf>),
    /// Reply to [`Command::Changes`].
    Changes(ChangesPage),
    /// Refusal: the command was not executed and nothing was changed, except perhaps with
    /// [`RefusalKind::UnknownOutcome`].
    Refused(Refusal),
}

impl Command {
    /// Process that answers the command.
    pub fn owner(&self) -> ProcessKind {
        self.access().owner
    }

    /// Least role that may send the command. A stop of the arm is open to everybody.
    pub fn required_role(&self) -> UserRole {
        self.access().role
    }

    /// True for what is answered before everything else: stop and health.
    pub fn is_urgent(&self) -> bool {
        matches!(self, Self::Arm(ArmCommand::Stop) | Self::Health)
    }

    /// Longest time for which the answer waits for an event.
    pub fn waiting_time(&self) -> Duration {
        match self {
            Self::World(WorldCommand::Events { wait_ms, .. }) => Duration::from_millis(*wait_ms),
            _ => Duration::ZERO,
        }
    }

    /// The command, to be answered with knowledge at least as new as a position of the memory's
    /// history (read-your-writes consistency).
    pub fn read_after(self, store_id: u128, sequence: u64) -> Self {
        Self::ReadAfter {
            store_id,
            sequence,
            command: Box::new(self),
        }
    }

    /// True if only the daemon's own processes may send the command.
    pub fn is_internal(&self) -> bool {
        matches!(
            self,
            Self::Snapshot { .. }
                | Self::Clouds { .. }
                | Self::Changes { .. }
                | Self::ReadAfter { .. }
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_time_is_that_of_a_request_for_events() {
        let events = Command::World(WorldCommand::Events {
            since: 0,
            wait_ms: 30_000,
        });
        assert_eq!(events.waiting_time(), Duration::from_secs(30));
        assert_eq!(Command::Objects.waiting_time(), Duration::ZERO);
    }

    #[test]
    fn read_after_a_position_is_an_internal_command_of_the_same_owner() {
        let stamped = Command::Objects.read_after(7, 9);
        assert_eq!(stamped.owner(), ProcessKind::PERCEPTION);
        assert!(stamped.is_internal());
        let expected = Command::ReadAfter {
            store_id: 7,
            sequence: 9,
            command: Box::new(Command::Objects),
        };
        assert_eq!(stamped, expected);
    }
}
