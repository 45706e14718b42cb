//! Memory replica: the labelled views of the memory service, followed by snapshot and
//! change log.

use crate::log_once::LogOnce;
use crate::redescription::{DescribedView, as_stored, describe_again, is_current, view_id};
use channel::control::Client;
use channel::topic::MemoryChanged;
use channel::{Domain, Error, Subscriber};
use control_protocol::{
    ChangesPage, LearnedChange, LearnedView, SnapshotPage, TypedRequest, ViewId, request,
};
use daemon_client::CallError;
use learning::{CategoryIndex, IndexBatch};
use pipeline::category_index;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, oneshot, watch};

/// Time limit for an answer of the memory.
const CALL_TIMEOUT: Duration = Duration::from_secs(5);
/// Grace period: shorter failures are not logged.
const LOG_DELAY: Duration = Duration::from_secs(2);
/// Time without an answer after which the memory counts as lost. Chosen: above the poll period,
/// and above the time in which a memory that has ended is replaced.
const LOST_AFTER: Duration = Duration::from_millis(1500);
/// Number of views whose clouds are asked for at once; the answer may hold fewer.
const CLOUDS_PER_CALL: usize = 64;
/// Polling period for changes, in case an announcement is lost.
const POLL_PERIOD: Duration = Duration::from_secs(1);

/// Immutable snapshot of all labelled views, with its position in the history.
#[derive(Debug, Clone)]
pub(crate) struct CategorySnapshot {
    /// Category index of the labelled views.
    pub(crate) index: CategoryIndex,
    /// Position in the history of the memory that the views belong to.
    pub(crate) position: HistoryPosition,
}

/// Position in the history of a memory's store.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct HistoryPosition {
    /// Identity of the store; `None` before any was loaded.
    pub(crate) store_id: Option<u128>,
    /// Sequence number in the history of the store.
    pub(crate) sequence: u64,
}

impl HistoryPosition {
    /// True if this position includes everything up to another one.
    pub(crate) fn includes(self, other: Self) -> bool {
        self.store_id == other.store_id && self.sequence >= other.sequence
    }
}

/// Copy-on-write snapshot of the categories: read for every frame, replaced on each change. A
/// reader keeps its snapshot; neither side waits.
#[derive(Debug, Clone, Default)]
pub(crate) struct SharedCategories(Arc<watch::Sender<Arc<CategorySnapshot>>>);

impl SharedCategories {
    /// Newest snapshot of the learned categories.
    pub(crate) fn get(&self) -> Arc<CategorySnapshot> {
        self.0.borrow().clone()
    }

    /// Receiver that is told of each change.
    pub(crate) fn changes(&self) -> watch::Receiver<Arc<CategorySnapshot>> {
        self.0.subscribe()
    }

    fn set(&self, snapshot: CategorySnapshot) {
        self.0.send_replace(Arc::new(snapshot));
    }
}

impl Default for CategorySnapshot {
    fn default() -> Self {
        let index = category_index();
        Self {
            index,
            position: HistoryPosition::default(),
        }
    }
}

/// Follower of the memory's history that survives restarts of the memory.
pub(crate) struct MemoryReplica {
    client: Arc<Client>,
    announcements: Subscriber<MemoryChanged>,
    categories: SharedCategories,
    kind_log: LogOnce,
    requests: mpsc::Receiver<oneshot::Sender<()>>,
    waiting: Vec<oneshot::Sender<()>>,
    last_answer: Instant,
    is_answering: watch::Sender<bool>,
}

/// Synchronisation barrier: waits until the replica has caught up.
#[derive(Clone)]
pub(crate) struct SyncBarrier {
    requests: mpsc::Sender<oneshot::Sender<()>>,
    is_answering: watch::Receiver<bool>,
}

impl SyncBarrier {
    /// Waits until the replica includes everything that the memory acknowledged before
    /// the call.
    pub(crate) async fn wait(&self) {
        let (sender, caught_up) = oneshot::channel();
        // The replica ends only with the process.
        if self.requests.send(sender).await.is_ok() {
            let _ = caught_up.await;
        }
    }

    /// Waits until the memory has not answered for a while; at once while that lasts.
    pub(crate) async fn memory_lost(&self) {
        let mut is_answering = self.is_answering.clone();
        if is_answering.wait_for(|answers| !answers).await.is_err() {
            std::future::pending::<()>().await;
        }
    }
}

/// Error of synchronising categories with the memory.
#[derive(Debug, thiserror::Error)]
enum SyncError {
    #[error("taught labels are not synchronised for now: {0}")]
    Call(CallError),
    #[error("the memory answered something else: {0}")]
    Unexpected(String),
}

impl MemoryReplica {
    /// Replica of the memory, and the barrier that waits for it.
    pub(crate) fn new(
        domain: &Domain,
        client: Arc<Client>,
        categories: SharedCategories,
    ) -> Result<(Self, SyncBarrier), Error> {
        let announcements = Subscriber::waiting(domain)?;
        let (sender, requests) = mpsc::channel(1);
        let (is_answering, answering) = watch::channel(true);
        let replica = Self {
            client,
            announcements,
            categories,
            kind_log: LogOnce::default(),
            requests,
            waiting: Vec::new(),
            last_answer: Instant::now(),
            is_answering,
        };
        let barrier = SyncBarrier {
            requests: sender,
            is_answering: answering,
        };
        Ok((replica, barrier))
    }

    /// Keeps the replica up to date until the future is dropped.
    pub(crate) async fn run(mut self) {
        let mut last_success = Instant::now();
        let mut failure_log = LogOnce::default();
        loop {
            let caught_up = self.catch_up().await;
            match &caught_up {
                Ok(()) => {
                    if failure_log.reset() {
                        tracing::info!("the memory answers again");
                    }
                    last_success = Instant::now();
                }
                // The memory may be starting at this moment.
                Err(failure) if last_success.elapsed() > LOG_DELAY && failure_log.is_first() => {
                    tracing::warn!("{failure}");
                }
                Err(_) => {}
            }
            if caught_up.is_ok() {
                for waiting in self.waiting.drain(..) {
                    // The caller may have stopped waiting.
                    let _ = waiting.send(());
                }
            }
            tokio::select! {
                () = self.announcements.wake_event() => {}
                Some(request) = self.requests.recv() => self.waiting.push(request),
                () = tokio::time::sleep(POLL_PERIOD) => {}
            }
            let _ = self.announcements.latest();
        }
    }

    async fn catch_up(&mut self) -> Result<(), SyncError> {
        loop {
            let HistoryPosition {
                store_id,
                sequence: since,
            } = self.categories.get().position;
            let Some(store_id) = store_id else {
                self.load().await?;
                continue;
            };
            match self.ask(&request::changes(store_id, since)).await? {
                ChangesPage::Changes {
                    up_to,
                    changes,
                    more,
                } => {
                    self.apply(up_to, changes).await?;
                    if !more {
                        return Ok(());
                    }
                }
                ChangesPage::Reload => {
                    tracing::warn!(
                        "the memory is another store, or so much changed that it does not list \
                         it; loading all views again"
                    );
                    self.load().await?;
                }
            }
        }
    }

    /// Loads all labelled views, page by page. Changes after the first page follow from
    /// the change log and may be applied twice.
    async fn load(&mut self) -> Result<(), SyncError> {
        let mut after = None;
        let mut first: Option<(u128, u64)> = None;
        let mut views = Vec::new();
        loop {
            let SnapshotPage {
                store_id,
                sequence,
                views: more_views,
                next,
            } = self.ask(&request::snapshot(after)).await?;
            if first.is_some_and(|(id, _)| id != store_id) {
                // Another store took its place meanwhile: start again.
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
        let views = self.with_current_descriptors(views).await?;
        let mut snapshot = CategorySnapshot::default();
        self.insert(&mut snapshot.index.batch(), &views);
        snapshot.position = HistoryPosition {
            store_id: Some(store_id),
            sequence,
        };
        let n_categories = snapshot.index.categories().len();
        self.categories.set(snapshot);
        tracing::info!("loaded {n_views} taught views of {n_categories} categories");
        Ok(())
    }

    async fn apply(&mut self, up_to: u64, changes: Vec<LearnedChange>) -> Result<(), SyncError> {
        // The clone shares all views that do not change.
        let mut snapshot = CategorySnapshot::clone(&self.categories.get());
        snapshot.position.sequence = up_to;
        let (assigned, unassigned) = last_changes(changes);
        let assigned = self.with_current_descriptors(assigned).await?;
        {
            let mut batch = snapshot.index.batch();
            for id in unassigned {
                batch.remove_view(view_id(id));
            }
            self.insert(&mut batch, &assigned);
        }
        self.categories.set(snapshot);
        Ok(())
    }

    /// Views with descriptors of this version: those of another kind are described again from
    /// their clouds. A view that cannot be used is left out and logged once.
    async fn with_current_descriptors(
        &mut self,
        views: Vec<LearnedView>,
    ) -> Result<Vec<DescribedView>, SyncError> {
        let (current, earlier): (Vec<_>, Vec<_>) = views.into_iter().partition(is_current);
        let mut results: Vec<_> = current.iter().map(as_stored).collect();
        let n_earlier = earlier.len();
        let mut rest = earlier;
        while !rest.is_empty() {
            let ids = rest
                .iter()
                .take(CLOUDS_PER_CALL)
                .map(|view| view.id)
                .collect();
            let clouds = self.ask(&request::clouds(ids)).await?;
            if clouds.is_empty() {
                let sentence = "the memory sent no cloud of the views asked for";
                return Err(SyncError::Unexpected(sentence.to_owned()));
            }
            let others = rest.split_off(clouds.len().min(rest.len()));
            let batch = std::mem::replace(&mut rest, others);
            let describe = move || describe_again(&batch, &clouds);
            let described = tokio::task::spawn_blocking(describe).await;
            results.extend(described.map_err(|error| SyncError::Unexpected(error.to_string()))?);
        }
        let (mut described, mut failed) = (Vec::with_capacity(results.len()), Vec::new());
        for result in results {
            match result {
                Ok(view) => described.push(view),
                Err(reason) => failed.push(reason),
            }
        }
        if n_earlier > 1 {
            tracing::info!("described {n_earlier} views of earlier versions again");
        }
        self.log_left_out(&failed);
        Ok(described)
    }

    /// Inserts views into the index; a view that it does not take is left out and logged once.
    fn insert(&mut self, batch: &mut IndexBatch<'_>, views: &[DescribedView]) {
        let inserted = views
            .iter()
            .map(|view| batch.insert(view.id, &view.category, &view.values));
        let failed: Vec<String> = inserted
            .filter_map(|inserted| Some(inserted.err()?.to_string()))
            .collect();
        self.log_left_out(&failed);
    }

    fn log_left_out(&mut self, reasons: &[String]) {
        if let Some(first) = reasons.first()
            && self.kind_log.is_first()
        {
            tracing::warn!("stored views are left out, the first because {first}");
        }
    }

    /// Asks the memory, and notes whether it answers.
    async fn ask<T>(&mut self, request: &TypedRequest<T>) -> Result<T, SyncError> {
        let answer = self.client.ask(request, CALL_TIMEOUT);
        tokio::pin!(answer);
        let answered = tokio::select! {
            biased;
            answered = &mut answer => answered,
            () = tokio::time::sleep(LOST_AFTER) => {
                self.is_answering.send_replace(false);
                answer.await
            }
        };
        if matches!(answered, Ok(_) | Err(CallError::Refusal(_))) {
            self.last_answer = Instant::now();
            self.is_answering.send_replace(true);
        } else if self.last_answer.elapsed() > LOST_AFTER {
            self.is_answering.send_replace(false);
        }
        answered.map_err(SyncError::Call)
    }
}

/// Assigned and unassigned views by the last change of each.
fn last_changes(changes: Vec<LearnedChange>) -> (Vec<LearnedView>, Vec<ViewId>) {
    let mut last = BTreeMap::new();
    for change in changes {
        let (id, assigned) = match change {
            LearnedChange::Assigned(view) => (view.id, Some(view)),
            LearnedChange::Unassigned(id) => (id, None),
        };
        last.insert(id, assigned);
    }
    let (mut assigned, mut unassigned) = (Vec::new(), Vec::new());
    for (id, change) in last {
        match change {
            Some(view) => assigned.push(view),
            None => unassigned.push(id),
        }
    }
    (assigned, unassigned)
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
    }
}
