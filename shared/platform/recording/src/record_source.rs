//! Records of an MCAP file, front to back, out of bytes that may be cut or damaged.

use crate::Error;
use mcap::records::op;
use std::io::Read;

/// Bytes of a record's code and length.
pub(crate) const RECORD_HEAD_BYTES: usize = 9;
/// Bytes of the record that ends the data.
const DATA_END_BYTES: usize = 4;
/// Bytes of the last record.
const FOOTER_BYTES: usize = 20;
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

/// Result of reading the next record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NextRecord {
    /// Code of the record, whose content is in the buffer.
    Record(u8),
    /// End of the file, as a writer that closed it leaves it.
    End,
    /// End of what can be read: the bytes behind it are no whole record.
    Cut,
}

/// Reader of the records between the chunks, and of whole chunks.
pub(crate) struct RecordSource<R> {
    input: R,
    record_limit: usize,
    has_begun: bool,
    /// True behind the record that ends the data.
    has_data_end: bool,
    ended: Option<NextRecord>,
    /// Length of the file up to the end of the last whole record, bytes.
    n_intact: u64,
}

impl<R: Read> RecordSource<R> {
    pub(crate) fn new(input: R, record_limit: usize) -> Self {
        Self {
            input,
            record_limit,
            has_begun: false,
            has_data_end: false,
            ended: None,
            n_intact: 0,
        }
    }

    /// Reads the next record into the buffer.
    ///
    /// # Errors
    /// When the input cannot be read, or does not begin as an MCAP file.
    pub(crate) fn next(&mut self, content: &mut Vec<u8>) -> Result<NextRecord, Error> {
        if let Some(ended) = self.ended {
            return Ok(ended);
        }
        if !self.has_begun {
            self.begin(content)?;
        }
        let next = match self.read_record(content)? {
            Some(op::FOOTER) if self.has_data_end && content.len() == FOOTER_BYTES => {
                self.read_end(content)?
            }
            Some(opcode) => {
                self.has_data_end |= opcode == op::DATA_END && content.len() == DATA_END_BYTES;
                return Ok(NextRecord::Record(opcode));
            }
            None => NextRecord::Cut,
        };
        self.ended = Some(next);
        Ok(next)
    }

    fn begin(&mut self, content: &mut Vec<u8>) -> Result<(), Error> {
        self.read(mcap::MAGIC.len() as u64, content)?;
        if content != mcap::MAGIC {
            return Err(Error::NotMcap);
        }
        self.n_intact += content.len() as u64;
        self.has_begun = true;
        Ok(())
    }

    /// Reads a whole record and returns its code; `None` when the bytes are none.
    fn read_record(&mut self, content: &mut Vec<u8>) -> Result<Option<u8>, Error> {
        self.read(RECORD_HEAD_BYTES as u64, content)?;
        let Some((opcode, length)) = record_head(content) else {
            return Ok(None);
        };
        // A file system may fill with zeros what it had not written before a loss of power.
        if length > self.record_limit as u64 || (opcode, length) == (0, 0) {
            return Ok(None);
        }
        self.read(length, content)?;
        if (content.len() as u64) < length {
            return Ok(None);
        }
        self.n_intact += RECORD_HEAD_BYTES as u64 + length;
        Ok(Some(opcode))
    }

    /// Reads the last bytes of the file.
    fn read_end(&mut self, content: &mut Vec<u8>) -> Result<NextRecord, Error> {
        self.read(mcap::MAGIC.len() as u64 + 1, content)?;
        if content != mcap::MAGIC {
            return Ok(NextRecord::Cut);
        }
        self.n_intact += content.len() as u64;
        Ok(NextRecord::End)
    }

    /// Reads `n` bytes, or what is left of them, into the buffer, which grows with what there is.
    fn read(&mut self, n: u64, content: &mut Vec<u8>) -> Result<(), Error> {
        content.clear();
        let read = self.input.by_ref().take(n).read_to_end(content);
        read.map_err(Error::Read)?;
        Ok(())
    }

    /// Length of the file up to the end of the last whole record, bytes.
    pub(crate) fn n_intact(&self) -> u64 {
        self.n_intact
    }
}

/// Code and length of the record at the beginning of these bytes; `None` when they are too few.
pub(crate) fn record_head(bytes: &[u8]) -> Option<(u8, u64)> {
    let (&opcode, rest) = bytes.split_first()?;
    let length = rest.first_chunk()?;
    Some((opcode, u64::from_le_bytes(*length)))
}

/// True if a record of which nothing else is used can be what its code says.
pub(crate) fn is_plausible(opcode: u8, content: &[u8], is_in_chunk: bool) -> bool {
    /// Code of the first record that is left to programs.
    const PRIVATE: u8 = 0x80;
    match opcode {
        PRIVATE.. => true,
        _ if is_in_chunk => false,
        op::DATA_END => content.len() == DATA_END_BYTES,
        op::FOOTER => content.len() == FOOTER_BYTES,
        op::HEADER
        | op::MESSAGE_INDEX
        | op::CHUNK_INDEX
        | op::ATTACHMENT
        | op::ATTACHMENT_INDEX
        | op::STATISTICS
        | op::METADATA
        | op::METADATA_INDEX
        | op::SUMMARY_OFFSET => true,
        _ => false,
    }
}
