//! Records of an MCAP file, front to back, out of bytes that may be cut or damaged.

use crate::Error;
use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::io::Read;

/// Bytes of a record's code and length.
const RECORD_HEAD_BYTES: usize = 9;
/// Bytes that are read at once.
const READ_BYTES: usize = 1 << 16;
/// Record that any file may have, bytes.
const ANY_RECORD_BYTES: u64 = 32 << 20;
/// Largest record for each byte of the file: an empty frame is compressed to a thousandth.
const RECORD_BYTES_PER_FILE_BYTE: u64 = 1024;
/// Content of all chunks for each byte of the file: black frames of 1.8 MB take 0.8 kB each,
/// with their index.
const CONTENT_BYTES_PER_FILE_BYTE: u64 = 8192;
/// Largest record of any file, bytes: a frame of 8192 x 8192 points.
const RECORD_BYTES_MAX: u64 = 8192 * 8192 * 16 + 4096;

/// Largest record that a file of this length may have, bytes, which bounds the memory of reading.
pub(crate) fn record_limit(file_bytes: u64) -> usize {
    let by_file = file_bytes.saturating_mul(RECORD_BYTES_PER_FILE_BYTE);
    by_file.clamp(ANY_RECORD_BYTES, RECORD_BYTES_MAX) as usize
}

/// Limit of what all chunks of a file of this length may hold, bytes, which bounds the time of
/// reading.
pub(crate) fn content_limit(file_bytes: u64) -> u64 {
    let by_file = file_bytes.saturating_mul(CONTENT_BYTES_PER_FILE_BYTE);
    by_file.saturating_add(ANY_RECORD_BYTES)
}

/// Size of a chunk's content by its header, bytes; `None` for a damaged header.
pub(crate) fn chunk_content_bytes(content: &[u8]) -> Option<u64> {
    match mcap::parse_record(op::CHUNK, content) {
        Ok(Record::Chunk { header, .. }) => Some(header.uncompressed_size),
        _ => None,
    }
}

/// Result of reading the next record.
#[derive(Debug)]
pub(crate) enum NextRecord {
    /// Code of the record, whose content is in the buffer.
    Record(u8),
    /// End of the records, as written by a writer that closed the file.
    End,
    /// End of the bytes within a record, or after the last whole one.
    Cut,
    /// Bytes that are no records: nothing behind them can be found.
    Damaged,
}

/// Reader of the records between the chunks, and of whole chunks.
pub(crate) struct RecordSource<R> {
    input: R,
    reader: LinearReader,
    n_read: u64,
    /// Length of the file up to the end of the last whole record, bytes.
    n_intact: u64,
    is_at_end: bool,
}

fn options(record_limit: usize) -> LinearReaderOptions {
    LinearReaderOptions::default()
        .with_skip_end_magic(true)
        .with_record_length_limit(record_limit)
}

impl<R: Read> RecordSource<R> {
    pub(crate) fn new(input: R, record_limit: usize) -> Self {
        Self {
            input,
            reader: LinearReader::new_with_options(options(record_limit).with_emit_chunks(true)),
            n_read: 0,
            n_intact: mcap::MAGIC.len() as u64,
            is_at_end: false,
        }
    }

    /// Reads the next record into the buffer.
    ///
    /// # Errors
    /// When the input cannot be read, or does not begin as an MCAP file.
    pub(crate) fn next(&mut self, content: &mut Vec<u8>) -> Result<NextRecord, Error> {
        loop {
            match self.reader.next_event() {
                None if self.n_read < mcap::MAGIC.len() as u64 => return Err(Error::NotMcap),
                None => return Ok(NextRecord::Cut),
                Some(Ok(LinearReadEvent::ReadRequest(n))) => {
                    let buffer = self.reader.insert(n.clamp(1, READ_BYTES));
                    let n = read_some(&mut self.input, buffer)?;
                    self.n_read += n as u64;
                    self.is_at_end |= n == 0;
                    self.reader.notify_read(n);
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    self.n_intact += (RECORD_HEAD_BYTES + data.len()) as u64;
                    if opcode == op::DATA_END || opcode == op::FOOTER {
                        return Ok(NextRecord::End);
                    }
                    content.clear();
                    content.extend_from_slice(data);
                    return Ok(NextRecord::Record(opcode));
                }
                Some(Err(McapError::BadMagic)) => return Err(Error::NotMcap),
                Some(Err(_)) if self.n_read < mcap::MAGIC.len() as u64 => {
                    return Err(Error::NotMcap);
                }
                Some(Err(_)) if self.is_at_end => return Ok(NextRecord::Cut),
                Some(Err(_)) => return Ok(NextRecord::Damaged),
            }
        }
    }

    /// Length of the file up to the end of the last whole record, bytes.
    pub(crate) fn n_intact(&self) -> u64 {
        self.n_intact
    }
}

/// Reads at least one byte, unless the input has ended.
fn read_some(input: &mut impl Read, buffer: &mut [u8]) -> Result<usize, Error> {
    loop {
        match input.read(buffer) {
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            read => return Ok(read?),
        }
    }
}

/// Reader of the records in one chunk, whose checksum is compared first.
pub(crate) struct ChunkRecords {
    reader: LinearReader,
    /// Content of the chunk's record, with its code and length before it.
    record: Vec<u8>,
    n_given: usize,
}

impl ChunkRecords {
    /// Reader of a chunk, from the content of its record.
    pub(crate) fn new(content: &[u8], record_limit: usize) -> Self {
        let mut record = Vec::with_capacity(RECORD_HEAD_BYTES + content.len());
        record.push(op::CHUNK);
        record.extend((content.len() as u64).to_le_bytes());
        record.extend_from_slice(content);
        let options = options(record_limit)
            .with_skip_start_magic(true)
            .with_prevalidate_chunk_crcs(true);
        Self {
            reader: LinearReader::new_with_options(options),
            record,
            n_given: 0,
        }
    }

    /// Reads the next record of the chunk into the buffer and returns its code; `None` at the end.
    ///
    /// # Errors
    /// When the chunk is damaged.
    pub(crate) fn next(&mut self, content: &mut Vec<u8>) -> Result<Option<u8>, McapError> {
        loop {
            match self.reader.next_event() {
                None => return Ok(None),
                Some(Ok(LinearReadEvent::ReadRequest(n))) => {
                    let left = &self.record[self.n_given..];
                    let n = n.min(left.len());
                    self.reader.insert(n).copy_from_slice(&left[..n]);
                    self.reader.notify_read(n);
                    self.n_given += n;
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    content.clear();
                    content.extend_from_slice(data);
                    return Ok(Some(opcode));
                }
                Some(Err(error)) => return Err(error),
            }
        }
    }
}
