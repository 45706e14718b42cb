//! Import of a portable file of views into the memory.

use crate::authorship::mutation_id;
use crate::connection::unexpected;
use crate::memory_access::MemoryAccess;
use command_line::{Output, progress_bar};
use message::control::{
    ImportReport, JobCommand, JobKind, JobOutcome, JobReport, MAX_MESSAGE_BYTES, Reply,
};
use service::{Failure, exit_code};
use std::fs::File;
use std::io::{self, Read};

/// Bytes of a file in one request.
const WRITE_BYTES: usize = MAX_MESSAGE_BYTES / 2;

/// Author, source and renames of an import.
#[derive(Debug)]
pub struct ImportRequest {
    /// Author of the change.
    pub author: String,
    /// Source of the views, as the history names it.
    pub source: String,
    /// Categories to rename on the way: from, to.
    pub renames: Vec<(String, String)>,
    /// Prefix of every other category name.
    pub prefix: String,
}

/// Uploads the file from its current position and waits until it is imported.
///
/// # Errors
/// When the file cannot be read, or the memory refuses it; nothing is imported then.
pub fn import(
    memory: &mut MemoryAccess,
    file: &mut File,
    request: ImportRequest,
    output: &Output,
) -> Result<ImportReport, Failure> {
    let job = upload(memory, file, output)?;
    memory.job(JobCommand::Import {
        job,
        id: mutation_id()?,
        author: request.author,
        source: request.source,
        renames: request.renames,
        prefix: request.prefix,
    })?;
    let bar = progress_bar(0, "bytes", output);
    let outcome = memory.wait(job, |report| {
        bar.set_length(report.total);
        bar.set_position(report.done);
    });
    bar.finish_and_clear();
    match outcome? {
        JobOutcome::Imported(report) => Ok(report),
        other => Err(unexpected(&Reply::Job(JobReport {
            job,
            done: 0,
            total: 0,
            outcome: Some(other),
        }))),
    }
}

fn upload(memory: &mut MemoryAccess, file: &mut File, output: &Output) -> Result<u64, Failure> {
    let failed = |error: io::Error| {
        let sentence = format!("what is to be imported could not be read: {error}");
        Failure::new(exit_code::FAILURE, sentence)
    };
    let n_bytes = file.metadata().map_err(failed)?.len();
    let job = memory.begin(JobKind::Import)?.job;
    let bar = progress_bar(n_bytes, "bytes sent", output);
    let mut offset = 0;
    loop {
        let mut bytes = Vec::with_capacity(WRITE_BYTES);
        let part = Read::by_ref(file).take(WRITE_BYTES as u64);
        { part }.read_to_end(&mut bytes).map_err(failed)?;
        if bytes.is_empty() {
            break;
        }
        let n_part = bytes.len() as u64;
        memory.job(JobCommand::Write { job, offset, bytes })?;
        offset += n_part;
        bar.set_position(offset);
    }
    bar.finish_and_clear();
    Ok(job)
}
