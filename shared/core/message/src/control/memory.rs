//! What can be asked of the memory besides teaching: looking into it, taking
//! things back, keeping it small, giving it to another robot.

use super::learning::{MutationId, ViewId, hex_id};
use serde::{Deserialize, Serialize};

/// A change of what is known, and who asks for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Revision {
    /// Identity of this mutation: the same id again gets the first answer.
    pub id: MutationId,
    /// Who asks.
    pub author: String,
    /// What is asked.
    pub change: RevisionChange,
}

/// The changes besides teaching.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RevisionChange {
    /// Neither recognise nor teach a track's views any more.
    ForgetTrack {
        /// The track.
        track_id: u64,
    },
    /// Neither recognise nor teach a view any more.
    ForgetView {
        /// The view.
        view: ViewId,
    },
    /// Give one view another name.
    CorrectView {
        /// The view.
        view: ViewId,
        /// Its name.
        category: String,
    },
    /// Give a category another name.
    Rename {
        /// Its name.
        from: String,
        /// Its new name.
        to: String,
    },
    /// Give all views of a category the name of another.
    Merge {
        /// The category that will be no more.
        from: String,
        /// The one that gets its views.
        into: String,
    },
    /// Take back an entry of the history; without one, the author's last lesson.
    Undo {
        /// Sequence of the entry.
        sequence: Option<u64>,
    },
    /// Store a document.
    PutDocument {
        /// Which one.
        document: DocumentName,
        /// How to read it.
        media_type: String,
        /// Its bytes.
        #[serde(with = "serde_bytes")]
        content: Vec<u8>,
    },
    /// Remove a document.
    RemoveDocument {
        /// Which one.
        document: DocumentName,
    },
}

/// Kinds of documents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum DocumentKind {
    /// The fused surface of an object.
    ObjectModel,
    /// Something a task needs to know.
    TaskKnowledge,
}

/// A document's name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DocumentName {
    /// What it is about.
    pub kind: DocumentKind,
    /// Its name.
    pub name: String,
}

/// What can be read in the memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MemoryQuery {
    /// Sizes and counts.
    Stats,
    /// Stored views in order of their ids, a page.
    Views {
        /// Only those of a category.
        category: Option<String>,
        /// Only those of a track.
        track_id: Option<u64>,
        /// Where the last page ended.
        after: Option<ViewId>,
    },
    /// Entries of the history, a page.
    History {
        /// First sequence; without one, so that the page ends with the last entry.
        from: Option<u64>,
        /// Most entries.
        max: u32,
    },
    /// All documents.
    Documents,
    /// A document.
    Document(DocumentName),
}

/// The answer to a [`MemoryQuery`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MemoryAnswer {
    /// To [`MemoryQuery::Stats`].
    Stats(MemoryStats),
    /// To [`MemoryQuery::Views`].
    Views {
        /// The views.
        views: Vec<ViewReport>,
        /// Where the next page begins after; `None` after the last one.
        next: Option<ViewId>,
    },
    /// To [`MemoryQuery::History`].
    History {
        /// The entries, in order.
        entries: Vec<HistoryReport>,
        /// Sequence of the last entry there is.
        last_sequence: u64,
    },
    /// To [`MemoryQuery::Documents`].
    Documents(Vec<DocumentReport>),
    /// To [`MemoryQuery::Document`].
    Document {
        /// How to read it.
        media_type: String,
        /// Its bytes.
        #[serde(with = "serde_bytes")]
        content: Vec<u8>,
    },
}

/// Sizes and counts of a memory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryStats {
    /// Identity of the store: another one after something was lost.
    #[serde(with = "hex_id")]
    pub store_id: u128,
    /// Identity of the memory, which stays.
    #[serde(with = "hex_id")]
    pub memory_id: u128,
    /// The form in which it is stored.
    pub schema: u32,
    /// Sequence of the last history entry.
    pub sequence: u64,
    /// Entries that a damaged store has lost.
    pub n_lost_entries: u64,
    /// Views with a name.
    pub n_named: u64,
    /// Views without one.
    pub n_unnamed: u64,
    /// Views forgotten and not yet removed.
    pub n_forgotten: u64,
    /// Categories.
    pub n_categories: u64,
    /// Documents.
    pub n_documents: u64,
    /// Notes of forgotten views whose content is gone.
    pub n_tombstones: u64,
    /// Bytes of descriptors and clouds.
    pub content_bytes: u64,
    /// Bytes of files.
    pub disk_bytes: u64,
    /// The next track-id to be leased.
    pub next_track_id: u64,
}

/// A stored view, without its content.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewReport {
    /// Its id.
    pub id: ViewId,
    /// What it is an example of; null when nobody has named it.
    pub category: Option<String>,
    /// Who decided that; empty when nobody has.
    pub author: String,
    /// When, nanoseconds since 1970; zero when nobody has.
    pub decided_ns: u64,
    /// The history entry that touched it last.
    pub sequence: u64,
    /// Digest of everything in it: the same on every robot.
    #[serde(with = "hex_id")]
    pub identity: u128,
    /// The memory it was first stored in.
    #[serde(with = "hex_id")]
    pub origin_memory: u128,
    /// Its id there.
    pub origin: ViewId,
    /// When it was captured, nanoseconds since 1970.
    pub captured_ns: u64,
    /// Number of the frame it was seen in.
    pub frame_sequence: u64,
    /// Camera or recording.
    pub source: String,
    /// How its descriptor was made.
    pub descriptor_kind: String,
    /// Centre of the object's box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Full lengths of its sides, metres.
    pub size_m: [f64; 3],
    /// Mean colour; null when not known.
    pub mean_rgb: Option<[u8; 3]>,
    /// Bytes of its descriptor.
    pub descriptor_bytes: u64,
    /// Bytes of its cloud; zero when it has none.
    pub cloud_bytes: u64,
}

/// An entry of the history, in words and numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HistoryReport {
    /// Its number.
    pub sequence: u64,
    /// When, nanoseconds since 1970.
    pub wall_ns: u64,
    /// Who.
    pub author: String,
    /// What was asked, in words.
    pub what: String,
    /// Kind of the operation.
    pub operation: HistoryOperation,
    /// Track that was taught, corrected or forgotten; null for other targets.
    pub track_id: Option<u64>,
    /// View that was corrected or forgotten; null for other targets.
    pub view: Option<ViewId>,
    /// Category that was taught, the new one of a correction, the forgotten or the
    /// pruned one; null for operations without a category.
    pub category: Option<String>,
    /// Category before a correction of a category, a renaming or a merge; null otherwise.
    pub from: Option<String>,
    /// Category after a correction, a renaming or a merge; null otherwise.
    pub to: Option<String>,
    /// Sequence number of the entry that was undone; null for other operations.
    pub undone: Option<u64>,
    /// Document that was stored or removed; null for other operations.
    pub document: Option<DocumentName>,
    /// Source of an import; null for other operations.
    pub source: Option<String>,
    /// Views that it stored, named, forgot or removed.
    pub n_views: u64,
    /// Why it changed nothing, in words; null when it did.
    pub contradiction: Option<String>,
    /// Category that the track keeps because the entry contradicted it; null otherwise.
    pub kept_category: Option<String>,
    /// Author of the kept category; null without one.
    pub kept_author: Option<String>,
    /// The client's id; null for what the store does by itself.
    pub mutation: Option<MutationId>,
    /// Digest of the entry before.
    #[serde(with = "hex_id")]
    pub previous: u128,
}

/// Kind of an operation in the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum HistoryOperation {
    /// Storing of views.
    StoreViews,
    /// Labelling of a track.
    Teach,
    /// Relabelling of a track, a view or a category.
    Correct,
    /// Forgetting of a category, a track or a view.
    Forget,
    /// Renaming of a category.
    Rename,
    /// Merge of two categories.
    Merge,
    /// Undo of an earlier entry.
    Undo,
    /// Import of another memory.
    Import,
    /// Storing of a document.
    PutDocument,
    /// Removal of a document.
    RemoveDocument,
    /// Permanent deletion of forgotten content.
    Purge,
    /// Pruning of views above a retention limit.
    Prune,
    /// Rebuild of a damaged store.
    Rebuild,
    /// Migration from an older schema.
    Migrate,
    /// Operation that this program does not know.
    Other,
}

/// A document, without its content.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DocumentReport {
    /// Which one.
    #[serde(flatten)]
    pub document: DocumentName,
    /// How to read it.
    pub media_type: String,
    /// Its size.
    pub bytes: u64,
    /// Who stored it.
    pub author: String,
    /// When, nanoseconds since 1970.
    pub decided_ns: u64,
    /// The history entry that did.
    pub sequence: u64,
}

/// Long work on the memory, and how it is followed. Only [`Self::Begin`] begins
/// something; a job that nobody asks about for a minute is given up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum JobCommand {
    /// Begin a job.
    Begin(JobKind),
    /// How far is it?
    Ask {
        /// The job.
        job: u64,
    },
    /// The next bytes of an export.
    Read {
        /// The job.
        job: u64,
        /// From where on.
        offset: u64,
    },
    /// The next bytes of an import.
    Write {
        /// The job.
        job: u64,
        /// From where on.
        offset: u64,
        /// The bytes.
        #[serde(with = "serde_bytes")]
        bytes: Vec<u8>,
    },
    /// All bytes of an import are there: take it over.
    Import {
        /// The job.
        job: u64,
        /// Identity of the mutation.
        id: MutationId,
        /// Who asks.
        author: String,
        /// Where it comes from, for the history.
        source: String,
        /// Names to be changed: from, to.
        renames: Vec<(String, String)>,
        /// Put before every other name, so that equal names stay apart.
        prefix: String,
    },
}

/// The kinds of long work.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum JobKind {
    /// Read everything and say what is wrong.
    Verify,
    /// Verify, and make the store anew if something is wrong.
    Repair,
    /// Remove for good what was forgotten some time ago, and merge the files.
    Compact {
        /// How long ago, seconds.
        forgotten_for_s: u64,
    },
    /// Make one file of everything.
    Export,
    /// Take the bytes of a file.
    Import,
}

/// How a job is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobReport {
    /// The job.
    pub job: u64,
    /// How much is done.
    pub done: u64,
    /// Of how much; zero while that is not known.
    pub total: u64,
    /// What came of it; null while it runs.
    pub outcome: Option<JobOutcome>,
}

/// What came of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum JobOutcome {
    /// Of [`JobKind::Verify`].
    Verified(VerificationReport),
    /// Of [`JobKind::Repair`].
    Repaired {
        /// What was wrong.
        verification: VerificationReport,
        /// What was done, in words.
        what: String,
        /// Whether anything that was acknowledged is lost.
        is_loss: bool,
    },
    /// Of [`JobKind::Compact`].
    Compacted {
        /// Views removed for good.
        n_purged: u64,
        /// Bytes of files before.
        disk_bytes_before: u64,
        /// Bytes of files since.
        disk_bytes: u64,
    },
    /// Of [`JobKind::Export`]: all bytes can be read.
    Exported(ExportReport),
    /// Of [`JobKind::Import`].
    Imported(ImportReport),
    /// It could not be done; nothing is lost.
    Failed(String),
}

/// What a whole reading found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct VerificationReport {
    /// The last history entry it is about.
    pub sequence: u64,
    /// History entries, each following the one before.
    pub n_history: u64,
    /// Views of which everything was read.
    pub n_views: u64,
    /// Documents of which everything was read.
    pub n_documents: u64,
    /// Bytes of content.
    pub content_bytes: u64,
    /// Things that are wrong.
    pub n_findings: u64,
    /// The first ones in words.
    pub findings: Vec<String>,
}

/// What an export has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExportReport {
    /// Bytes of the file.
    pub bytes: u64,
    /// Views with their content.
    pub n_views: u64,
    /// Notes of forgotten views.
    pub n_forgotten: u64,
    /// Documents.
    pub n_documents: u64,
    /// The last history entry that it shows.
    pub sequence: u64,
}

/// What an import brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImportReport {
    /// Views in the file.
    pub n_views: u64,
    /// Of them, views that are new or stand for something else since.
    pub n_views_changed: u64,
    /// Documents in the file.
    pub n_documents: u64,
    /// The last history entry about it.
    pub sequence: u64,
}
