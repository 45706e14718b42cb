//! What was taught, followed from the memory process.

use channel::control::{CallError, Client};
use channel::topic::MemoryChanged;
use channel::{Domain, Error, Subscriber};
use learning::{CategoryIndex, CategoryName, ViewId};
use message::control::{ChangesPage, Command, LearnedChange, LearnedView, Reply, SnapshotPage};
use pipeline::{DESCRIPTOR_KIND, category_index};
use std::fmt::{self, Display, Formatter};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, oneshot};

/// How long the memory may take to answer.
const DEADLINE: Duration = Duration::from_secs(5);
/// Failures shorter than this are not told.
const GRACE: Duration = Duration::from_secs(2);
/// Announcements may be lost: the memory is asked this often in any case.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// All taught views, and how far the history of the memory is known.
#[derive(Debug, Clone)]
pub(crate) struct Learned {
    /// The taught views.
    pub(crate) index: CategoryIndex,
    /// Position in the history of the memory that the views belong to.
    pub(crate) position: HistoryPosition,
    /// History sequence of the last change of the index.
    index_sequence: u64,
}

/// A position in the history of a memory's store.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct HistoryPosition {
    /// The store; `None` before any was loaded.
    pub(crate) store_id: Option<u128>,
    /// Sequence number in the history of the store.
    pub(crate) sequence: u64,
}

impl HistoryPosition {
    /// True if everything up to another position is known here.
    pub(crate) fn includes(self, other: Self) -> bool {
        self.store_id == other.store_id && self.sequence >= other.sequence
    }

    /// The older of two positions; the start of history when they are of two stores.
    pub(crate) fn oldest(self, other: Self) -> Self {
        if self.store_id == other.store_id {
            Self {
                sequence: self.sequence.min(other.sequence),
                ..self
            }
        } else {
            Self::default()
        }
    }
}

impl Learned {
    /// True if a label made at a position is the one that these views give.
    pub(crate) fn is_current(&self, made_at: HistoryPosition) -> bool {
        made_at.includes(HistoryPosition {
            sequence: self.index_sequence,
            ..self.position
        })
    }
}

/// Read by every actor, replaced when something is learned. Who reads keeps the
/// state of that moment; nobody waits for a reader or for what is being learned.
#[derive(Debug, Clone, Default)]
pub(crate) struct SharedLearned(Arc<RwLock<Arc<Learned>>>);

impl SharedLearned {
    /// What is known at this moment.
    pub(crate) fn get(&self) -> Arc<Learned> {
        self.0
            .read()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    fn set(&self, learned: Learned) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(learned);
    }
}

impl Default for Learned {
    fn default() -> Self {
        let index = category_index();
        Self {
            index,
            position: HistoryPosition::default(),
            index_sequence: 0,
        }
    }
}

/// Follows the memory, whatever happens to it.
pub(crate) struct Follower {
    client: Arc<Client>,
    announcements: Subscriber<MemoryChanged>,
    learned: SharedLearned,
    is_kind_told: bool,
    requests: mpsc::Receiver<oneshot::Sender<()>>,
    waiting: Vec<oneshot::Sender<()>>,
}

/// Asks the follower to catch up.
#[derive(Clone)]
pub(crate) struct CatchUp(mpsc::Sender<oneshot::Sender<()>>);

impl CatchUp {
    /// Returns when everything is known that the memory had acknowledged before.
    pub(crate) async fn wait(&self) {
        let (sender, caught_up) = oneshot::channel();
        // The follower ends only with the process.
        if self.0.send(sender).await.is_ok() {
            let _ = caught_up.await;
        }
    }
}

/// Why the memory could not be followed.
#[derive(Debug)]
enum FollowFailed {
    Call(CallError),
    Unexpected(String),
}

impl Display for FollowFailed {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Call(error) => write!(f, "what is taught is not followed for now: {error}"),
            Self::Unexpected(reply) => write!(f, "the memory answered something else: {reply}"),
        }
    }
}

impl Follower {
    /// A follower, and how to wait for it.
    pub(crate) fn new(
        domain: &Domain,
        client: Arc<Client>,
        learned: SharedLearned,
    ) -> Result<(Self, CatchUp), Error> {
        let announcements = Subscriber::waiting(domain)?;
        let (sender, requests) = mpsc::channel(1);
        let follower = Self {
            client,
            announcements,
            learned,
            is_kind_told: false,
            requests,
            waiting: Vec::new(),
        };
        Ok((follower, CatchUp(sender)))
    }

    /// Keeps the views up to date until the future is dropped.
    pub(crate) async fn run(mut self) {
        let mut last_success = Instant::now();
        let mut is_told = false;
        loop {
            let caught_up = self.catch_up().await;
            match &caught_up {
                Ok(()) => {
                    if std::mem::take(&mut is_told) {
                        tracing::info!("the memory answers again");
                    }
                    last_success = Instant::now();
                }
                // The memory may be starting at this moment.
                Err(failure) if !is_told && last_success.elapsed() > GRACE => {
                    tracing::warn!("{failure}");
                    is_told = true;
                }
                Err(_) => {}
            }
            if caught_up.is_ok() {
                for waiting in self.waiting.drain(..) {
                    // Who has asked may have gone away.
                    let _ = waiting.send(());
                }
            }
            tokio::select! {
                () = self.announcements.woken() => {}
                Some(request) = self.requests.recv() => self.waiting.push(request),
                () = tokio::time::sleep(LOOK_AGAIN) => {}
            }
            let _ = self.announcements.latest();
        }
    }

    async fn catch_up(&mut self) -> Result<(), FollowFailed> {
        loop {
            let HistoryPosition {
                store_id,
                sequence: since,
            } = self.learned.get().position;
            let Some(store_id) = store_id else {
                self.load().await?;
                continue;
            };
            match self.call(Command::Changes { store_id, since }).await? {
                Reply::Changes(ChangesPage::Changes {
                    up_to,
                    changes,
                    more,
                }) => {
                    self.apply(up_to, changes);
                    if !more {
                        return Ok(());
                    }
                }
                Reply::Changes(ChangesPage::Reload) => {
                    tracing::warn!("the memory's history is another one; loading all views again");
                    self.load().await?;
                }
                other => return Err(FollowFailed::Unexpected(format!("{other:?}"))),
            }
        }
    }

    /// Loads all labelled views, page by page. What changes meanwhile comes with
    /// the changes since the first page, which may be applied twice.
    async fn load(&mut self) -> Result<(), FollowFailed> {
        let mut after = None;
        let mut first: Option<(u128, u64)> = None;
        let mut views = Vec::new();
        loop {
            let page = match self.call(Command::Snapshot { after }).await? {
                Reply::Snapshot(page) => page,
                other => return Err(FollowFailed::Unexpected(format!("{other:?}"))),
            };
            let SnapshotPage {
                store_id,
                sequence,
                views: more_views,
                next,
            } = page;
            if first.is_some_and(|(id, _)| id != store_id) {
                // The store was exchanged in the middle: begin again.
                (first, after) = (None, None);
                views.clear();
                continue;
            }
            first.get_or_insert((store_id, sequence));
            views.extend(more_views);
            after = next;
            if after.is_none() {
                break;
            }
        }
        let Some((store_id, sequence)) = first else {
            return Ok(());
        };
        let n_views = views.len();
        let mut learned = Learned::default();
        for view in views {
            insert(&mut learned.index, &view, &mut self.is_kind_told);
        }
        learned.position = HistoryPosition {
            store_id: Some(store_id),
            sequence,
        };
        learned.index_sequence = sequence;
        let n_categories = learned.index.categories().len();
        self.learned.set(learned);
        tracing::info!("loaded {n_views} taught views of {n_categories} categories");
        Ok(())
    }

    fn apply(&mut self, up_to: u64, changes: Vec<LearnedChange>) {
        // The clone shares all views that do not change.
        let mut learned = Learned::clone(&self.learned.get());
        learned.position.sequence = up_to;
        if !changes.is_empty() {
            learned.index_sequence = up_to;
        }
        for change in changes {
            match change {
                LearnedChange::Assigned(view) => {
                    insert(&mut learned.index, &view, &mut self.is_kind_told);
                }
                LearnedChange::Unassigned(id) => {
                    learned.index.remove_view(view_id(id));
                }
            }
        }
        self.learned.set(learned);
    }

    async fn call(&self, command: Command) -> Result<Reply, FollowFailed> {
        self.client
            .call(command, DEADLINE)
            .await
            .map_err(FollowFailed::Call)
    }
}

fn view_id(id: message::control::ViewId) -> ViewId {
    ViewId {
        track_id: id.track_id,
        view_id: id.view_id,
    }
}

/// Takes a view over; one that does not compare with ours is left out, and that
/// is said once.
fn insert(index: &mut CategoryIndex, view: &LearnedView, is_told: &mut bool) {
    if let Err(reason) = try_insert(index, view)
        && !*is_told
    {
        tracing::warn!("stored views are left out, the first because {reason}");
        *is_told = true;
    }
}

fn try_insert(index: &mut CategoryIndex, view: &LearnedView) -> Result<(), String> {
    if view.descriptor_kind != DESCRIPTOR_KIND {
        return Err(format!(
            "it was described as {}, not {DESCRIPTOR_KIND}",
            view.descriptor_kind
        ));
    }
    let category = CategoryName::new(&view.category).map_err(|error| error.to_string())?;
    let (values, rest) = view.descriptor.as_chunks::<4>();
    if !rest.is_empty() {
        return Err("its descriptor is not a list of 32-bit numbers".into());
    }
    let values: Vec<f32> = values
        .iter()
        .map(|value| f32::from_le_bytes(*value))
        .collect();
    index
        .insert(view_id(view.id), &category, &values)
        .map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(store_id: u128, sequence: u64) -> HistoryPosition {
        HistoryPosition {
            store_id: Some(store_id),
            sequence,
        }
    }

    #[test]
    fn positions_of_two_stores_do_not_include_each_other() {
        assert!(at(1, 5).includes(at(1, 5)) && at(1, 6).includes(at(1, 5)));
        assert!(!at(1, 4).includes(at(1, 5)) && !at(2, 9).includes(at(1, 5)));
        assert_eq!(at(1, 4).oldest(at(1, 7)), at(1, 4));
        assert_eq!(at(1, 4).oldest(at(2, 7)), HistoryPosition::default());
    }

    #[test]
    fn a_label_is_outdated_only_by_a_change_of_the_index() {
        let mut learned = Learned {
            position: at(1, 9),
            index_sequence: 6,
            ..Learned::default()
        };
        assert!(learned.is_current(at(1, 6)) && !learned.is_current(at(1, 5)));
        learned.position.store_id = Some(2);
        assert!(!learned.is_current(at(1, 9)));
    }
}
