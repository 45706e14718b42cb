//! Reader of a recording, front to back. Damaged chunks are left out and counted.

use crate::chunk_records::{ChunkRecords, UnreadableChunk, is_compressed_chunk};
use crate::definitions::{Definitions, REPEATED_DEFINITIONS};
use crate::record_source::{NextRecord, RecordSource, content_limit, is_plausible, record_limit};
use crate::{Error, RecordedChannel, RecordingMetadata};
use mcap::records::{Record, op};
use std::io::Read;

/// Message of a recording.
#[derive(Debug)]
pub struct RecordedMessage<'a> {
    /// Id of the channel in the file.
    pub channel_id: u16,
    /// Channel of the message.
    pub channel: &'a RecordedChannel,
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
    /// Number of chunks left out because of a compression that is not read, such as lz4.
    pub n_unsupported_chunks: u64,
    /// Number of records that are not what their code says. A chunk among them is read.
    pub n_damaged_records: u64,
    /// Number of messages left out because their channel is not defined.
    pub n_without_channel: u64,
    /// True when the writer has closed the file; known at its end.
    pub is_complete: bool,
    /// Length of the file behind the last whole record, bytes: at the end, what is lost of it.
    pub lost_bytes: u64,
}

/// Reader of a recording. Its memory is bounded by the largest record, and that by the length of
/// the file.
pub struct RecordingReader<R> {
    records: RecordSource<R>,
    chunk: Option<ChunkRecords>,
    definitions: Definitions,
    metadata: Option<RecordingMetadata>,
    /// Content of the newest record.
    content: Vec<u8>,
    record_limit: usize,
    /// Size that the contents of the chunks to come may have, bytes.
    content_left: u64,
    file_bytes: u64,
    summary: ReadSummary,
    found: Option<FoundMessage>,
}

/// Message whose data is a part of the newest record.
#[derive(Debug)]
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
            definitions: Definitions::default(),
            metadata: None,
            found: None,
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
        self.advance()?;
        Ok(self.message())
    }

    /// Reads up to the next message; false at the end.
    ///
    /// # Errors
    /// As [`next_message`](Self::next_message).
    pub(crate) fn advance(&mut self) -> Result<bool, Error> {
        self.found = None;
        while self.found.is_none() {
            let Some(opcode) = self.next_record()? else {
                return Ok(false);
            };
            self.take_record(opcode);
        }
        Ok(true)
    }

    /// Message up to which the reader has read.
    pub(crate) fn message(&self) -> Option<RecordedMessage<'_>> {
        let found = self.found.as_ref()?;
        Some(RecordedMessage {
            channel_id: found.channel_id,
            channel: self.definitions.channel(found.channel_id)?,
            log_ns: found.log_ns,
            publish_ns: found.publish_ns,
            data: self.content.get(found.data_begin..)?,
        })
    }

    /// Metadata of the recording, once found; they precede its messages.
    pub fn metadata(&self) -> Option<&RecordingMetadata> {
        self.metadata.as_ref()
    }

    /// Summary of what was found so far.
    pub fn summary(&self) -> ReadSummary {
        self.summary
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
        let next = self.records.next(&mut self.content);
        let n_intact = self.records.n_intact();
        self.summary.lost_bytes = self.file_bytes.saturating_sub(n_intact);
        match next? {
            NextRecord::Record(opcode) => return Ok(Some(opcode)),
            NextRecord::End => self.summary.is_complete = true,
            NextRecord::Cut => {}
        }
        Ok(None)
    }

    /// Takes a definition, begins a chunk, or finds a message.
    fn take_record(&mut self, opcode: u8) {
        let is_in_chunk = self.chunk.is_some();
        let is_sound = match opcode {
            op::CHUNK if !is_in_chunk => {
                self.begin_chunk();
                true
            }
            _ if !is_in_chunk && is_compressed_chunk(&self.content) => {
                self.begin_chunk();
                false
            }
            op::MESSAGE => self.take_message(),
            op::SCHEMA | op::CHANNEL => self.definitions.add(opcode, &self.content),
            op::METADATA if !is_in_chunk => {
                let metadata = RecordingMetadata::parse(&self.content);
                self.metadata = self.metadata.take().or(metadata);
                true
            }
            REPEATED_DEFINITIONS => self.definitions.add_repeated(&self.content),
            _ => is_plausible(opcode, &self.content, is_in_chunk),
        };
        self.summary.n_damaged_records += u64::from(!is_sound);
    }

    /// Takes a message; false when it is damaged.
    fn take_message(&mut self) -> bool {
        let Ok(Record::Message { header, data }) = mcap::parse_record(op::MESSAGE, &self.content)
        else {
            return false;
        };
        if self.definitions.channel(header.channel_id).is_none() {
            self.summary.n_without_channel += 1;
            return true;
        }
        self.summary.n_messages += 1;
        self.found = Some(FoundMessage {
            channel_id: header.channel_id,
            log_ns: header.log_time,
            publish_ns: header.publish_time,
            data_begin: self.content.len() - data.len(),
        });
        true
    }

    /// Begins to read a chunk, unless it holds more than the length of the file accounts for.
    fn begin_chunk(&mut self) {
        let limit = self.content_left.min(self.record_limit as u64);
        match ChunkRecords::new(&self.content, limit) {
            Ok((records, n_bytes)) => {
                self.content_left -= n_bytes;
                self.chunk = Some(records);
            }
            Err(UnreadableChunk::Damaged) => self.summary.n_damaged_chunks += 1,
            Err(UnreadableChunk::Compression) => self.summary.n_unsupported_chunks += 1,
        }
    }
}
