//! Verification and repair jobs: full read of a checkpoint, and rebuild after findings.

use crate::job_context::{JobContext, Progress};
use message::control::{JobOutcome, VerificationReport};
use perceptual_memory::{Error, PerceptualMemory, Verification};
use std::ops::ControlFlow;
use std::sync::mpsc::sync_channel;

/// Number of views between two progress updates.
const EVERY: u64 = 64;

/// Verifies a checkpoint of the store.
pub(crate) fn verify(context: &JobContext, progress: &Progress) -> Result<JobOutcome, String> {
    let found = read_all(context, progress).map_err(|error| error.to_string())?;
    Ok(JobOutcome::Verified(verification_report(found)))
}

/// Verifies the store and rebuilds it after a finding.
pub(crate) fn repair(context: &JobContext, progress: &Progress) -> Result<JobOutcome, String> {
    let found = read_all(context, progress).map_err(|error| error.to_string())?;
    let verification = verification_report(found);
    if verification.n_findings == 0 {
        return Ok(JobOutcome::Repaired {
            verification,
            what: "the store is sound, nothing was changed".to_owned(),
            is_loss: false,
        });
    }
    let (sender, receiver) = sync_channel(1);
    // The receiver waits below.
    context
        .store
        .rebuild(move |report| drop(sender.send(report)));
    let opened = receiver.recv().unwrap_or(Err(Error::Stopped));
    let opened = opened.map_err(|error| error.to_string())?;
    Ok(JobOutcome::Repaired {
        verification,
        what: opened.to_string(),
        is_loss: opened.is_loss(),
    })
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
