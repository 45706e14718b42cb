//! The control plane: what people, scripts and processes ask of each other.
//!
//! One request, one reply, CBOR on the wire; the carriers (shared memory
//! between the daemon's own processes, a Unix socket for everyone else) are in
//! `channel`. All reports are what `--json` prints: `snake_case`, SI units.

mod arm;
mod ignored;
mod learning;
mod memory;
mod packed_cloud;
mod refusal;
mod report;
mod world;

pub use arm::{ArmCommand, ArmReport};
pub use ignored::{AssumptionReport, FindingReport, IgnoredReport};
pub use learning::{
    ChangesPage, LearnedChange, LearnedView, MutationId, SnapshotCursor, SnapshotPage, StoredView,
    ViewId,
};
pub use memory::{
    DocumentKind, DocumentName, DocumentReport, ExportReport, HistoryOperation, HistoryReport,
    ImportReport, JobCommand, JobKind, JobOutcome, JobReport, MemoryAnswer, MemoryQuery, MemoryStats, Revision,
    RevisionChange, VerificationReport, ViewReport,
};
pub use packed_cloud::{InvalidCloud, MAX_CLOUD_POINTS, PackedCloud, pack_cloud};
pub use refusal::{Refusal, RefusalKind};
pub use report::{
    ActorStampsReport, CategoryReport, CovarianceReport, LearningReport, NearCategoryReport,
    ObjectReport, ObjectsReport, ProcessReport,
};
pub use world::{
    EventReport, EventsReport, FactFilter, FactReport, FactsReport, MAX_EVENT_WAIT_MS,
    MAX_PAGE_EVENTS, MAX_PAGE_FACTS, MAX_PAGE_TASKS, PlaceReport, TaskOutcome, TaskReport,
    TasksReport, WorldCommand, WorldObjectReport, WorldRegion, WorldReply, WorldReport,
    WorldRobotReport,
};

use crate::ProcessKind;
use serde::{Deserialize, Serialize};

/// Version of the requests and replies.
pub const PROTOCOL_VERSION: u32 = 2;

/// Longest encoded request or reply, bytes; longer answers come in pages.
pub const MAX_MESSAGE_BYTES: usize = 512 * 1024;

/// A command with the version of its writer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// [`PROTOCOL_VERSION`] of the writer.
    pub protocol: u32,
    /// What is asked.
    pub command: Command,
}

impl From<Command> for Request {
    fn from(command: Command) -> Self {
        Self {
            protocol: PROTOCOL_VERSION,
            command,
        }
    }
}

/// What can be asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Command {
    /// All tracked objects.
    Objects,
    /// One tracked object.
    Ask {
        /// The track.
        track_id: u64,
    },
    /// The processes' health.
    Health,
    /// Label a track that carries no other label.
    Teach(Labelling),
    /// Label a track, whatever label it carries.
    Correct(Labelling),
    /// Forget a category; its views stay, without a label.
    Forget {
        /// Identity of this mutation.
        id: MutationId,
        /// Who asks.
        author: String,
        /// The category.
        category: String,
    },
    /// What has been learned.
    Categories,
    /// Change what is known, besides teaching.
    Revise(Revision),
    /// Look into the memory.
    Memory(MemoryQuery),
    /// Long work on the memory.
    Job(JobCommand),
    /// Something for the arm.
    Arm(ArmCommand),
    /// Something for the working memory.
    World(WorldCommand),
    /// A block of track-ids that nobody else will ever get.
    LeaseTrackIds {
        /// How many.
        count: u32,
    },
    /// Store key views durably; their track-ids are leased by who stores them.
    StoreViews {
        /// Identity of this mutation.
        id: MutationId,
        /// The views.
        views: Vec<StoredView>,
    },
    /// One page of all labelled views.
    Snapshot {
        /// What the last page gave as next; `None` for the first page.
        after: Option<SnapshotCursor>,
    },
    /// What has been learned since a history sequence.
    Changes {
        /// The store whose sequence `since` is.
        #[serde(with = "learning::hex_id")]
        store_id: u128,
        /// The sequence the reader holds.
        since: u64,
    },
}

/// A label for a track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Labelling {
    /// Identity of this mutation: the same id again gets the first answer.
    pub id: MutationId,
    /// Who teaches.
    pub author: String,
    /// The track.
    pub track_id: u64,
    /// The category.
    pub category: String,
}

/// The answer to a command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reply {
    /// To [`Command::Objects`].
    Objects(ObjectsReport),
    /// To [`Command::Ask`].
    Object(Box<ObjectReport>),
    /// To [`Command::Health`].
    Health(Vec<ProcessReport>),
    /// To teach, correct, forget and revise: on disk.
    Learned(LearningReport),
    /// To [`Command::Memory`].
    Memory(MemoryAnswer),
    /// To [`Command::Job`].
    Job(JobReport),
    /// To [`JobCommand::Read`].
    JobBytes {
        /// Bytes from the offset on; empty when there are none yet.
        #[serde(with = "serde_bytes")]
        bytes: Vec<u8>,
    },
    /// To [`Command::Categories`].
    Categories(Vec<CategoryReport>),
    /// To [`Command::Arm`]: how the arm is, now that it has the command.
    Arm(ArmReport),
    /// To [`Command::World`].
    World(Box<WorldReply>),
    /// To [`Command::LeaseTrackIds`]: the first id of the block.
    TrackIds {
        /// The first id; the others follow it.
        first: u64,
    },
    /// To [`Command::StoreViews`]: on disk.
    Stored,
    /// To [`Command::Snapshot`].
    Snapshot(SnapshotPage),
    /// To [`Command::Changes`].
    Changes(ChangesPage),
    /// The command was not carried out, nothing was changed.
    Refused(Refusal),
}

impl Command {
    /// The process that answers the command.
    pub fn owner(&self) -> ProcessKind {
        match self {
            Self::Objects | Self::Ask { .. } => ProcessKind::Perception,
            Self::Arm(_) => ProcessKind::Simulator,
            _ => ProcessKind::Memory,
        }
    }

    /// Whether only the daemon's own processes may send it.
    pub fn is_internal(&self) -> bool {
        matches!(self, Self::Snapshot { .. } | Self::Changes { .. })
    }
}
