//! `tabula record --recover`: writes all that is intact in a recording into a new file.

use command_line::Output;
use recording::{RecoveryReport, recover};
use serde::Serialize;
use service::Failure;
use std::fs::File;
use std::io::{BufReader, BufWriter};
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
    damaged_chunks: u64,
    messages_without_channel: u64,
    lost_bytes: u64,
}

/// Recovers a recording.
pub(crate) fn run(
    damaged: &Path,
    out: Option<&Path>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let out = out.map_or_else(|| recovered_path(damaged), Path::to_owned);
    let failed = |path: &Path| {
        let path = path.display().to_string();
        move |error: std::io::Error| Failure::general(format!("{path}: {error}"))
    };
    let input = File::open(damaged).map_err(failed(damaged))?;
    let file_bytes = input.metadata().map_err(failed(damaged))?.len();
    let created = File::options().write(true).create_new(true).open(&out);
    let file = created.map_err(failed(&out))?;
    let report = recover(BufReader::new(input), file_bytes, BufWriter::new(file));
    let report = report.map_err(|error| {
        // Nothing was recovered: an empty file would look as if there was.
        let _ = std::fs::remove_file(&out);
        Failure::general(format!(
            "{} cannot be recovered: {error}",
            damaged.display()
        ))
    })?;
    let document = document(&out, &report);
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

/// Path beside the damaged recording: `a.recovered.mcap` for `a.mcap.active` and `a.mcap`.
fn recovered_path(damaged: &Path) -> PathBuf {
    let name = damaged.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(".active").unwrap_or(&name);
    let stem = stem.strip_suffix(".mcap").unwrap_or(stem);
    damaged.with_file_name(format!("{stem}.{RECOVERED}"))
}

fn document(out: &Path, report: &RecoveryReport) -> RecoveredDocument {
    RecoveredDocument {
        file: out.display().to_string(),
        was_complete: report.read.is_complete,
        frames: report.n_frames,
        messages: report.read.n_messages,
        seconds: report.duration_ns as f64 * 1e-9,
        damaged_chunks: report.read.n_damaged_chunks,
        messages_without_channel: report.read.n_without_channel,
        lost_bytes: report.read.lost_bytes,
    }
}

fn text(document: &RecoveredDocument) -> String {
    let RecoveredDocument {
        file,
        was_complete,
        frames,
        messages,
        seconds,
        damaged_chunks,
        messages_without_channel,
        lost_bytes,
    } = document;
    let state = if *was_complete {
        "the recording was closed"
    } else {
        "the recording was cut"
    };
    format!(
        "{state}; kept {messages} messages, {frames} of them frames, of {seconds:.1} s; lost \
         {damaged_chunks} damaged chunk(s), {messages_without_channel} message(s) of channels \
         that are not defined, and {lost_bytes} bytes at the end\n{file}"
    )
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
}
