//! Exporting and importing.

use crate::arguments::ImportArguments;
use crate::learn::{author_or_user, mutation_id};
use crate::memory_access::MemoryAccess;
use crate::objects::unexpected;
use crate::output::Output;
use crate::simulate::progress;
use message::control::{
    Command, ExportReport, ImportReport, JobCommand, JobKind, JobOutcome, MAX_MESSAGE_BYTES, Reply,
};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::fs::{self, File};
use std::io::{BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use store::PortableReader;

/// Bytes of a file in one request.
const WRITE_BYTES: usize = MAX_MESSAGE_BYTES / 2;
/// How soon an export is asked again for bytes that it had not yet.
const ASK_AGAIN: Duration = Duration::from_millis(20);

#[derive(Serialize)]
struct ExportDocument<'a> {
    file: &'a Path,
    #[serde(flatten)]
    report: ExportReport,
}

/// `tabula memory export`: the file appears when it is whole and on disk.
pub(super) fn export(
    common: &CommonArguments,
    file: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut memory = MemoryAccess::open(common, output)?;
    let partial = partial(file);
    let written = write_export(&mut memory, &partial, output);
    let report = match written.and_then(|report| {
        fs::rename(&partial, file)
            .map_err(|error| file_failed("renamed to", file, &error))
            .map(|()| report)
    }) {
        Ok(report) => report,
        Err(failure) => {
            // What is half written is of no use.
            let _ = fs::remove_file(&partial);
            return Err(failure);
        }
    };
    output.answer(&ExportDocument { file, report }, || {
        let ExportReport {
            bytes,
            n_views,
            n_forgotten,
            n_documents,
            sequence,
        } = report;
        format!(
            "exported {n_views} view(s), {n_documents} document(s) and {n_forgotten} note(s) of \
             forgotten views to {}: {bytes} bytes, as of history entry {sequence}",
            file.display()
        )
    });
    Ok(ExitCode::SUCCESS)
}

fn partial(file: &Path) -> PathBuf {
    let mut name = file.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    file.with_file_name(name)
}

fn file_failed(doing: &str, file: &Path, error: &std::io::Error) -> Failure {
    let sentence = format!("{} could not be {doing}: {error}", file.display());
    Failure::new(exit_code::FAILURE, sentence)
}

fn write_export(
    memory: &mut MemoryAccess,
    path: &Path,
    output: &Output,
) -> Result<ExportReport, Failure> {
    let failed = |error: std::io::Error| file_failed("written", path, &error);
    let mut file = File::create(path).map_err(failed)?;
    let begun = memory.begin(JobKind::Export)?;
    let bar = progress::bar(begun.total, "views", output);
    let mut offset = 0;
    let report = loop {
        // Asked first: what comes after it is over is all there is.
        let report = memory.job(JobCommand::Ask { job: begun.job })?;
        bar.set_length(report.total);
        bar.set_position(report.done);
        let bytes = match memory.call(Command::Job(JobCommand::Read {
            job: begun.job,
            offset,
        }))? {
            Reply::JobBytes { bytes } => bytes,
            other => return Err(unexpected(&other)),
        };
        file.write_all(&bytes).map_err(failed)?;
        offset += bytes.len() as u64;
        match report.outcome {
            Some(JobOutcome::Exported(report)) if offset == report.bytes => break report,
            Some(JobOutcome::Failed(why)) => return Err(Failure::new(exit_code::FAILURE, why)),
            _ if bytes.is_empty() => std::thread::sleep(ASK_AGAIN),
            _ => {}
        }
    };
    bar.finish_and_clear();
    file.sync_all().map_err(failed)?;
    Ok(report)
}

/// `tabula memory import`
pub(super) fn import(
    common: &CommonArguments,
    arguments: &ImportArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let renames = arguments.rename.iter().map(|text| {
        let pair = text.split_once('=');
        let pair = pair.map(|(from, to)| (from.to_owned(), to.to_owned()));
        pair.ok_or_else(|| {
            let sentence = format!("{text:?} renames nothing: write it as FROM=TO");
            Failure::new(exit_code::USAGE, sentence)
        })
    });
    let renames = renames.collect::<Result<Vec<_>, _>>()?;
    check(&arguments.file)?;
    let mut memory = MemoryAccess::open(common, output)?;
    let job = upload(&mut memory, &arguments.file, output)?;
    let source = arguments.file.file_name().unwrap_or_default();
    memory.job(JobCommand::Import {
        job,
        id: mutation_id()?,
        author: author_or_user(arguments.author.as_deref()),
        source: source.to_string_lossy().into_owned(),
        renames,
        prefix: arguments.prefix.clone(),
    })?;
    let bar = progress::bar(0, "bytes", output);
    let outcome = memory.wait(job, |report| {
        bar.set_length(report.total);
        bar.set_position(report.done);
    })?;
    bar.finish_and_clear();
    let JobOutcome::Imported(report) = outcome else {
        let sentence = format!("the daemon answered something else: {outcome:?}");
        return Err(Failure::new(exit_code::FAILURE, sentence));
    };
    output.answer(&report, || {
        let ImportReport {
            n_views,
            n_views_changed,
            n_documents,
            sequence,
        } = report;
        format!(
            "imported {n_views} view(s) and {n_documents} document(s): {n_views_changed} view(s) \
             are new or changed, history {sequence}, on disk"
        )
    });
    Ok(ExitCode::SUCCESS)
}

/// Reads the whole file once, so that a damaged one is told before anything is sent.
fn check(path: &Path) -> Result<(), Failure> {
    let file = File::open(path).map_err(|error| file_failed("opened", path, &error))?;
    let refused = |error| {
        let sentence = format!("{} cannot be imported: {error}", path.display());
        Failure::new(exit_code::REFUSED, sentence)
    };
    let mut reader = PortableReader::new(BufReader::new(file)).map_err(refused)?;
    while reader.batch().map_err(refused)?.is_some() {}
    Ok(())
}

fn upload(memory: &mut MemoryAccess, path: &Path, output: &Output) -> Result<u64, Failure> {
    let failed = |error: std::io::Error| file_failed("read", path, &error);
    let mut file = File::open(path).map_err(failed)?;
    let n_bytes = file.metadata().map_err(failed)?.len();
    let job = memory.begin(JobKind::Import)?.job;
    let bar = progress::bar(n_bytes, "bytes sent", output);
    let mut offset = 0;
    loop {
        let mut bytes = Vec::with_capacity(WRITE_BYTES);
        let part = Read::by_ref(&mut file).take(WRITE_BYTES as u64);
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
