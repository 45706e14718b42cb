//! Key views on their way to the memory: kept until they are on disk.

use channel::control::Client;
use message::control::{Command, MutationId, Reply, StoredView};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};

/// Key views that may wait; the memory is away for minutes before one is lost.
const CAPACITY: usize = 4096;
/// Views of one request.
const BATCH: usize = 32;
/// How long the memory may take to answer.
const DEADLINE: Duration = Duration::from_secs(5);
/// How soon it is asked again after a failure.
const TRY_AGAIN: Duration = Duration::from_millis(200);

/// Resolves when the view is on disk.
pub(crate) type OnDisk = oneshot::Receiver<()>;

struct Waiting {
    view: StoredView,
    on_disk: oneshot::Sender<()>,
}

/// Takes key views.
#[derive(Clone)]
pub(crate) struct Outbox(mpsc::Sender<Waiting>);

/// Sends key views.
pub(crate) struct Courier {
    waiting: mpsc::Receiver<Waiting>,
    client: Arc<Client>,
}

/// An outbox, and the courier who empties it.
pub(crate) fn outbox(client: Arc<Client>) -> (Outbox, Courier) {
    let (sender, waiting) = mpsc::channel(CAPACITY);
    (Outbox(sender), Courier { waiting, client })
}

impl Outbox {
    /// Takes a view; `None` when there is no room, which is said.
    pub(crate) fn put(&self, view: StoredView) -> Option<OnDisk> {
        let id = view.id;
        let (on_disk, resolved) = oneshot::channel();
        if self.0.try_send(Waiting { view, on_disk }).is_err() {
            tracing::error!(
                "a key view of track {} is lost: the memory has not answered for {CAPACITY} views",
                id.track_id
            );
            return None;
        }
        Some(resolved)
    }
}

impl Courier {
    /// Delivers in order until the future is dropped.
    pub(crate) async fn run(mut self) {
        let mut batch = Vec::with_capacity(BATCH);
        while self.waiting.recv_many(&mut batch, BATCH).await > 0 {
            let views: Vec<_> = batch.iter().map(|waiting| waiting.view.clone()).collect();
            self.deliver(views).await;
            for waiting in batch.drain(..) {
                // Only a lockstep frame waits for it.
                let _ = waiting.on_disk.send(());
            }
        }
    }

    /// Asks until the memory has them. The same identity makes a repetition
    /// harmless.
    async fn deliver(&self, views: Vec<StoredView>) {
        let id = MutationId(random_id());
        let mut is_told = false;
        loop {
            let command = Command::StoreViews {
                id,
                views: views.clone(),
            };
            match self.client.call(command, DEADLINE).await {
                Ok(Reply::Stored) => return,
                Ok(Reply::Refused(refusal)) if !is_transient(&refusal) => {
                    tracing::error!("{} key views were refused: {refusal}", views.len());
                    return;
                }
                other if !is_told => {
                    tracing::warn!("key views wait for the memory: {other:?}");
                    is_told = true;
                }
                _ => {}
            }
            tokio::time::sleep(TRY_AGAIN).await;
        }
    }
}

fn is_transient(refusal: &message::control::Refusal) -> bool {
    use message::control::RefusalKind;
    matches!(
        refusal.kind,
        RefusalKind::Unavailable | RefusalKind::Internal
    )
}

fn random_id() -> u128 {
    let mut bytes = [0; 16];
    match getrandom::fill(&mut bytes) {
        Ok(()) => u128::from_le_bytes(bytes),
        // Without randomness: unique on this machine for as long as it runs.
        Err(_) => u128::from(service::monotonic_ns()) << 32 | u128::from(std::process::id()),
    }
}
