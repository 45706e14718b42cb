//! `tabula memory verify`, `repair` and `compact`.

use crate::arguments::CompactArguments;
use command_line::{Output, progress_bar};
use control_client::{MemoryClient, connect_if_running, local_memory_folder, unexpected_outcome};
use control_protocol::{JobOutcome, JobReport, TypedRequest, VerificationReport, request};
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;

const S_PER_DAY: u64 = 24 * 3600;

/// Runs a job to its end, with a progress bar. A failed one is a failure.
fn job(
    memory: &mut MemoryClient,
    begin: &TypedRequest<JobReport>,
    unit: &'static str,
    output: &Output,
) -> Result<JobOutcome, Failure> {
    let report = memory.ask(begin)?;
    let bar = progress_bar(report.total, unit, output);
    let outcome = memory.job_outcome(report.job, |report| {
        bar.set_length(report.total);
        bar.set_position(report.done);
    });
    bar.finish_and_clear();
    match outcome? {
        JobOutcome::Failed(reason) => Err(Failure::general(reason)),
        outcome => Ok(outcome),
    }
}

/// `tabula memory verify`: without a daemon it reads a copy and changes nothing.
pub(super) fn verify(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let mut memory = if let Some(client) = connect_if_running(common)? {
        MemoryClient::of_daemon(common, client)
    } else {
        local_memory_folder(common)?;
        MemoryClient::open_offline(common)?
    };
    let found = match job(&mut memory, &request::verify(), "views", output)? {
        JobOutcome::Verified(found) => found,
        other => return Err(unexpected_outcome(&other)),
    };
    output.answer(&found, || text(&found));
    Ok(if found.n_findings == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(exit_code::FAILURE)
    })
}

fn text(found: &VerificationReport) -> String {
    let VerificationReport {
        n_history,
        n_views,
        n_documents,
        content_bytes,
        n_findings,
        ..
    } = found;
    let read = format!(
        "read {n_history} history entries, {n_views} views, {n_documents} documents, \
         {content_bytes} bytes of content"
    );
    if *n_findings == 0 {
        return format!("the memory is sound: {read}");
    }
    let mut lines = vec![format!(
        "the memory is damaged, {n_findings} finding(s): {read}"
    )];
    lines.extend(found.findings.iter().map(|finding| format!("- {finding}")));
    lines.push("repair it with: tabula memory repair".to_owned());
    lines.join("\n")
}

/// Runs `tabula memory repair`.
pub(super) fn repair(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let mut memory = MemoryClient::open(common)?;
    let outcome = job(&mut memory, &request::repair(), "views", output)?;
    let JobOutcome::Repaired { what, is_loss, .. } = &outcome else {
        return Err(unexpected_outcome(&outcome));
    };
    output.answer(&outcome, || what.clone());
    Ok(if *is_loss {
        ExitCode::from(exit_code::FAILURE)
    } else {
        ExitCode::SUCCESS
    })
}

/// Runs `tabula memory compact`.
pub(super) fn compact(
    common: &CommonArguments,
    arguments: &CompactArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut memory = MemoryClient::open(common)?;
    let compact = request::compact(u64::from(arguments.forgotten_days) * S_PER_DAY);
    let outcome = job(&mut memory, &compact, "steps", output)?;
    let JobOutcome::Compacted {
        n_purged,
        disk_bytes_before,
        disk_bytes,
    } = outcome
    else {
        return Err(unexpected_outcome(&outcome));
    };
    output.answer(&outcome, || {
        format!(
            "permanently deleted {n_purged} forgotten view(s); the files have {disk_bytes} bytes, \
             previously {disk_bytes_before}"
        )
    });
    Ok(ExitCode::SUCCESS)
}
