//! Import of an export file into the perceptual memory.

use crate::authorship::mutation_id;
use crate::memory_client::{MemoryClient, unexpected_outcome};
use command_line::{Output, progress_bar};
use control_protocol::{ImportCompletion, ImportReport, JobOutcome, MAX_MESSAGE_BYTES, request};
use service::Failure;
use std::fs::File;
use std::io::{self, Read};

/// Maximum size of the file's part in one request, bytes; the rest of the message needs room too.
const WRITE_BYTES: usize = MAX_MESSAGE_BYTES / 2;

/// Parameters of an import over the control protocol.
#[derive(Debug)]
pub struct ImportRequest {
    /// Author of the imported changes.
    pub author: String,
    /// Name of the source in the history.
    pub source: String,
    /// Categories to rename, as pairs of their name in the file and their name in the memory.
    pub renames: Vec<(String, String)>,
    /// Prefix of every category that is not renamed.
    pub prefix: String,
    /// `true` to make new categories, even beside ones whose names look alike.
    pub is_new: bool,
    /// Decisions from more than a day ahead of the clock of the memory get the present time; false
    /// leaves them out.
    pub restamp: bool,
}

/// Reason why an import has failed.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The memory refuses the content of the file.
    #[error("{0}")]
    RefusedFile(String),
    /// File that cannot be read, or memory that does not answer.
    #[error(transparent)]
    Failure(#[from] Failure),
}

/// Uploads a file from its current position and waits until it is imported.
///
/// # Errors
/// If the file cannot be read, the connection ends, or the memory refuses the file; nothing is
/// imported then.
pub fn import(
    memory: &mut MemoryClient,
    file: &mut File,
    request: ImportRequest,
    output: &Output,
) -> Result<ImportReport, ImportError> {
    let job = upload(memory, file, output)?;
    let ImportRequest {
        author,
        source,
        renames,
        prefix,
        is_new,
        restamp,
    } = request;
    let id = mutation_id()?;
    memory.ask(&request::complete_import(ImportCompletion {
        job,
        id,
        author,
        source,
        renames,
        prefix,
        is_new,
        restamp,
    }))?;
    let bar = progress_bar(0, "bytes", output);
    let outcome = memory.job_outcome(job, |report| {
        bar.set_length(report.total);
        bar.set_position(report.done);
    });
    bar.finish_and_clear();
    match outcome? {
        JobOutcome::Imported(report) => Ok(report),
        JobOutcome::Failed(reason) => Err(ImportError::RefusedFile(reason)),
        other => Err(unexpected_outcome(&other).into()),
    }
}

/// Uploads the file; returns the id of the import job.
fn upload(memory: &mut MemoryClient, file: &mut File, output: &Output) -> Result<u64, Failure> {
    let failed = |error: io::Error| {
        let sentence = format!("the file to be imported could not be read: {error}");
        Failure::general(sentence)
    };
    let n_bytes = file.metadata().map_err(failed)?.len();
    let job = memory.ask(&request::import())?.job;
    let bar = progress_bar(n_bytes, "bytes sent", output);
    let mut offset = 0;
    loop {
        let mut bytes = Vec::with_capacity(WRITE_BYTES);
        let part = Read::by_ref(file).take(WRITE_BYTES as u64);
        { part }.read_to_end(&mut bytes).map_err(failed)?;
        let n_part = bytes.len() as u64;
        // The empty part at the end is sent too: an empty file is judged like any other.
        memory.ask(&request::write_job(job, offset, bytes))?;
        offset += n_part;
        bar.set_position(offset);
        if n_part == 0 {
            break;
        }
    }
    bar.finish_and_clear();
    Ok(job)
}
