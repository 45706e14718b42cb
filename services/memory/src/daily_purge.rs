//! Daily purge: permanently deletes forgotten views when their retention time is over.

use perceptual_memory::{
    Error, Mutation, MutationId, MutationReceipt, Requester, StoreChange, StoreHandle,
};
use service::wall_clock_ns;
use std::time::Duration;
use tokio::sync::oneshot;

/// Period of the purge of forgotten content.
const PERIOD: Duration = Duration::from_secs(24 * 3600);
/// Author of the purge in the history.
const AUTHOR: &str = "upkeep";

/// Purges periodically until the future is dropped.
pub(crate) async fn run(store: StoreHandle, forgotten_kept: Duration) {
    let mut period = tokio::time::interval(PERIOD);
    loop {
        period.tick().await;
        match purge(&store, forgotten_kept).await {
            Ok(MutationReceipt { n_views: 0, .. }) => {}
            Ok(answer) => tracing::info!(
                "{} view(s) were forgotten more than {} days ago and are permanently deleted",
                answer.n_views,
                forgotten_kept.as_secs() / (24 * 3600)
            ),
            Err(error) => tracing::warn!("forgotten content is not purged today: {error}"),
        }
    }
}

async fn purge(store: &StoreHandle, forgotten_kept: Duration) -> Result<MutationReceipt, Error> {
    let wall_ns = wall_clock_ns().max(0) as u64;
    let before_ns = wall_ns.saturating_sub(forgotten_kept.as_nanos() as u64);
    let (sender, is_due) = oneshot::channel();
    store.read(
        move |memory| Ok(memory.has_purgeable(before_ns)),
        move |answer| drop(sender.send(answer)),
    );
    if !is_due.await.unwrap_or(Err(Error::Stopped))? {
        return Ok(MutationReceipt {
            sequence: 0,
            n_views: 0,
            contradiction: None,
        });
    }
    let mutation = Mutation {
        id: MutationId::random()?,
        author: AUTHOR.to_owned(),
        requester: Requester::default(),
        wall_ns,
        change: StoreChange::Purge { before_ns },
    };
    let (sender, purged) = oneshot::channel();
    store.mutate(mutation, move |answer| drop(sender.send(answer)));
    purged.await.unwrap_or(Err(Error::Stopped))
}
