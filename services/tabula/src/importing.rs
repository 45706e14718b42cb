//! Giving the memory a file of views, which takes over all that is new.

use crate::learn::mutation_id;
use crate::memory_access::MemoryAccess;
use crate::objects::unexpected;
use command_line::{Output, bar};
use message::control::{
    ImportReport, JobCommand, JobKind, JobOutcome, JobReport, MAX_MESSAGE_BYTES, Reply,
};
use service::{Failure, exit_code};
use std::fs::File;
use std::io::{self, Read};

/// Bytes of a file in one request.
const WRITE_BYTES: usize = MAX_MESSAGE_BYTES / 2;

/// How a file is to be taken over.
pub(crate) struct Import {
    /// Who asks.
    pub(crate) author: String,
    /// Where the views come from, for the history.
    pub(crate) source: String,
    /// Names to be changed: from, to.
    pub(crate) renames: Vec<(String, String)>,
    /// Put before every other name.
    pub(crate) prefix: String,
}

/// Sends the file from where it stands, and waits until all of it is taken over.
pub(crate) fn import(
    memory: &mut MemoryAccess,
    file: &mut File,
    import: Import,
    output: &Output,
) -> Result<ImportReport, Failure> {
    let job = upload(memory, file, output)?;
    memory.job(JobCommand::Import {
        job,
        id: mutation_id()?,
        author: import.author,
        source: import.source,
        renames: import.renames,
        prefix: import.prefix,
    })?;
    let bar = bar(0, "bytes", output);
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
    let bar = bar(n_bytes, "bytes sent", output);
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
