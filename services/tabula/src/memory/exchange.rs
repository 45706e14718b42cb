//! `tabula memory export` and `tabula memory import`.

use crate::arguments::ImportArguments;
use crate::time::utc;
use command_line::{Output, progress_bar};
use control_client::{
    ImportError, ImportRequest, MemoryClient, author_or_user, import as import_file,
};
use control_protocol::{AheadDecision, ExportReport, ImportReport, JobOutcome, request};
use file_access::{OutputFile, check_output};
use rustix::fs::OFlags;
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::fs::File;
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

/// Polling period of an export that has no new bytes. Chosen.
const POLL_PERIOD: Duration = Duration::from_millis(20);

#[derive(Serialize)]
struct ExportDocument<'a> {
    file: &'a Path,
    #[serde(flatten)]
    report: ExportReport,
}

/// `tabula memory export`: the file gets its name when it is complete and on disk.
pub(super) fn export(
    common: &CommonArguments,
    file: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    check_output(file).map_err(Failure::usage)?;
    let mut memory = MemoryClient::open(common)?;
    let mut partial = OutputFile::create_private(file).map_err(Failure::general)?;
    let report = write_export(&mut memory, &mut partial, file, output)?;
    partial.finish().map_err(Failure::general)?;
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

fn write_export(
    memory: &mut MemoryClient,
    file: &mut OutputFile,
    path: &Path,
    output: &Output,
) -> Result<ExportReport, Failure> {
    let failed = |error: io::Error| file_failed("written", path, &error);
    let begun = memory.ask(&request::export())?;
    let bar = progress_bar(begun.total, "views", output);
    let mut offset = 0;
    let report = loop {
        // Asked before reading: once the job has ended, the bytes read next are the last ones.
        let report = memory.ask(&request::job(begun.job))?;
        bar.set_length(report.total);
        bar.set_position(report.done);
        let bytes = memory.ask(&request::read_job(begun.job, offset))?;
        file.write_all(&bytes).map_err(failed)?;
        offset += bytes.len() as u64;
        match report.outcome {
            Some(JobOutcome::Exported(report)) if offset == report.bytes => break report,
            Some(JobOutcome::Failed(why)) => return Err(Failure::general(why)),
            _ if bytes.is_empty() => std::thread::sleep(POLL_PERIOD),
            _ => {}
        }
    };
    bar.finish_and_clear();
    Ok(report)
}

/// Failure of a file, which could not be written or the like.
fn file_failed(doing: &str, file: &Path, error: &io::Error) -> Failure {
    let sentence = format!("{} could not be {doing}: {error}", file.display());
    Failure::general(sentence)
}

/// Opens a regular file for reading. A pipe is refused: opening it waits for a writer, and the
/// size of its content is unknown.
fn open_file(path: &Path) -> Result<File, Failure> {
    let failed = |error: io::Error| file_failed("opened", path, &error);
    let opened = File::options()
        .read(true)
        .custom_flags(OFlags::NONBLOCK.bits().cast_signed())
        .open(path);
    let file = opened.map_err(failed)?;
    if file.metadata().map_err(failed)?.is_file() {
        return Ok(file);
    }
    let sentence = format!(
        "{} is not a regular file; write the export into a file, and name that",
        path.display()
    );
    Err(Failure::usage(sentence))
}

/// Runs `tabula memory import`.
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
            Failure::usage(sentence)
        })
    });
    let renames = renames.collect::<Result<Vec<_>, _>>()?;
    let mut file = open_file(&arguments.file)?;
    let mut memory = MemoryClient::open_or_create(common)?;
    let source = arguments.file.file_name().unwrap_or_default();
    let request = ImportRequest {
        author: author_or_user(arguments.author.as_deref()),
        source: source.to_string_lossy().into_owned(),
        renames,
        prefix: arguments.prefix.clone(),
        is_new: arguments.is_new,
        restamp: arguments.restamp,
    };
    let imported = import_file(&mut memory, &mut file, request, output);
    let report = imported.map_err(|error| match error {
        ImportError::RefusedFile(reason) => {
            let sentence = format!("{} cannot be imported: {reason}", arguments.file.display());
            Failure::new(exit_code::REFUSED, sentence)
        }
        ImportError::Failure(failure) => failure,
    })?;
    output.answer(&report, || import_text(&report));
    Ok(ExitCode::SUCCESS)
}

fn import_text(report: &ImportReport) -> String {
    let ImportReport {
        n_views,
        n_views_changed,
        n_documents,
        sequence,
        n_left_out,
        n_restamped,
        ahead,
    } = report;
    let mut lines = Vec::new();
    if *n_left_out > 0 {
        lines.push(format!(
            "left out {n_left_out} of them, decided more than a day ahead of this robot's clock; set \
             the clock that is wrong and import again, or with --restamp, which gives them the \
             present time:"
        ));
    }
    if *n_restamped > 0 {
        lines.push(format!(
            "gave {n_restamped} of them, decided more than a day ahead of this robot's clock, the \
             present time:"
        ));
    }
    lines.extend(ahead.iter().map(|decision| {
        let AheadDecision {
            what,
            author,
            decided_ns,
        } = decision;
        format!("- {what}, decided by {author}, {}", utc(*decided_ns))
    }));
    let n_more = (n_left_out + n_restamped).saturating_sub(ahead.len() as u64);
    if n_more > 0 {
        lines.push(format!("- and {n_more} more"));
    }
    lines.insert(
        0,
        format!(
            "imported {n_views} view(s) and {n_documents} document(s): {n_views_changed} view(s) \
             are new or changed, history {sequence}, on disk"
        ),
    );
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, Mode, mknodat};

    #[test]
    fn pipe_or_folder_is_no_file_to_import() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        mknodat(CWD, &pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        for path in [pipe.as_path(), folder.path()] {
            let failure = open_file(path).unwrap_err();
            assert_eq!(failure.code, exit_code::USAGE);
            assert!(
                failure.sentence.contains("is not a regular file"),
                "{failure}"
            );
        }
        let file = folder.path().join("file");
        std::fs::write(&file, "x").unwrap();
        assert!(open_file(&file).is_ok());
    }
}
