//! Outbox of key views: a bounded queue that delivers at least once to the memory.

use crate::log_once::LogOnce;
use channel::control::Client;
use control_protocol::{MutationId, Refusal, RefusalKind, StoredView, request};
use daemon_client::CallError;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc, oneshot};

/// Capacity of the queue, bytes: enough for minutes without the memory.
const CAPACITY_BYTES: usize = 256_000_000;
/// Time limit for an answer of the memory.
const CALL_TIMEOUT: Duration = Duration::from_secs(5);
/// Pause before a failed delivery is repeated.
const RETRY_PERIOD: Duration = Duration::from_millis(200);

/// Receipt that resolves when the view is on disk.
pub(crate) type StoreReceipt = oneshot::Receiver<()>;

struct QueuedView {
    view: StoredView,
    on_disk: oneshot::Sender<()>,
    /// Permits for the bytes of the view, released on delivery.
    _room: OwnedSemaphorePermit,
}

/// Sending end of the outbox. It is bounded in bytes; when it is full, the newest view is
/// lost.
#[derive(Clone)]
pub(crate) struct Outbox {
    queue: mpsc::UnboundedSender<QueuedView>,
    /// Semaphore that bounds the queued bytes: one permit per byte.
    room: Arc<Semaphore>,
}

/// Delivery task of the outbox.
pub(crate) struct OutboxSender {
    queue: OutboxQueue,
    client: Arc<Client>,
}

/// Receiving end of the outbox, first in first out.
struct OutboxQueue {
    waiting: mpsc::UnboundedReceiver<QueuedView>,
    /// View that did not fit into the last store request and is sent first in the next.
    next: Option<QueuedView>,
}

/// Outbox of key views and its delivery task.
pub(crate) fn outbox(client: Arc<Client>) -> (Outbox, OutboxSender) {
    let (outbox, queue) = queue(CAPACITY_BYTES);
    (outbox, OutboxSender { queue, client })
}

fn queue(capacity_bytes: usize) -> (Outbox, OutboxQueue) {
    let (sender, waiting) = mpsc::unbounded_channel();
    let outbox = Outbox {
        queue: sender,
        room: Arc::new(Semaphore::new(capacity_bytes)),
    };
    let next = None;
    (outbox, OutboxQueue { waiting, next })
}

impl Outbox {
    /// Enqueues a view; `None`, with an error in the log, when the outbox is full.
    pub(crate) fn put(&self, view: StoredView) -> Option<StoreReceipt> {
        let id = view.id;
        let (on_disk, resolved) = oneshot::channel();
        if self.try_put(view, on_disk).is_none() {
            tracing::error!(
                "a key view of track {} is lost: the memory has not answered for {} MB of views",
                id.track_id,
                CAPACITY_BYTES / 1_000_000
            );
            return None;
        }
        Some(resolved)
    }

    fn try_put(&self, view: StoredView, on_disk: oneshot::Sender<()>) -> Option<()> {
        let n_bytes = u32::try_from(view.max_encoded_bytes()).ok()?;
        let room = self.room.clone().try_acquire_many_owned(n_bytes).ok()?;
        let waiting = QueuedView {
            view,
            on_disk,
            _room: room,
        };
        self.queue.send(waiting).ok()
    }
}

impl OutboxQueue {
    /// Waits for views and takes as many as fit one request; none when the outbox is
    /// closed.
    async fn take_batch(&mut self, batch: &mut Vec<QueuedView>) {
        let mut next = match self.next.take() {
            Some(waiting) => Some(waiting),
            None => self.waiting.recv().await,
        };
        let mut n_bytes = 0;
        while let Some(waiting) = next {
            n_bytes += waiting.view.max_encoded_bytes();
            if n_bytes > StoredView::MAX_REQUEST_BYTES && !batch.is_empty() {
                self.next = Some(waiting);
                return;
            }
            batch.push(waiting);
            next = self.waiting.try_recv().ok();
        }
    }
}

impl OutboxSender {
    /// Delivers views in order until the future is dropped.
    pub(crate) async fn run(mut self) {
        let mut batch = Vec::new();
        loop {
            self.queue.take_batch(&mut batch).await;
            if batch.is_empty() {
                return;
            }
            let views: Vec<_> = batch.iter().map(|waiting| waiting.view.clone()).collect();
            self.deliver(views).await;
            for waiting in batch.drain(..) {
                // Only a lockstep frame waits for it.
                let _ = waiting.on_disk.send(());
            }
        }
    }

    /// Repeats a request until the memory has acknowledged it. The mutation id makes
    /// repetitions idempotent.
    async fn deliver(&self, views: Vec<StoredView>) {
        let n_views = views.len();
        let store = request::store_views(mutation_id(), views);
        let mut wait_log = LogOnce::default();
        loop {
            match self.client.ask(&store, CALL_TIMEOUT).await {
                Ok(()) => return,
                Err(CallError::Refusal(refusal)) if !is_transient(&refusal) => {
                    tracing::error!("{n_views} key views were refused: {refusal}");
                    return;
                }
                Err(error) if wait_log.is_first() => {
                    tracing::warn!("key views wait for the memory: {error}");
                }
                Err(_) => {}
            }
            tokio::time::sleep(RETRY_PERIOD).await;
        }
    }
}

fn is_transient(refusal: &Refusal) -> bool {
    matches!(
        refusal.kind,
        RefusalKind::Unavailable | RefusalKind::Internal | RefusalKind::UnknownOutcome
    )
}

/// Random id; without randomness, one that is unique on this machine for as long as it runs.
fn mutation_id() -> MutationId {
    MutationId::random().unwrap_or_else(|_| {
        MutationId(u128::from(service::monotonic_ns()) << 32 | u128::from(std::process::id()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::DescriptorBytes;
    use control_protocol::ViewId;

    fn view(number: u32, n_bytes: usize) -> StoredView {
        StoredView {
            id: ViewId {
                track_id: 1,
                view_id: number,
            },
            descriptor_kind: String::new(),
            descriptor: DescriptorBytes::default(),
            position_m: [0.0; 3],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
            captured_ns: 0,
            frame_sequence: 0,
            source_name: String::new(),
            points: vec![0; n_bytes],
            mean_rgb: None,
        }
    }

    async fn batch_of(queue: &mut OutboxQueue) -> Vec<u32> {
        let mut batch = Vec::new();
        queue.take_batch(&mut batch).await;
        batch
            .iter()
            .map(|waiting| waiting.view.id.view_id)
            .collect()
    }

    #[tokio::test]
    async fn a_request_holds_as_many_views_as_fit_in_order() {
        let (outbox, mut queue) = queue(CAPACITY_BYTES);
        let third = StoredView::MAX_REQUEST_BYTES / 3;
        let sizes = [third, third, 0, third, 2 * third, 3 * third, 9 * third, 0];
        for (number, n_bytes) in (0..).zip(sizes) {
            assert!(outbox.put(view(number, n_bytes)).is_some());
        }
        drop(outbox);
        let mut batches = Vec::new();
        loop {
            let batch = batch_of(&mut queue).await;
            if batch.is_empty() {
                break;
            }
            batches.push(batch);
        }
        let expected: [&[u32]; 6] = [&[0, 1, 2], &[3], &[4], &[5], &[6], &[7]];
        assert_eq!(batches, expected);
    }

    #[tokio::test]
    async fn the_queue_is_bounded_in_bytes_and_delivery_makes_room() {
        let one = view(0, 1000).max_encoded_bytes();
        let (outbox, mut queue) = queue(2 * one);
        assert!(outbox.put(view(0, 1000)).is_some());
        assert!(outbox.put(view(1, 1000)).is_some());
        assert!(outbox.put(view(2, 0)).is_none());
        assert_eq!(batch_of(&mut queue).await, [0, 1]);
        assert!(outbox.put(view(3, 1000)).is_some());
        assert_eq!(batch_of(&mut queue).await, [3]);
    }
}
