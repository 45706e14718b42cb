//! Compaction job: purges forgotten content and compacts the database in small steps.

use crate::job_context::{JobContext, Progress, publish_position, wall_ns};
use control_protocol::JobOutcome;
use perceptual_memory::{Error, Mutation, MutationId, PerceptualMemory, Requester, StoreChange};

const NS_PER_S: u64 = 1_000_000_000;
/// Author of the purge in the history.
const AUTHOR: &str = "compaction";

/// Purges content forgotten at least `forgotten_for_s` ago, and compacts.
pub(crate) fn run(
    context: &JobContext,
    progress: &Progress,
    forgotten_for_s: u64,
    requester: Requester,
) -> Result<JobOutcome, String> {
    try_run(context, progress, forgotten_for_s, requester).map_err(|error| error.to_string())
}

fn try_run(
    context: &JobContext,
    progress: &Progress,
    forgotten_for_s: u64,
    requester: Requester,
) -> Result<JobOutcome, Error> {
    let store = &context.store;
    let before = store.read_and_wait(|memory| memory.stats())?;
    let before_ns = wall_ns().saturating_sub(forgotten_for_s.saturating_mul(NS_PER_S));
    while store.read_and_wait(move |memory| Ok(memory.has_purgeable(before_ns)))? {
        store.mutate_and_wait(Mutation {
            id: MutationId::random()?,
            author: AUTHOR.to_owned(),
            requester,
            wall_ns: wall_ns(),
            change: StoreChange::Purge { before_ns },
        })?;
    }
    publish_position(&context.position, store.position());
    let n_steps = PerceptualMemory::N_COMPACT_STEPS;
    for step in 0..n_steps {
        progress.set(step as u64, n_steps as u64);
        store.compact_and_wait(step)?;
    }
    let after = store.read_and_wait(|memory| memory.stats())?;
    Ok(JobOutcome::Compacted {
        n_purged: before.n_forgotten.saturating_sub(after.n_forgotten),
        disk_bytes_before: before.n_disk_bytes,
        disk_bytes: after.n_disk_bytes,
    })
}
