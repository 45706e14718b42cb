//! Administration of the perceptual memory: queries, revisions, maintenance jobs, export and
//! import.

use crate::document::{
    ContentDigest, DocumentName, DocumentPage, DocumentReport, DocumentVersionReport, PageRequest,
};
use crate::learning::{MutationId, ViewId, hex_id};
use serde::{Deserialize, Serialize};

/// Revision of the perceptual memory, with its author.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Revision {
    /// Idempotency key: a repeated id gets the answer of the first request.
    pub id: MutationId,
    /// Author of the revision.
    pub author: String,
    /// Change to be made to the memory.
    pub change: RevisionChange,
}

/// Change of the perceptual memory other than teaching.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RevisionChange {
    /// Exclude a track's views from recognition and teaching.
    ForgetTrack {
        /// Track-id whose views are excluded.
        track_id: u64,
    },
    /// Exclude a view from recognition and teaching.
    ForgetView {
        /// Identity of the view to exclude.
        view: ViewId,
    },
    /// Change the category of one view.
    CorrectView {
        /// Identity of the view to relabel.
        view: ViewId,
        /// New category name of the view.
        category: String,
        /// True to make a new category, even beside one whose name looks alike.
        #[serde(default)]
        is_new: bool,
    },
    /// Rename a category.
    Rename {
        /// Current category name.
        from: String,
        /// New category name.
        to: String,
        /// True to accept the new name, even beside one that looks alike.
        #[serde(default)]
        is_new: bool,
    },
    /// Merge a category into another.
    Merge {
        /// Category that ceases to exist.
        from: String,
        /// Category that receives the views.
        into: String,
    },
    /// Undo an entry of the history; without a sequence, the author's last change in effect.
    Undo {
        /// Sequence number of the history entry to undo.
        sequence: Option<u64>,
    },
    /// Redo the change that the author undid last, if the author changed nothing since.
    Redo,
    /// Store a document whose content was uploaded.
    PutDocument {
        /// Name of the document to store.
        document: DocumentName,
        /// Media type (MIME) of the content.
        media_type: String,
        /// Id of the [`JobKind::Document`] job that holds the content.
        upload: u64,
        /// Digest of the whole content.
        digest: ContentDigest,
    },
    /// Remove a document.
    RemoveDocument {
        /// Name of the document to remove.
        document: DocumentName,
    },
}

/// Query of the perceptual memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MemoryQuery {
    /// Report sizes and counts of the memory.
    Stats,
    /// One page of stored views, ordered by id.
    Views {
        /// Category filter of the query.
        category: Option<String>,
        /// Track filter of the query.
        track_id: Option<u64>,
        /// Id of the last view on the previous page.
        after: Option<ViewId>,
    },
    /// One page of the history.
    History {
        /// First sequence; `None` for the page that ends with the last entry.
        from: Option<u64>,
        /// Maximum number of history entries.
        max: u32,
    },
    /// One page of the stored documents, ordered by kind and name.
    Documents {
        /// Last document on the previous page.
        after: Option<DocumentName>,
    },
    /// One page of the content of a document.
    Document(PageRequest),
    /// List the versions of a document that the memory keeps, oldest first.
    DocumentVersions(DocumentName),
}

/// Answer to a [`MemoryQuery`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MemoryAnswer {
    /// Reply to [`MemoryQuery::Stats`].
    Stats(MemoryStats),
    /// Reply to [`MemoryQuery::Views`].
    Views {
        /// Views of the page.
        views: Vec<ViewReport>,
        /// Last view of this page, for the next request; `None` after the last page.
        next: Option<ViewId>,
    },
    /// Reply to [`MemoryQuery::History`].
    History {
        /// History entries of the page, oldest first.
        entries: Vec<HistoryReport>,
        /// Sequence of the last entry of the history.
        last_sequence: u64,
    },
    /// Reply to [`MemoryQuery::Documents`].
    Documents {
        /// Documents of the page.
        documents: Vec<DocumentReport>,
        /// Last document of this page, for the next request; `None` after the last page.
        next: Option<DocumentName>,
    },
    /// Reply to [`MemoryQuery::Document`].
    Document(DocumentPage),
    /// Reply to [`MemoryQuery::DocumentVersions`].
    DocumentVersions(Vec<DocumentVersionReport>),
}

/// Sizes and counts of a perceptual memory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryStats {
    /// Identity of the store; it changes after a loss of data.
    #[serde(with = "hex_id")]
    pub store_id: u128,
    /// Identity of the memory; it never changes.
    #[serde(with = "hex_id")]
    pub memory_id: u128,
    /// Schema version of the storage format.
    pub schema: u32,
    /// Sequence of the last history entry.
    pub sequence: u64,
    /// Number of history entries lost from a damaged store.
    pub n_lost_entries: u64,
    /// Number of labelled views.
    pub n_named: u64,
    /// Number of unlabelled views.
    pub n_unnamed: u64,
    /// Number of forgotten views that are not purged yet.
    pub n_forgotten: u64,
    /// Number of categories.
    pub n_categories: u64,
    /// Number of stored documents.
    pub n_documents: u64,
    /// Number of tombstones: forgotten views whose content is purged.
    pub n_tombstones: u64,
    /// Size of all descriptors and point clouds, bytes.
    pub content_bytes: u64,
    /// Size of the database files, bytes.
    pub disk_bytes: u64,
    /// Next track-id to be leased.
    pub next_track_id: u64,
    /// Number of history entries in the archive.
    #[serde(default)]
    pub n_archived_entries: u64,
    /// Number of the oldest history entries that were dropped for the limit of the archive.
    #[serde(default)]
    pub n_dropped_entries: u64,
    /// Size of the archived history, bytes.
    #[serde(default)]
    pub archive_bytes: u64,
    /// Size of damaged databases that were set aside, bytes.
    #[serde(default)]
    pub damaged_bytes: u64,
    /// Forecast of the size of database and archive in a year, bytes; null on the first day.
    #[serde(default)]
    pub bytes_in_a_year: Option<u64>,
}

/// Metadata of a stored view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewReport {
    /// Identity of the view.
    pub id: ViewId,
    /// Category name; null for an unlabelled view.
    pub category: Option<String>,
    /// Author of the label; empty for an unlabelled view.
    pub author: String,
    /// Time of the label, nanoseconds since 1970; 0 for an unlabelled view.
    pub decided_ns: u64,
    /// Sequence of the last history entry that changed the view.
    pub sequence: u64,
    /// Content digest of the view; equal on every robot.
    #[serde(with = "hex_id")]
    pub identity: u128,
    /// Identity of the memory that first stored the view.
    #[serde(with = "hex_id")]
    pub origin_memory: u128,
    /// Id of the view in the memory that first stored it.
    pub origin: ViewId,
    /// Capture time of the view, nanoseconds since 1970.
    pub captured_ns: u64,
    /// Sequence number of the captured frame.
    pub frame_sequence: u64,
    /// Name of the camera or recording.
    pub source: String,
    /// Kind of the descriptor: its method and version.
    pub descriptor_kind: String,
    /// Centre of the object's box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the object's box, metres.
    pub size_m: [f64; 3],
    /// Mean colour: red, green, blue; null when unknown.
    pub mean_rgb: Option<[u8; 3]>,
    /// Size of the descriptor, bytes.
    pub descriptor_bytes: u64,
    /// Size of the cloud, bytes; 0 without a cloud.
    pub cloud_bytes: u64,
}

/// Entry of the history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HistoryReport {
    /// Sequence number of the history entry.
    pub sequence: u64,
    /// Time of the history entry, nanoseconds since 1970.
    pub wall_ns: u64,
    /// Author of the history entry, as its client claimed.
    pub author: String,
    /// User id of the client, as the kernel says; null for maintenance by the store itself and
    /// for entries of older versions.
    #[serde(default)]
    pub uid: Option<u32>,
    /// Requested change of the memory, in words.
    pub what: String,
    /// Kind of the operation that the entry records.
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
    /// Sequence number of the change that is in effect again, if the entry undid an undo of it;
    /// null for other operations.
    #[serde(default)]
    pub redone: Option<u64>,
    /// Document that was stored or removed; null for other operations.
    pub document: Option<DocumentName>,
    /// Source of an import; null for other operations.
    pub source: Option<String>,
    /// Number of views that were stored, labelled, forgotten or purged.
    pub n_views: u64,
    /// Reason why nothing was changed, in words; null for an effective entry.
    pub contradiction: Option<String>,
    /// Category that the track keeps because the entry contradicted it; null otherwise.
    pub kept_category: Option<String>,
    /// Author of the kept category; null without one.
    pub kept_author: Option<String>,
    /// Idempotency key of the client; null for maintenance by the store itself.
    pub mutation: Option<MutationId>,
    /// Digest of the previous entry (hash chain).
    #[serde(with = "hex_id")]
    pub previous: u128,
}

/// Kind of an operation in the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum HistoryOperation {
    /// Storing of key views.
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
    /// Undo of an earlier history entry.
    Undo,
    /// Import of the export of another memory.
    Import,
    /// Storing of a document.
    PutDocument,
    /// Removal of a document.
    RemoveDocument,
    /// Permanent deletion of forgotten views.
    Purge,
    /// Pruning of views above a retention limit.
    Prune,
    /// Rebuild of a damaged store from its intact records.
    Rebuild,
    /// Migration of the store from an older schema.
    Migrate,
    /// Operation that this program does not know.
    Other,
}

/// Command for a long-running job on the perceptual memory. Only [`Self::Begin`] starts a job;
/// a job without requests for a minute is abandoned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobCommand {
    /// Start a job on the memory.
    Begin(JobKind),
    /// Report the progress of a job.
    Ask {
        /// Id of the job to report.
        job: u64,
    },
    /// Read the next bytes of an export.
    Read {
        /// Id of the export job.
        job: u64,
        /// Offset in the exported file of the first byte to read.
        offset: u64,
    },
    /// Write the next bytes of an import or of a document.
    Write {
        /// Id of the job with the upload.
        job: u64,
        /// Offset in the uploaded file of the first byte sent.
        offset: u64,
        /// Bytes of the uploaded file.
        #[serde(with = "serde_bytes")]
        bytes: Vec<u8>,
    },
    /// Complete an import whose bytes are all written.
    Import(ImportCompletion),
}

/// Completion of an import: what to do with the uploaded file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ImportCompletion {
    /// Id of the import job.
    pub job: u64,
    /// Idempotency key of the mutation.
    pub id: MutationId,
    /// Author of the import.
    pub author: String,
    /// Source of the import, for the history.
    pub source: String,
    /// Categories to rename on import, as pairs: from, to.
    pub renames: Vec<(String, String)>,
    /// Prefix for all other category names, to keep equal names apart.
    pub prefix: String,
    /// True to make new categories, even beside ones whose names look alike.
    #[serde(default)]
    pub is_new: bool,
    /// Decisions from too far ahead of this clock get the present time; false leaves them
    /// out.
    #[serde(default)]
    pub restamp: bool,
}

/// Kind of a long-running job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobKind {
    /// Verify the integrity of the whole store.
    Verify,
    /// Verify, and rebuild the store if it is damaged.
    Repair,
    /// Purge views forgotten some time ago, and compact the files.
    Compact {
        /// Minimum time since a view was forgotten, seconds.
        forgotten_for_s: u64,
    },
    /// Export the whole memory to one file.
    Export,
    /// Import an exported file.
    Import,
    /// Upload of the content of a document, which [`RevisionChange::PutDocument`] stores.
    Document,
}

/// Progress and outcome of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobReport {
    /// Id of the reported job.
    pub job: u64,
    /// Completed units of work of the job.
    pub done: u64,
    /// Total units of work; 0 while unknown.
    pub total: u64,
    /// Outcome of the job; null while it runs.
    pub outcome: Option<JobOutcome>,
}

/// Outcome of a finished job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum JobOutcome {
    /// Result of [`JobKind::Verify`].
    Verified(VerificationReport),
    /// Result of [`JobKind::Repair`].
    Repaired {
        /// Verification result before the repair.
        verification: VerificationReport,
        /// Description of the repair, in words.
        what: String,
        /// True if the repair lost acknowledged data.
        is_loss: bool,
    },
    /// Result of [`JobKind::Compact`].
    Compacted {
        /// Number of permanently purged views.
        n_purged: u64,
        /// Size of the database files before compaction, bytes.
        disk_bytes_before: u64,
        /// Size of the database files after compaction, bytes.
        disk_bytes: u64,
    },
    /// Result of [`JobKind::Export`]; all bytes can be read.
    Exported(ExportReport),
    /// Result of [`JobKind::Import`].
    Imported(ImportReport),
    /// Job failed, with the reason; no data was lost.
    Failed(String),
}

/// Result of a verification of the whole store.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct VerificationReport {
    /// Sequence number of the last verified history entry.
    pub sequence: u64,
    /// Number of history entries in an unbroken hash chain.
    pub n_history: u64,
    /// Number of views read completely during verification.
    pub n_views: u64,
    /// Number of documents read completely during verification.
    pub n_documents: u64,
    /// Size of the verified content, bytes.
    pub content_bytes: u64,
    /// Number of integrity errors found.
    pub n_findings: u64,
    /// Descriptions of the first integrity errors found.
    pub findings: Vec<String>,
}

/// Contents of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExportReport {
    /// Size of the exported file, bytes.
    pub bytes: u64,
    /// Number of exported views with content.
    pub n_views: u64,
    /// Number of exported tombstones.
    pub n_forgotten: u64,
    /// Number of exported documents.
    pub n_documents: u64,
    /// Sequence of the last exported history entry.
    pub sequence: u64,
}

/// Result of an import.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImportReport {
    /// Number of views in the imported file.
    pub n_views: u64,
    /// Number of views that are new or changed their category.
    pub n_views_changed: u64,
    /// Number of documents in the imported file.
    pub n_documents: u64,
    /// Sequence of the last history entry of the import.
    pub sequence: u64,
    /// Number of views and documents that were left out, because their decision is from too far
    /// ahead of this clock.
    #[serde(default)]
    pub n_left_out: u64,
    /// Number of such views and documents that were imported with the present time instead.
    #[serde(default)]
    pub n_restamped: u64,
    /// The first of these views and documents.
    #[serde(default)]
    pub ahead: Vec<AheadDecision>,
}

/// Decision of another memory from too far ahead of this clock.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AheadDecision {
    /// View or document that was decided, in words.
    pub what: String,
    /// Author of the decision.
    pub author: String,
    /// Time of the decision, nanoseconds since 1970.
    pub decided_ns: u64,
}
