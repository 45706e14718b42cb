//! Reader of a recording, front to back. Damaged chunks are left out and counted.

use crate::Error;
use crate::record_source::{
    ChunkRecords, NextRecord, RecordSource, chunk_content_bytes, content_limit, record_limit,
};
use mcap::records::{Record, op};
use std::collections::BTreeMap;
use std::io::Read;
use std::sync::Arc;

/// Channel of a recording as the file defines it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedChannel {
    /// Topic of the channel.
    pub topic: String,
    /// Encoding of its messages.
    pub message_encoding: String,
    /// Name of the schema; empty without one.
    pub schema_name: String,
    /// Encoding of the schema.
    pub schema_encoding: String,
    /// Schema in its encoding.
    pub schema: Vec<u8>,
}

/// Message of a recording.
#[derive(Debug)]
pub struct RecordedMessage<'a> {
    /// Channel of the message.
    pub channel: &'a Arc<RecordedChannel>,
    /// Time at which it was recorded, nanoseconds of the wall clock.
    pub log_ns: u64,
    /// Time at which it was published, nanoseconds of the wall clock.
    pub publish_ns: u64,
    /// Content in the channel's encoding.
    pub data: &'a [u8],
}

/// Summary of what a reader has found so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReadSummary {
    /// Number of messages.
    pub n_messages: u64,
    /// Number of intact chunks.
    pub n_chunks: u64,
    /// Number of chunks left out because they are damaged.
    pub n_damaged_chunks: u64,
    /// Number of messages left out because their channel is not defined.
    pub n_without_channel: u64,
    /// True when the writer has closed the file; known at its end.
    pub is_complete: bool,
    /// Length of the file behind the last record that could be found, bytes; known at its end.
    pub lost_bytes: u64,
}

/// Schema of a recording: name, encoding, content.
#[derive(Debug, Clone)]
struct RecordedSchema {
    name: String,
    encoding: String,
    data: Vec<u8>,
}

/// Reader of a recording. Its memory is bounded by the largest record, and that by the length of
/// the file.
pub struct RecordingReader<R> {
    records: RecordSource<R>,
    chunk: Option<ChunkRecords>,
    schemas: BTreeMap<u16, RecordedSchema>,
    channels: BTreeMap<u16, Arc<RecordedChannel>>,
    /// Content of the newest record.
    content: Vec<u8>,
    record_limit: usize,
    /// Size that the contents of the chunks to come may have, bytes.
    content_left: u64,
    file_bytes: u64,
    summary: ReadSummary,
}

/// Message whose data is a part of the newest record.
struct FoundMessage {
    channel_id: u16,
    log_ns: u64,
    publish_ns: u64,
    data_begin: usize,
}

impl<R: Read> RecordingReader<R> {
    /// Reader of a file of this length, bytes.
    pub fn new(input: R, file_bytes: u64) -> Self {
        let record_limit = record_limit(file_bytes);
        Self {
            records: RecordSource::new(input, record_limit),
            chunk: None,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            content: Vec::new(),
            record_limit,
            content_left: content_limit(file_bytes),
            file_bytes,
            summary: ReadSummary::default(),
        }
    }

    /// Next message; `None` at the end of the file, or of what can be read of it.
    ///
    /// # Errors
    /// When the file cannot be read, or is no MCAP file.
    pub fn next_message(&mut self) -> Result<Option<RecordedMessage<'_>>, Error> {
        let Some(found) = self.find_message()? else {
            return Ok(None);
        };
        let Some(channel) = self.channels.get(&found.channel_id) else {
            // `find_message` finds only messages with a channel.
            return Ok(None);
        };
        Ok(Some(RecordedMessage {
            channel,
            log_ns: found.log_ns,
            publish_ns: found.publish_ns,
            data: &self.content[found.data_begin..],
        }))
    }

    /// Summary of what was found so far.
    pub fn summary(&self) -> ReadSummary {
        self.summary
    }

    fn find_message(&mut self) -> Result<Option<FoundMessage>, Error> {
        loop {
            let Some(opcode) = self.next_record()? else {
                return Ok(None);
            };
            if let Some(found) = self.take_record(opcode) {
                return Ok(Some(found));
            }
        }
    }

    /// Reads the next record of the current chunk or of the file, and returns its code.
    fn next_record(&mut self) -> Result<Option<u8>, Error> {
        if let Some(chunk) = &mut self.chunk {
            match chunk.next(&mut self.content) {
                Ok(Some(opcode)) => return Ok(Some(opcode)),
                Ok(None) => self.summary.n_chunks += 1,
                Err(_) => self.summary.n_damaged_chunks += 1,
            }
            self.chunk = None;
        }
        let next = self.records.next(&mut self.content)?;
        match next {
            NextRecord::Record(opcode) => return Ok(Some(opcode)),
            NextRecord::End => self.summary.is_complete = true,
            NextRecord::Cut | NextRecord::Damaged => {
                let n_intact = self.records.n_intact();
                self.summary.lost_bytes = self.file_bytes.saturating_sub(n_intact);
            }
        }
        Ok(None)
    }

    /// Takes a definition, begins a chunk, or finds a message.
    fn take_record(&mut self, opcode: u8) -> Option<FoundMessage> {
        if opcode == op::CHUNK {
            self.begin_chunk();
            return None;
        }
        // Other records are not parsed: nothing depends on them.
        if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
            return None;
        }
        match mcap::parse_record(opcode, &self.content) {
            Ok(Record::Schema { header, data }) => {
                let schema = RecordedSchema {
                    name: header.name,
                    encoding: header.encoding,
                    data: data.into_owned(),
                };
                self.schemas.insert(header.id, schema);
                None
            }
            Ok(Record::Channel(channel)) => {
                self.define(&channel);
                None
            }
            Ok(Record::Message { header, data }) => {
                if !self.channels.contains_key(&header.channel_id) {
                    self.summary.n_without_channel += 1;
                    return None;
                }
                self.summary.n_messages += 1;
                Some(FoundMessage {
                    channel_id: header.channel_id,
                    log_ns: header.log_time,
                    publish_ns: header.publish_time,
                    data_begin: self.content.len() - data.len(),
                })
            }
            _ => None,
        }
    }

    /// Begins to read a chunk, unless it holds more than the length of the file accounts for.
    fn begin_chunk(&mut self) {
        let content_bytes = chunk_content_bytes(&self.content);
        let is_sound =
            |bytes: &u64| *bytes <= self.record_limit as u64 && *bytes <= self.content_left;
        match content_bytes.filter(is_sound) {
            Some(content_bytes) => {
                self.content_left -= content_bytes;
                self.chunk = Some(ChunkRecords::new(&self.content, self.record_limit));
            }
            None => self.summary.n_damaged_chunks += 1,
        }
    }

    fn define(&mut self, channel: &mcap::records::Channel) {
        let schema = self.schemas.get(&channel.schema_id).cloned();
        let schema = schema.unwrap_or_else(|| RecordedSchema {
            name: String::new(),
            encoding: String::new(),
            data: Vec::new(),
        });
        let recorded = RecordedChannel {
            topic: channel.topic.clone(),
            message_encoding: channel.message_encoding.clone(),
            schema_name: schema.name,
            schema_encoding: schema.encoding,
            schema: schema.data,
        };
        self.channels.insert(channel.id, Arc::new(recorded));
    }
}
