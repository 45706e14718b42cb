//! Client of the store: reads, and changes with their answers to the requester.

use crate::job_context::{publish_position, wall_ns};
use crate::{change_text, translate};
use control_protocol::{LearningReport, MutationId, Refusal, RefusalKind, Reply};
use perceptual_memory::{
    Error, Mutation, MutationReceipt, PerceptualMemory, Position, Requester, StoreChange,
    StoreHandle,
};
use tokio::sync::{oneshot, watch};

/// Origin of a change: its key, its claimed author, and the user as the kernel says.
pub(crate) struct By {
    pub(crate) id: MutationId,
    pub(crate) author: String,
    pub(crate) user: Requester,
}

/// Client of the store thread that publishes the position of the history after each change.
#[derive(Clone)]
pub(crate) struct StoreClient {
    pub(crate) store: StoreHandle,
    pub(crate) position: watch::Sender<Position>,
}

impl StoreClient {
    /// Applies a change by a user and reports a contradicted label as a conflict.
    pub(crate) async fn apply(
        &self,
        by: By,
        change: StoreChange,
        about: &str,
    ) -> Result<Reply, Refusal> {
        let what = change_text::describe_change(&change);
        let receipt = self.mutate(by, change).await?;
        let sequence = receipt.sequence;
        if let Some(contradiction) = receipt.contradiction {
            tracing::info!("{what}: contradicted, history {sequence}");
            let sentence = change_text::describe_contradiction(&what, &contradiction, sequence);
            return Err(Refusal::new(RefusalKind::Conflict, sentence));
        }
        let n_views = receipt.n_views;
        tracing::info!("{what}: {n_views} view(s) changed, history {sequence}");
        Ok(learned(&receipt, about))
    }

    /// Applies a mutation, publishes the new position, and answers once it is on disk.
    pub(crate) async fn mutate(
        &self,
        by: By,
        change: StoreChange,
    ) -> Result<MutationReceipt, Refusal> {
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

    /// Leases track-ids; returns the first one.
    pub(crate) async fn lease_track_ids(&self, count: u64) -> Result<u64, Refusal> {
        let lease = |reply: ReplySender<u64>| {
            self.store.lease_track_ids(count, |first| reply.send(first));
        };
        wait(lease)
            .await
            .map_err(|error| translate::refusal(&error))
    }

    /// Answer to a change that was made already; `None` when its id is not known.
    pub(crate) async fn answered(
        &self,
        id: MutationId,
        about: &str,
    ) -> Result<Option<Reply>, Refusal> {
        let id = perceptual_memory::MutationId(id.0);
        let receipt = self.read(move |memory| memory.receipt(id)).await?;
        Ok(receipt.map(|receipt| learned(&receipt, about)))
    }

    /// Runs `read` on the store thread.
    pub(crate) async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&mut PerceptualMemory) -> Result<T, Error> + Send + 'static,
    ) -> Result<T, Refusal> {
        let answer = wait(|reply: ReplySender<T>| self.store.read(read, |done| reply.send(done)));
        answer.await.map_err(|error| translate::refusal(&error))
    }
}

fn learned(receipt: &MutationReceipt, about: &str) -> Reply {
    Reply::Learned(LearningReport {
        sequence: receipt.sequence,
        category: about.to_owned(),
        n_views_changed: receipt.n_views,
    })
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
