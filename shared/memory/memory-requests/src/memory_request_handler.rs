//! Request handler for all commands about the perceptual memory.

use crate::document_pages::ContentCache;
use crate::document_storing::{DocumentStoring, UploadedDocument};
use crate::job_context::JobContext;
use crate::jobs::{ABANDON_AFTER, Jobs};
use crate::revision::allowing_alike;
use crate::store_client::{By, StoreClient};
use crate::upload::UploadLimits;
use crate::{change_text, queries, revision, translate};
use control_protocol::{
    Command, Labelling, MemoryQuery, Refusal, Reply, Revision, RevisionChange, SnapshotCursor,
};
use learning::{CategoryName, ViewId};
use parking_lot::Mutex;
use perceptual_memory::{
    Digest, Error, Operation, PerceptualMemory, Position, Requester, StoreChange, StoreHandle,
    Target,
};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;

/// Maximum size of the descriptors on a page, bytes; the rest of the message needs room too.
const PAGE_BYTES: usize = control_protocol::MAX_MESSAGE_BYTES / 2;
/// Most bytes of the clouds of one answer, unless a single one is larger.
const CLOUD_BYTES: usize = control_protocol::MAX_MESSAGE_BYTES / 2;
/// Maximum size of the descriptors of a change feed message, bytes.
const MAX_CHANGES_BYTES: usize = control_protocol::MAX_MESSAGE_BYTES / 4 * 3;

/// Period in which abandoned jobs are ended.
const EXPIRY_PERIOD: Duration = Duration::from_secs(1);

/// Configuration of a request handler.
pub struct MemoryRequestHandlerConfig {
    /// Handle of the perceptual memory's store thread.
    pub store: StoreHandle,
    /// Folder for the files of uploads.
    pub scratch: PathBuf,
    /// Limits of these files.
    pub uploads: UploadLimits,
    /// Descriptor kind of this robot; views of other kinds are not imported.
    pub descriptor_kind: &'static str,
}

/// Request handler of the perceptual memory.
pub struct MemoryRequestHandler {
    store: StoreClient,
    jobs: Arc<Jobs>,
    documents: DocumentStoring,
    contents: Arc<ContentCache>,
    uploads: Arc<Mutex<UploadLimits>>,
}

impl MemoryRequestHandler {
    /// Request handler, and a channel with its history position.
    pub fn new(config: MemoryRequestHandlerConfig) -> (Self, watch::Receiver<Position>) {
        let (position, positions) = watch::channel(config.store.position());
        let uploads = Arc::new(Mutex::new(config.uploads));
        let jobs = Arc::new(Jobs::new(JobContext {
            store: config.store.clone(),
            scratch: config.scratch,
            uploads: Arc::clone(&uploads),
            descriptor_kind: config.descriptor_kind,
            position: position.clone(),
        }));
        let store = StoreClient {
            store: config.store,
            position,
        };
        let handler = Self {
            documents: DocumentStoring::new(store.clone(), Arc::clone(&jobs)),
            store,
            jobs,
            contents: Arc::default(),
            uploads,
        };
        (handler, positions)
    }

    /// Replaces the limits of the files of uploads, from the next upload of bytes on.
    pub fn set_upload_limits(&self, limits: UploadLimits) {
        *self.uploads.lock() = limits;
    }

    /// Ends jobs whose clients have gone, and frees contents that nobody reads any more, until the
    /// future is dropped.
    pub async fn expire_jobs(&self) {
        loop {
            tokio::time::sleep(EXPIRY_PERIOD).await;
            self.jobs.end_abandoned(ABANDON_AFTER);
            self.contents.free_unused(ABANDON_AFTER);
        }
    }

    /// Answers a command of a user; `None` for a command that is not about the memory.
    pub async fn answer(
        &self,
        command: Command,
        user: Requester,
    ) -> Option<Result<Reply, Refusal>> {
        Some(match command {
            Command::Teach(label) => {
                let teach = |track_id, category| StoreChange::Teach { track_id, category };
                self.label(label, user, teach).await
            }
            Command::Correct(label) => {
                let correct = |track_id, category| StoreChange::Correct {
                    target: Target::Track(track_id),
                    category,
                };
                self.label(label, user, correct).await
            }
            Command::Forget {
                id,
                author,
                category,
            } => self.forget(By { id, author, user }, &category).await,
            Command::Revise(revision) => self.revise(revision, user).await,
            Command::Categories => {
                let summaries = self.store.read(|memory| Ok(memory.categories())).await;
                summaries.map(|summaries| {
                    Reply::Categories(summaries.iter().map(translate::category_report).collect())
                })
            }
            Command::Memory(query) => self.query(query).await,
            Command::Job(job) => self.jobs.answer(job, user).await,
            other => return self.answer_perception(other, user).await,
        })
    }

    /// Answers the commands of perception.
    async fn answer_perception(
        &self,
        command: Command,
        user: Requester,
    ) -> Option<Result<Reply, Refusal>> {
        Some(match command {
            Command::LeaseTrackIds { count } => {
                let leased = self.store.lease_track_ids(u64::from(count)).await;
                leased.map(|first| Reply::TrackIds { first })
            }
            Command::StoreViews { id, views } => match translate::store_views(views) {
                Ok(change) => {
                    let author = "perception".into();
                    let stored = self.store.mutate(By { id, author, user }, change).await;
                    stored.map(|_| Reply::Stored)
                }
                Err(refusal) => Err(refusal),
            },
            Command::Snapshot { after } => {
                let cursor = after.map(|SnapshotCursor(digest)| Digest(digest));
                let read = move |memory: &mut PerceptualMemory| memory.snapshot(cursor, PAGE_BYTES);
                let page = self.store.read(read).await;
                page.map(|page| Reply::Snapshot(translate::snapshot(page)))
            }
            Command::Clouds { ids } => {
                let views: Vec<ViewId> = ids.into_iter().map(translate::local_id).collect();
                let read = move |memory: &mut PerceptualMemory| memory.clouds(&views, CLOUD_BYTES);
                let clouds = self.store.read(read).await;
                clouds.map(|clouds| {
                    Reply::Clouds(clouds.into_iter().map(serde_bytes::ByteBuf::from).collect())
                })
            }
            Command::Changes { store_id, since } => {
                let position = Position {
                    store_id: perceptual_memory::StoreId(store_id),
                    sequence: since,
                };
                let read =
                    move |memory: &mut PerceptualMemory| memory.changes(position, PAGE_BYTES);
                self.store.read(read).await.map(|changes| {
                    Reply::Changes(translate::changes(since, changes, MAX_CHANGES_BYTES))
                })
            }
            _ => return None,
        })
    }

    async fn query(&self, query: MemoryQuery) -> Result<Reply, Refusal> {
        let contents = Arc::clone(&self.contents);
        let answer = move |memory: &mut PerceptualMemory| queries::answer(memory, &contents, query);
        self.store.read(answer).await?.map(Reply::Memory)
    }

    async fn label(
        &self,
        label: Labelling,
        user: Requester,
        change: impl FnOnce(u64, CategoryName) -> StoreChange,
    ) -> Result<Reply, Refusal> {
        let Labelling {
            id,
            author,
            track_id,
            category,
            is_new,
        } = label;
        let category = translate::category(&category)?;
        let change = allowing_alike(is_new, change(track_id, category.clone()));
        self.store
            .apply(By { id, author, user }, change, category.as_str())
            .await
    }

    async fn forget(&self, by: By, category: &str) -> Result<Reply, Refusal> {
        let name = translate::category(category)?;
        let change = StoreChange::Forget(Target::Category(name.clone()));
        self.store.apply(by, change, name.as_str()).await
    }

    async fn revise(&self, revision: Revision, user: Requester) -> Result<Reply, Refusal> {
        let Revision { id, author, change } = revision;
        let by = By { id, author, user };
        let change = match change {
            RevisionChange::PutDocument {
                document,
                media_type,
                upload,
                digest,
            } => {
                let uploaded = UploadedDocument {
                    document,
                    media_type,
                    upload,
                    digest,
                };
                return self.documents.store(by, uploaded).await;
            }
            change => change,
        };
        let (change, about) = revision::change(change)?;
        let is_redo = matches!(change, StoreChange::Redo);
        let is_reversal = is_redo || matches!(change, StoreChange::Undo { .. });
        let mut reply = self.store.apply(by, change, &about).await?;
        if is_reversal && let Reply::Learned(report) = &mut reply {
            let sequence = report.sequence;
            let read = move |memory: &mut PerceptualMemory| reversed(memory, sequence, is_redo);
            report.category = self.store.read(read).await?;
        }
        Ok(reply)
    }
}

/// Description of the operation that an entry undid or redid.
fn reversed(memory: &mut PerceptualMemory, sequence: u64, is_redo: bool) -> Result<String, Error> {
    let entry = memory.history(sequence, 1)?;
    let reversed = match entry.first().map(|entry| &entry.operation) {
        Some(Operation::Undo {
            redone: Some(redone),
            ..
        }) if is_redo => *redone,
        Some(Operation::Undo { sequence, .. }) => *sequence,
        _ => return Ok(String::new()),
    };
    let entry = memory.history(reversed, 1)?;
    let what = entry
        .first()
        .map(|entry| change_text::describe_operation(&entry.operation));
    Ok(what.unwrap_or_default())
}
