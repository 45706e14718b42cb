//! Recovery of a recording that was cut or damaged: all intact messages in a new file.

use crate::{Error, MessageTime, ReadSummary, RecordingReader, RecordingWriter};
use message::service_name::CAMERA_CLOUD;
use std::io::{Read, Write};

/// Result of a recovery: what was kept and what was lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecoveryReport {
    /// Summary of reading the damaged file.
    pub read: ReadSummary,
    /// Number of frames among the messages.
    pub n_frames: u64,
    /// Time from the first to the last message, nanoseconds.
    pub duration_ns: u64,
}

/// Writes all intact messages of a recording of `file_bytes` bytes into a new one.
///
/// # Errors
/// When a file cannot be read or written, or the input is no MCAP file. A damaged input is no
/// error.
pub fn recover(
    input: impl Read,
    file_bytes: u64,
    output: impl Write,
) -> Result<RecoveryReport, Error> {
    let mut reader = RecordingReader::new(input, file_bytes);
    let mut writer = RecordingWriter::new(output, "recovered")?;
    let mut n_frames = 0;
    let mut span_ns: Option<(u64, u64)> = None;
    while let Some(message) = reader.next_message()? {
        n_frames += u64::from(message.channel.topic == CAMERA_CLOUD);
        let (first, last) = span_ns.unwrap_or((message.log_ns, message.log_ns));
        span_ns = Some((first.min(message.log_ns), last.max(message.log_ns)));
        let time = MessageTime {
            log_ns: message.log_ns,
            publish_ns: message.publish_ns,
        };
        writer.add_raw_channel(message.channel)?;
        writer.write(&message.channel.topic, time, message.data)?;
    }
    writer.finish()?;
    Ok(RecoveryReport {
        read: reader.summary(),
        n_frames,
        duration_ns: span_ns.map_or(0, |(first, last)| last - first),
    })
}
