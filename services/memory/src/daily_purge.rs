//! Daily purge: permanently deletes forgotten views when their retention time is over, and old
//! tombstones.

use crate::config::Config;
use perceptual_memory::{
    Error, Mutation, MutationId, MutationReceipt, PerceptualMemory, Requester, StoreChange,
    StoreHandle,
};
use service::{LiveConfig, wall_clock_ns};
use std::time::Duration;
use tokio::sync::oneshot;

/// Period of the purge of forgotten content.
const PERIOD: Duration = Duration::from_secs(24 * 3600);
/// Author of the purge in the history.
const AUTHOR: &str = "upkeep";

/// Purges periodically until the future is dropped, with the retention times of that day.
pub(crate) async fn run(store: StoreHandle, live: LiveConfig<Config>) {
    let mut period = tokio::time::interval(PERIOD);
    loop {
        period.tick().await;
        let config = live.get();
        let (forgotten_kept, tombstones_kept) = (config.forgotten_kept, config.tombstones_kept);
        match purge(&store, before_ns(forgotten_kept)).await {
            Ok(0) => {}
            Ok(n_views) => tracing::info!(
                "{n_views} view(s) were forgotten more than {} days ago and are permanently deleted",
                forgotten_kept.as_secs() / (24 * 3600)
            ),
            Err(error) => tracing::warn!("forgotten content is not purged today: {error}"),
        }
        if let Err(error) = purge_tombstones(&store, before_ns(tombstones_kept)).await {
            tracing::warn!("old notes of forgotten views are not purged today: {error}");
        }
    }
}

/// Time that lies `kept` before now, nanoseconds since 1970, UTC.
fn before_ns(kept: Duration) -> u64 {
    let wall_ns = wall_clock_ns().max(0) as u64;
    wall_ns.saturating_sub(u64::try_from(kept.as_nanos()).unwrap_or(u64::MAX))
}

/// Purges all that is due, a part at a time; returns the number of views.
async fn purge(store: &StoreHandle, before_ns: u64) -> Result<u64, Error> {
    let mut n_views = 0;
    while ask(store, move |memory| memory.has_purgeable(before_ns)).await? {
        n_views += mutate(store, StoreChange::Purge { before_ns })
            .await?
            .n_views;
    }
    Ok(n_views)
}

async fn purge_tombstones(store: &StoreHandle, before_ns: u64) -> Result<(), Error> {
    while ask(store, move |memory| {
        memory.has_purgeable_tombstones(before_ns)
    })
    .await?
    {
        mutate(store, StoreChange::PurgeTombstones { before_ns }).await?;
    }
    Ok(())
}

async fn ask(
    store: &StoreHandle,
    question: impl FnOnce(&PerceptualMemory) -> bool + Send + 'static,
) -> Result<bool, Error> {
    let (sender, answer) = oneshot::channel();
    store.read(
        move |memory| Ok(question(memory)),
        move |answer| drop(sender.send(answer)),
    );
    answer.await.unwrap_or(Err(Error::Stopped))
}

async fn mutate(store: &StoreHandle, change: StoreChange) -> Result<MutationReceipt, Error> {
    let mutation = Mutation {
        id: MutationId::random()?,
        author: AUTHOR.to_owned(),
        requester: Requester::default(),
        wall_ns: wall_clock_ns().max(0) as u64,
        change,
    };
    let (sender, purged) = oneshot::channel();
    store.mutate(mutation, move |answer| drop(sender.send(answer)));
    purged.await.unwrap_or(Err(Error::Stopped))
}
