//! `tabula record --recover`: writes all that is intact in a recording into a new file.

use crate::losses::LossDocument;
use command_line::Output;
use recording::{Error, RecoveryReport, recover};
use serde::Serialize;
use service::Failure;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Ending of the new file when none is given.
const RECOVERED: &str = "recovered.mcap";

/// Recovery as a JSON document.
#[derive(Debug, Serialize)]
struct RecoveredDocument {
    file: String,
    was_complete: bool,
    frames: u64,
    messages: u64,
    seconds: f64,
    #[serde(flatten)]
    losses: LossDocument,
    /// Error of the medium behind what was kept; empty without one.
    read_error: String,
}

/// Recovers a recording.
pub(crate) fn run(
    damaged: &Path,
    out: Option<&Path>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let out = out.map_or_else(|| recovered_path(damaged), Path::to_owned);
    let document = recover_file(damaged, &out)?;
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

fn recover_file(damaged: &Path, out: &Path) -> Result<RecoveredDocument, Failure> {
    let (input, file_bytes) = opened(damaged)?;
    let created = File::options().write(true).create_new(true).open(out);
    let mut file = created.map_err(|error| {
        Failure::general(format!(
            "could not create {}: {error}; name another file with --out",
            out.display()
        ))
    })?;
    let recovered = recover_into(input, file_bytes, &mut file);
    let report = recovered.map_err(|error| {
        Failure::general(format!(
            "{} could not be recovered into {}: {error}",
            damaged.display(),
            out.display()
        ))
    });
    let report = report.and_then(|report| check_kept(damaged, report));
    // Without a message, or cut by a full disk, the file is no recovered recording; the damaged
    // one is as it was.
    let report = report.inspect_err(|_| drop(std::fs::remove_file(out)))?;
    Ok(document(out, report))
}

fn opened(damaged: &Path) -> Result<(File, u64), Failure> {
    let input = File::open(damaged);
    let opened = input.and_then(|input| Ok((input.metadata()?.len(), input)));
    let (n_bytes, input) = opened.map_err(|error| {
        Failure::general(format!(
            "could not read {}: {error}; name the recording to recover",
            damaged.display()
        ))
    })?;
    Ok((input, n_bytes))
}

/// Writes all that is intact, and waits until it is on disk.
fn recover_into(
    input: impl Read,
    file_bytes: u64,
    file: &mut File,
) -> Result<RecoveryReport, Error> {
    let mut writer = BufWriter::new(&mut *file);
    let report = recover(BufReader::new(input), file_bytes, &mut writer)?;
    writer.flush().map_err(Error::Write)?;
    drop(writer);
    file.sync_all().map_err(Error::Write)?;
    Ok(report)
}

fn check_kept(damaged: &Path, report: RecoveryReport) -> Result<RecoveryReport, Failure> {
    if report.read.n_messages > 0 {
        return Ok(report);
    }
    let reason = match (unread_sentence(&report), report.read_error.as_str()) {
        (Some(sentence), _) => sentence,
        (None, "") => "keep the file if it is the only copy".to_owned(),
        (None, error) => format!("{error}; copy the file to another disk and try again"),
    };
    Err(Failure::general(format!(
        "no message of {} could be recovered: {reason}",
        damaged.display()
    )))
}

/// Sentence about chunks in a compression that is not read; `None` without any.
fn unread_sentence(report: &RecoveryReport) -> Option<String> {
    let n = report.read.n_unsupported_chunks;
    (n > 0).then(|| {
        format!(
            "{n} chunk(s) are compressed with lz4, or otherwise as this program does not read; \
             convert the recording first with `mcap compress FILE -o NEW --compression zstd`"
        )
    })
}

/// Path beside the damaged recording: `a.recovered.mcap` for `a.mcap.active` and `a.mcap`.
fn recovered_path(damaged: &Path) -> PathBuf {
    let name = damaged.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(".active").unwrap_or(&name);
    let stem = stem.strip_suffix(".mcap").unwrap_or(stem);
    damaged.with_file_name(format!("{stem}.{RECOVERED}"))
}

fn document(out: &Path, report: RecoveryReport) -> RecoveredDocument {
    let RecoveryReport {
        read,
        n_frames,
        duration_ns,
        read_error,
    } = report;
    RecoveredDocument {
        file: out.display().to_string(),
        was_complete: read.is_complete,
        frames: n_frames,
        messages: read.n_messages,
        seconds: duration_ns as f64 * 1e-9,
        losses: read.into(),
        read_error,
    }
}

fn text(document: &RecoveredDocument) -> String {
    let RecoveredDocument {
        file,
        was_complete,
        frames,
        messages,
        seconds,
        losses,
        read_error,
    } = document;
    let LossDocument {
        damaged_chunks,
        unsupported_chunks,
        damaged_records,
        messages_without_channel,
        lost_bytes,
    } = losses;
    let state = if *was_complete {
        "the recording was closed"
    } else {
        "the recording was cut"
    };
    let mut lines = vec![format!(
        "{state}; kept {messages} messages, {frames} of them frames, of {seconds:.1} s; lost \
         {damaged_chunks} damaged chunk(s), {messages_without_channel} message(s) of channels \
         that are not defined, and {lost_bytes} bytes at the end"
    )];
    for (n, loss) in [
        (
            unsupported_chunks,
            "chunk(s) in another compression than zstd were left out",
        ),
        (damaged_records, "record(s) were damaged"),
    ] {
        if *n > 0 {
            lines.push(format!("{n} {loss}"));
        }
    }
    if !read_error.is_empty() {
        lines.push(format!("the rest could not be read: {read_error}"));
    }
    lines.push(file.clone());
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovered_file_is_beside_the_damaged_one() {
        for name in [
            "a/left-7-0001.mcap.active",
            "a/left-7-0001.mcap",
            "a/left-7-0001",
        ] {
            let path = recovered_path(Path::new(name));
            assert_eq!(path, Path::new("a/left-7-0001.recovered.mcap"));
        }
    }
    /// Recovers bytes into a file; returns its path and the number of messages.
    fn recovered(folder: &Path, bytes: &[u8]) -> (PathBuf, Result<u64, Failure>) {
        let (damaged, out) = (folder.join("a.mcap"), folder.join("b.mcap"));
        std::fs::write(&damaged, bytes).unwrap();
        let outcome = recover_file(&damaged, &out);
        (out, outcome.map(|document| document.messages))
    }

    fn recording() -> Vec<u8> {
        let mut file = Vec::new();
        let mut writer = recording::RecordingWriter::new(&mut file, "test").unwrap();
        let health = scene_document::HealthDocument::default();
        let time = recording::MessageTime::at(1);
        writer.write_document("health", time, &health).unwrap();
        writer.finish().unwrap();
        drop(writer);
        file
    }

    #[test]
    fn recovery_without_a_message_fails_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let (out, outcome) = recovered(folder.path(), &recording());
        assert!(outcome == Ok(1) && out.exists());
        std::fs::remove_file(&out).unwrap();
        let (out, outcome) = recovered(folder.path(), &recording()[..8]);
        let sentence = outcome.unwrap_err().sentence;
        assert!(sentence.contains("no message"), "{sentence}");
        assert!(!out.exists());
        let mut other = recording();
        let names: Vec<usize> = (0..other.len() - 4)
            .filter(|&at| &other[at..at + 4] == b"zstd")
            .collect();
        for at in names {
            other[at..at + 4].copy_from_slice(b"lzma");
        }
        let (_, outcome) = recovered(folder.path(), &other);
        let sentence = outcome.unwrap_err().sentence;
        assert!(sentence.contains("convert the recording"), "{sentence}");
    }
}
