//! Verification and repair jobs: full read of a checkpoint, and rebuild after findings.

use crate::job_context::{JobContext, Progress, publish_position, wall_ns};
use control_protocol::{JobOutcome, VerificationReport};
use perceptual_memory::{
    Error, Mutation, MutationId, PerceptualMemory, Requester, StoreChange, Verification,
};
use std::ops::ControlFlow;
use std::sync::mpsc::sync_channel;

/// Number of views between two progress updates.
const EVERY: u64 = 64;

/// Verifies a checkpoint of the store.
pub(crate) fn verify(context: &JobContext, progress: &Progress) -> Result<JobOutcome, String> {
    let found = read_all(context, progress).map_err(|error| error.to_string())?;
    Ok(JobOutcome::Verified(verification_report(found)))
}

/// Author of the repair of names in the history.
const AUTHOR: &str = "memory repair";

/// Verifies the store, rebuilds it after a finding, and brings the names of categories into the
/// form that they have today.
pub(crate) fn repair(
    context: &JobContext,
    progress: &Progress,
    owner: Requester,
) -> Result<JobOutcome, String> {
    let found = read_all(context, progress).map_err(|error| error.to_string())?;
    let verification = verification_report(found);
    let (mut what, is_loss) = if verification.n_findings == 0 {
        ("the store is sound".to_owned(), false)
    } else {
        rebuild(context)?
    };
    match normalise_names(context, owner).map_err(|error| error.to_string())? {
        Some(names) => what = format!("{what}; {names}"),
        None if verification.n_findings == 0 => what.push_str(", nothing was changed"),
        None => {}
    }
    Ok(JobOutcome::Repaired {
        verification,
        what,
        is_loss,
    })
}

/// Rebuilds the store; returns a sentence about it, and `true` if data was lost.
fn rebuild(context: &JobContext) -> Result<(String, bool), String> {
    let (sender, receiver) = sync_channel(1);
    // The receiver waits below.
    context
        .store
        .rebuild(move |report| drop(sender.send(report)));
    let opened = receiver.recv().unwrap_or(Err(Error::Stopped));
    let opened = opened.map_err(|error| error.to_string())?;
    Ok((opened.to_string(), opened.is_loss()))
}

/// Brings names that an earlier version stored into the form of today, in one entry; returns a
/// phrase about it, if there were any.
fn normalise_names(context: &JobContext, owner: Requester) -> Result<Option<String>, Error> {
    let count = |memory: &mut PerceptualMemory| Ok(memory.n_names_to_normalise());
    let n_names = context.store.read_and_wait(count)?;
    if n_names == 0 {
        return Ok(None);
    }
    let receipt = context.store.mutate_and_wait(Mutation {
        id: MutationId::random()?,
        author: AUTHOR.to_owned(),
        requester: owner,
        wall_ns: wall_ns(),
        change: StoreChange::NormaliseNames,
    })?;
    publish_position(&context.position, context.store.position());
    let sequence = receipt.sequence;
    Ok(Some(format!(
        "{n_names} name(s) of categories were brought into today's form, and joined where they \
         are equal; to undo this: tabula undo {sequence}"
    )))
}

fn read_all(context: &JobContext, progress: &Progress) -> Result<Verification, Error> {
    let checkpoint = context.store.read_and_wait(PerceptualMemory::checkpoint)?;
    let reader = checkpoint.open()?;
    let total = reader.n_views() as u64;
    progress.set(0, total);
    reader.verify_while(|done| {
        if done % EVERY == 0 || done == total {
            progress.set(done, total);
        }
        if progress.is_abandoned() {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    })
}

/// Wire report of a verification.
pub fn verification_report(found: Verification) -> VerificationReport {
    VerificationReport {
        sequence: found.position.sequence,
        n_history: found.n_history,
        n_views: found.n_views,
        n_documents: found.n_documents,
        content_bytes: found.n_content_bytes,
        n_findings: found.n_findings,
        findings: found.findings,
    }
}
