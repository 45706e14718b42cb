//! `tabula record --info`: time range, topics, gaps and completeness of a recording.

use crate::losses::LossDocument;
use command_line::{Output, format_table};
use recording::{RecordingInfo, TopicInfo};
use serde::Serialize;
use service::Failure;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::process::ExitCode;

/// Statistics of a recording as a JSON document.
#[derive(Debug, Serialize)]
struct InfoDocument {
    file: String,
    bytes: u64,
    /// Name of the recorded daemon; null in a file that is no recording of `tabula record`.
    origin: Option<String>,
    format_version: Option<u32>,
    was_complete: bool,
    seconds: f64,
    first_ns: Option<u64>,
    last_ns: Option<u64>,
    messages: u64,
    gaps: u64,
    missing_frames: u64,
    #[serde(flatten)]
    losses: LossDocument,
    topics: Vec<TopicDocument>,
}

/// Statistics of one topic.
#[derive(Debug, Serialize)]
struct TopicDocument {
    topic: String,
    messages: u64,
    bytes: u64,
    rate_hz: Option<f64>,
}

/// Reads a recording and prints its statistics.
pub(crate) fn run(file: &Path, output: &Output) -> Result<ExitCode, Failure> {
    let document = described(file)?;
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

fn described(file: &Path) -> Result<InfoDocument, Failure> {
    let failed = |error: &dyn std::fmt::Display| {
        Failure::general(format!("{} cannot be described: {error}", file.display()))
    };
    let opened = File::open(file).and_then(|file| Ok((file.metadata()?.len(), file)));
    let (n_bytes, opened) =
        opened.map_err(|error| failed(&format!("{error}; name a recording")))?;
    let info = RecordingInfo::read(BufReader::new(opened), n_bytes);
    Ok(document(
        file,
        n_bytes,
        info.map_err(|error| failed(&error))?,
    ))
}

fn document(file: &Path, bytes: u64, info: RecordingInfo) -> InfoDocument {
    let metadata = info.metadata;
    let span_ns = info.all.span_ns;
    let seconds = info.all.seconds();
    InfoDocument {
        file: file.display().to_string(),
        bytes,
        format_version: metadata.as_ref().map(|metadata| metadata.format_version),
        origin: metadata.map(|metadata| metadata.origin),
        was_complete: info.read.is_complete,
        seconds,
        first_ns: span_ns.map(|(first, _)| first),
        last_ns: span_ns.map(|(_, last)| last),
        messages: info.all.n_messages,
        gaps: info.n_gaps,
        missing_frames: info.n_missing_frames,
        losses: info.read.into(),
        topics: info
            .topics
            .into_iter()
            .map(|named| topic(named, seconds))
            .collect(),
    }
}

fn topic((topic, info): (String, TopicInfo), recording_s: f64) -> TopicDocument {
    TopicDocument {
        topic,
        messages: info.n_messages,
        bytes: info.n_bytes,
        rate_hz: info.rate_hz(recording_s),
    }
}

fn text(document: &InfoDocument) -> String {
    let mut lines = vec![format!(
        "{:.1} s, {} messages, {:.1} MB, {}",
        document.seconds,
        document.messages,
        document.bytes as f64 * 1e-6,
        if document.was_complete {
            "closed"
        } else {
            "not closed"
        },
    )];
    if let (Some(origin), Some(version)) = (&document.origin, document.format_version) {
        lines.push(format!("recorded in the domain {origin}, format {version}"));
    }
    if let (Some(first_ns), Some(last_ns)) = (document.first_ns, document.last_ns) {
        let [first_s, last_s] = [first_ns, last_ns].map(|ns| ns as f64 * 1e-9);
        lines.push(format!(
            "from {first_s:.3} to {last_s:.3}, seconds since 1970"
        ));
    }
    for (n, what) in [
        (
            document.missing_frames,
            "frame(s) are missing between others",
        ),
        (document.losses.damaged_chunks, "chunk(s) are damaged"),
        (
            document.losses.unsupported_chunks,
            "chunk(s) have another compression than zstd",
        ),
        (document.losses.damaged_records, "record(s) are damaged"),
        (
            document.losses.messages_without_channel,
            "message(s) have no channel",
        ),
        (document.losses.lost_bytes, "bytes at the end are lost"),
    ] {
        if n > 0 {
            lines.push(format!("{n} {what}"));
        }
    }
    let row = |topic: &TopicDocument| {
        vec![
            topic.topic.clone(),
            topic.messages.to_string(),
            topic.rate_hz.map_or("-".into(), |hz| format!("{hz:.1}")),
            format!("{:.1}", topic.bytes as f64 * 1e-6),
        ]
    };
    let rows: Vec<_> = document.topics.iter().map(row).collect();
    let heading = ["topic", "messages", "rate Hz", "MB unpacked"];
    lines.push(format_table(&heading, &rows));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::{MessageTime, RecordingWriter};
    use scene_document::HealthDocument;

    #[test]
    fn info_has_no_rate_of_messages_that_came_together_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let mut writer = RecordingWriter::new(File::create(&path).unwrap(), "kitchen").unwrap();
        let health = HealthDocument::default();
        let topics = [
            ("a", &[0, 10_000_000_000][..]),
            ("b", &[1, 2, 3]),
            ("c", &[5]),
        ];
        for (topic, stamps_ns) in topics {
            for &stamp_ns in stamps_ns {
                let time = MessageTime::at(stamp_ns);
                writer.write_document(topic, time, &health).unwrap();
            }
        }
        writer.finish().unwrap();
        drop(writer);
        let described = described(&path).unwrap();
        let rates: Vec<Option<f64>> = described.topics.iter().map(|topic| topic.rate_hz).collect();
        assert_eq!(rates, [Some(0.1), Some(0.2), None]);
    }

    #[test]
    fn info_describes_a_recording() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let mut writer = RecordingWriter::new(File::create(&path).unwrap(), "kitchen").unwrap();
        let health = HealthDocument::default();
        for ms in [0, 500, 1000] {
            let time = MessageTime::at(ms * 1_000_000);
            writer.write_document("health", time, &health).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        let text = text(&described(&path).unwrap());
        for part in [
            "1.0 s, 3 messages",
            "closed",
            "domain kitchen, format 1",
            "2.0",
        ] {
            assert!(text.contains(part), "{part} is missing:\n{text}");
        }
        let refused = described(folder.path()).unwrap_err();
        assert!(
            refused.sentence.contains("cannot be described"),
            "{refused}"
        );
    }
}
