//! What the memory answers to each command.

use crate::event_report;
use crate::process_table::ProcessTable;
use crate::translate;
use crate::world::{World, now_ns};
use channel::control::Client;
use learning::{CategoryName, ViewId};
use message::ProcessKind;
use message::control::{
    Command, Labelling, LearningReport, MAX_MESSAGE_BYTES, MutationId, Refusal, RefusalKind, Reply,
    ViewId as WireViewId,
};
use service::wall_clock_ns;
use std::sync::Arc;
use std::time::Duration;
use store::{Answer, Change, Error, Mutation, PerceptualMemory, Position, StoreHandle};
use tokio::sync::{oneshot, watch};

/// How long another process may take to answer.
const DEADLINE: Duration = Duration::from_secs(2);
/// Descriptors in a page; the rest of the message needs room, too.
const PAGE_BYTES: usize = MAX_MESSAGE_BYTES / 2;

/// Descriptors of changes that still fit one message with everything around them.
const MAX_CHANGES_BYTES: usize = MAX_MESSAGE_BYTES / 4 * 3;

/// Answers every command: its own from the store, others by asking their owner.
pub(crate) struct Answerer {
    pub(crate) store: StoreHandle,
    pub(crate) perception: Client,
    pub(crate) arm: Client,
    pub(crate) processes: Arc<ProcessTable>,
    pub(crate) position: watch::Sender<Position>,
    pub(crate) world: Arc<World>,
}

impl Answerer {
    /// The answer, or the refusal that says why there is none.
    pub(crate) async fn answer(&self, command: Command) -> Reply {
        self.try_answer(command)
            .await
            .unwrap_or_else(Reply::Refused)
    }

    async fn try_answer(&self, command: Command) -> Result<Reply, Refusal> {
        match command.owner() {
            ProcessKind::Perception => return ask(&self.perception, command).await,
            ProcessKind::Simulator => return ask(&self.arm, command).await,
            ProcessKind::Memory | ProcessKind::Camera => {}
        }
        match command {
            Command::Health => Ok(Reply::Health(self.processes.reports())),
            Command::Teach(label) => {
                self.label(label, |track_id, category| Change::Teach {
                    track_id,
                    category,
                })
                .await
            }
            Command::Correct(label) => {
                self.label(label, |track_id, category| Change::Correct {
                    track_id,
                    category,
                })
                .await
            }
            Command::Forget {
                id,
                author,
                category,
            } => {
                let name = translate::category(&category)?;
                let change = Change::Forget {
                    category: name.clone(),
                };
                self.learn(id, author, change, name.as_str()).await
            }
            Command::Categories => {
                let summaries = self.read(|memory| Ok(memory.categories())).await?;
                Ok(Reply::Categories(
                    summaries.iter().map(translate::category_report).collect(),
                ))
            }
            Command::World(command) => self.world.answer(command).await,
            other => self.try_answer_internal(other).await,
        }
    }

    async fn try_answer_internal(&self, command: Command) -> Result<Reply, Refusal> {
        match command {
            Command::LeaseTrackIds { count } => {
                let lease = |reply: Reporter<u64>| {
                    self.store
                        .lease_track_ids(u64::from(count), |first| reply.send(first));
                };
                Ok(Reply::TrackIds {
                    first: wait(lease).await?,
                })
            }
            Command::StoreViews { id, views } => {
                self.mutate(id, "perception".into(), translate::store_views(views)?)
                    .await?;
                Ok(Reply::Stored)
            }
            Command::Snapshot { after } => {
                let cursor =
                    after.map(|WireViewId { track_id, view_id }| ViewId { track_id, view_id });
                let page = self
                    .read(move |memory| memory.snapshot(cursor, PAGE_BYTES))
                    .await?;
                Ok(Reply::Snapshot(translate::snapshot(page)))
            }
            Command::Changes { store_id, since } => {
                let position = Position {
                    store_id: store::StoreId(store_id),
                    sequence: since,
                };
                let changes = self
                    .read(move |memory| memory.changes(position, PAGE_BYTES))
                    .await?;
                Ok(Reply::Changes(translate::changes(
                    since,
                    changes,
                    MAX_CHANGES_BYTES,
                )))
            }
            other => Err(Refusal::new(
                RefusalKind::Internal,
                format!("tabula-memory does not answer {other:?}"),
            )),
        }
    }

    async fn label(
        &self,
        label: Labelling,
        change: impl FnOnce(u64, CategoryName) -> Change,
    ) -> Result<Reply, Refusal> {
        let Labelling {
            id,
            author,
            track_id,
            category,
        } = label;
        let category = translate::category(&category)?;
        let change = change(track_id, category.clone());
        self.learn(id, author, change, category.as_str()).await
    }

    async fn learn(
        &self,
        id: MutationId,
        author: String,
        change: Change,
        category: &str,
    ) -> Result<Reply, Refusal> {
        let what = what(&change);
        let lesson = event_report::lesson(&change, category, &author);
        let Answer { sequence, n_views } = self.mutate(id, author, change).await?;
        if let Some(lesson) = lesson.filter(|_| n_views > 0) {
            self.world
                .with(|model| model.note_lesson(lesson(sequence), now_ns()));
        }
        tracing::info!("{what} {category:?}: {n_views} view(s) changed, history {sequence}");
        Ok(Reply::Learned(LearningReport {
            sequence,
            category: category.to_owned(),
            n_views_changed: n_views,
        }))
    }

    /// Changes the store and announces it; answered when it is on disk.
    async fn mutate(
        &self,
        id: MutationId,
        author: String,
        change: Change,
    ) -> Result<Answer, Refusal> {
        let wall_ns = wall_clock_ns().max(0) as u64;
        let id = store::MutationId(id.0);
        let mutation = Mutation {
            id,
            author,
            wall_ns,
            change,
        };
        let ask = |reply: Reporter<Answer>| self.store.mutate(mutation, |done| reply.send(done));
        let answer = wait(ask).await?;
        let position = self.read(|memory| Ok(memory.position())).await?;
        self.position.send_if_modified(|known| {
            let is_news = *known != position;
            *known = position;
            is_news
        });
        Ok(answer)
    }

    async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&mut PerceptualMemory) -> Result<T, Error> + Send + 'static,
    ) -> Result<T, Refusal> {
        wait(|reply: Reporter<T>| self.store.read(read, |done| reply.send(done))).await
    }
}

/// Passes a command on to the process that owns the answer.
async fn ask(owner: &Client, command: Command) -> Result<Reply, Refusal> {
    let unavailable = |error| Refusal::new(RefusalKind::Unavailable, format!("{error}"));
    owner.call(command, DEADLINE).await.map_err(unavailable)
}

/// Brings the store's answer from its thread to the waiting task.
struct Reporter<T>(oneshot::Sender<Result<T, Error>>);

impl<T> Reporter<T> {
    fn send(self, answer: Result<T, Error>) {
        // Whoever asked may have gone away; what was done is done.
        let _ = self.0.send(answer);
    }
}

async fn wait<T>(ask: impl FnOnce(Reporter<T>)) -> Result<T, Refusal> {
    let (sender, answer) = oneshot::channel();
    ask(Reporter(sender));
    answer
        .await
        .unwrap_or(Err(Error::Stopped))
        .map_err(|error| translate::refusal(&error))
}

fn what(change: &Change) -> String {
    match change {
        Change::Teach { track_id, .. } => format!("taught track {track_id} as"),
        Change::Correct { track_id, .. } => format!("corrected track {track_id} to"),
        Change::Forget { .. } => "forgot".into(),
        _ => "stored".into(),
    }
}
