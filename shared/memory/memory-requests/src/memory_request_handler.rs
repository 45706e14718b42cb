//! Request handler for all commands about the perceptual memory.

use crate::job_context::{JobContext, publish_position, wall_ns};
use crate::jobs::Jobs;
use crate::upload::UploadLimits;
use crate::{change_text, queries, revision, translate};
use learning::{CategoryName, ViewId};
use message::control::{
    Command, Labelling, LearningReport, MutationId, Refusal, RefusalKind, Reply, Revision,
    SnapshotCursor,
};
use parking_lot::Mutex;
use perceptual_memory::{
    Digest, Error, Mutation, MutationReceipt, Operation, PerceptualMemory, Position, Requester,
    StoreChange, StoreHandle, Target,
};
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{oneshot, watch};

/// Maximum size of the descriptors on a page, bytes; the rest of the message needs room too.
const PAGE_BYTES: usize = message::control::MAX_MESSAGE_BYTES / 2;
/// Most bytes of the clouds of one answer, unless a single one is larger.
const CLOUD_BYTES: usize = message::control::MAX_MESSAGE_BYTES / 2;
/// Maximum size of the descriptors of a change feed message, bytes.
const MAX_CHANGES_BYTES: usize = message::control::MAX_MESSAGE_BYTES / 4 * 3;

/// Configuration of a request handler.
pub struct MemoryRequestHandlerConfig {
    /// Handle of the perceptual memory's store thread.
    pub store: StoreHandle,
    /// Folder for the upload files of imports.
    pub scratch: PathBuf,
    /// Limits of these files.
    pub uploads: UploadLimits,
    /// Descriptor kind of this robot; views of other kinds are not imported.
    pub descriptor_kind: &'static str,
}

/// Origin of a change: its key, its claimed author, and the user as the kernel says.
struct By {
    id: MutationId,
    author: String,
    user: Requester,
}

/// Request handler of the perceptual memory.
pub struct MemoryRequestHandler {
    store: StoreHandle,
    jobs: Jobs,
    uploads: Arc<Mutex<UploadLimits>>,
    position: watch::Sender<Position>,
}

impl MemoryRequestHandler {
    /// Request handler, and a channel with its history position.
    pub fn new(config: MemoryRequestHandlerConfig) -> (Self, watch::Receiver<Position>) {
        let (position, positions) = watch::channel(config.store.position());
        let uploads = Arc::new(Mutex::new(config.uploads));
        let desk = Self {
            store: config.store.clone(),
            jobs: Jobs::new(JobContext {
                store: config.store,
                scratch: config.scratch,
                uploads: Arc::clone(&uploads),
                descriptor_kind: config.descriptor_kind,
                position: position.clone(),
            }),
            uploads,
            position,
        };
        (desk, positions)
    }

    /// Replaces the limits of the files of imports, from the next upload of bytes on.
    pub fn set_upload_limits(&self, limits: UploadLimits) {
        *self.uploads.lock() = limits;
    }

    /// Ends jobs whose clients have gone, until the future is dropped.
    pub async fn expire_jobs(&self) {
        self.jobs.expire().await;
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
                let summaries = self.read(|memory| Ok(memory.categories())).await;
                summaries.map(|summaries| {
                    Reply::Categories(summaries.iter().map(translate::category_report).collect())
                })
            }
            Command::Memory(query) => {
                let answer = move |memory: &mut PerceptualMemory| queries::answer(memory, query);
                match self.read(answer).await {
                    Ok(answer) => answer.map(Reply::Memory),
                    Err(refusal) => Err(refusal),
                }
            }
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
                let lease = |reply: ReplySender<u64>| {
                    self.store
                        .lease_track_ids(u64::from(count), |first| reply.send(first));
                };
                let leased = wait(lease).await;
                leased
                    .map(|first| Reply::TrackIds { first })
                    .map_err(|error| translate::refusal(&error))
            }
            Command::StoreViews { id, views } => match translate::store_views(views) {
                Ok(change) => {
                    let author = "perception".into();
                    let stored = self.mutate(By { id, author, user }, change).await;
                    stored.map(|_| Reply::Stored)
                }
                Err(refusal) => Err(refusal),
            },
            Command::Snapshot { after } => {
                let cursor = after.map(|SnapshotCursor(digest)| Digest(digest));
                let read = move |memory: &mut PerceptualMemory| memory.snapshot(cursor, PAGE_BYTES);
                let page = self.read(read).await;
                page.map(|page| Reply::Snapshot(translate::snapshot(page)))
            }
            Command::Clouds { ids } => {
                let views: Vec<ViewId> = ids.into_iter().map(translate::local_id).collect();
                let read = move |memory: &mut PerceptualMemory| memory.clouds(&views, CLOUD_BYTES);
                let clouds = self.read(read).await;
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
                self.read(read).await.map(|changes| {
                    Reply::Changes(translate::changes(since, changes, MAX_CHANGES_BYTES))
                })
            }
            _ => return None,
        })
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
        } = label;
        let category = translate::category(&category)?;
        let change = change(track_id, category.clone());
        self.apply_teaching(By { id, author, user }, change, category.as_str())
            .await
    }

    async fn forget(&self, by: By, category: &str) -> Result<Reply, Refusal> {
        let name = translate::category(category)?;
        let change = StoreChange::Forget(Target::Category(name.clone()));
        self.apply_teaching(by, change, name.as_str()).await
    }

    async fn revise(&self, revision: Revision, user: Requester) -> Result<Reply, Refusal> {
        let Revision { id, author, change } = revision;
        let (change, about) = revision::change(change)?;
        let is_undo = matches!(change, StoreChange::Undo { .. });
        let by = By { id, author, user };
        let mut reply = self.apply_teaching(by, change, &about).await?;
        if is_undo && let Reply::Learned(report) = &mut reply {
            let sequence = report.sequence;
            report.category = self.read(move |memory| undone(memory, sequence)).await?;
        }
        Ok(reply)
    }

    /// Applies a change by a user and reports a contradicted label as a conflict.
    async fn apply_teaching(
        &self,
        by: By,
        change: StoreChange,
        about: &str,
    ) -> Result<Reply, Refusal> {
        let what = change_text::describe_change(&change);
        let MutationReceipt {
            sequence,
            n_views,
            contradiction,
        } = self.mutate(by, change).await?;
        if let Some(contradiction) = contradiction {
            tracing::info!("{what}: contradicted, history {sequence}");
            let sentence = change_text::describe_contradiction(&what, &contradiction, sequence);
            return Err(Refusal::new(RefusalKind::Conflict, sentence));
        }
        tracing::info!("{what}: {n_views} view(s) changed, history {sequence}");
        Ok(Reply::Learned(LearningReport {
            sequence,
            category: about.to_owned(),
            n_views_changed: n_views,
        }))
    }

    /// Applies a mutation, publishes the new position, and answers once it is on disk.
    async fn mutate(&self, by: By, change: StoreChange) -> Result<MutationReceipt, Refusal> {
        let mutation = Mutation {
            id: perceptual_memory::MutationId(by.id.0),
            author: by.author,
            requester: by.user,
            wall_ns: wall_ns(),
            change,
        };
        let ask = |reply: ReplySender<MutationReceipt>| {
            self.store.mutate(mutation, |done| reply.send(done));
        };
        let changed = wait(ask).await;
        let answer = changed.map_err(|error| translate::change_refusal(&error))?;
        publish_position(&self.position, self.store.position());
        Ok(answer)
    }

    async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&mut PerceptualMemory) -> Result<T, Error> + Send + 'static,
    ) -> Result<T, Refusal> {
        let answer = wait(|reply: ReplySender<T>| self.store.read(read, |done| reply.send(done)));
        answer.await.map_err(|error| translate::refusal(&error))
    }
}

/// Description of the operation that an undo entry reverted.
fn undone(memory: &mut PerceptualMemory, sequence: u64) -> Result<String, Error> {
    let entry = memory.history(sequence, 1)?;
    let Some(Operation::Undo { sequence }) = entry.first().map(|entry| &entry.operation) else {
        return Ok(String::new());
    };
    let undone = memory.history(*sequence, 1)?;
    let what = undone
        .first()
        .map(|entry| change_text::describe_operation(&entry.operation));
    Ok(what.unwrap_or_default())
}

/// Channel from the store thread to the waiting task.
struct ReplySender<T>(oneshot::Sender<Result<T, Error>>);

impl<T> ReplySender<T> {
    fn send(self, answer: Result<T, Error>) {
        // The requester may have gone; the mutation is done all the same.
        let _ = self.0.send(answer);
    }
}

async fn wait<T>(ask: impl FnOnce(ReplySender<T>)) -> Result<T, Error> {
    let (sender, answer) = oneshot::channel();
    ask(ReplySender(sender));
    answer.await.unwrap_or(Err(Error::Stopped))
}
