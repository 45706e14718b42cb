//! Recovery of a recording that was cut or damaged: all intact messages in a new file.

use crate::{
    Error, FORMAT_VERSION, MessageTime, ReadSummary, RecordingMetadata, RecordingReader,
    RecordingWriter, TopicInfo,
};
use message::service_name::CAMERA_CLOUD;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::{Read, Write};

/// Result of a recovery: what was kept and what was lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecoveryReport {
    /// Summary of reading the damaged file.
    pub read: ReadSummary,
    /// Number of frames among the messages.
    pub n_frames: u64,
    /// Time from the first to the last message, nanoseconds.
    pub duration_ns: u64,
    /// Error of the medium that ended the reading; empty when there was none.
    pub read_error: String,
}

/// Writes all intact messages of a recording of `file_bytes` bytes into a new one.
///
/// # Errors
/// When the output cannot be written, or the input is no MCAP file. A damaged input is no error,
/// nor is one that can be read only up to some place: what is before it is kept.
pub fn recover(
    input: impl Read,
    file_bytes: u64,
    output: impl Write,
) -> Result<RecoveryReport, Error> {
    let mut reader = RecordingReader::new(input, file_bytes);
    let mut writer = RecordingWriter::without_metadata(output)?;
    let mut channels = BTreeMap::new();
    let mut n_frames = 0;
    let mut all = TopicInfo::default();
    let read_error = loop {
        match reader.advance() {
            Ok(true) => {}
            Ok(false) => break String::new(),
            Err(Error::Read(error)) => break error.to_string(),
            Err(error) => return Err(error),
        }
        if channels.is_empty() {
            writer.write_metadata(&metadata(&reader))?;
        }
        let Some(message) = reader.message() else {
            break String::new();
        };
        n_frames += u64::from(message.channel.topic == CAMERA_CLOUD);
        all.add(message.log_ns, message.data.len());
        let channel = match channels.entry(message.channel_id) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(writer.define(message.channel)?),
        };
        let time = MessageTime {
            log_ns: message.log_ns,
            publish_ns: message.publish_ns,
        };
        writer.write_to(channel, time, message.data)?;
    };
    writer.finish()?;
    Ok(RecoveryReport {
        read: reader.summary(),
        n_frames,
        duration_ns: all.duration_ns(),
        read_error,
    })
}

/// Metadata of the new file: those of the damaged one, if they are intact.
fn metadata<R: Read>(reader: &RecordingReader<R>) -> RecordingMetadata {
    let unknown = || RecordingMetadata {
        format_version: FORMAT_VERSION,
        origin: "recovered".into(),
    };
    reader.metadata().cloned().unwrap_or_else(unknown)
}
