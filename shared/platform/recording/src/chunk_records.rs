//! Records in one chunk, whose checksum is compared first.

use crate::record_source::{RECORD_HEAD_BYTES, record_head};
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// Compression of a chunk that is read; an empty name stands for none.
const ZSTD: &str = "zstd";
/// Bytes of a chunk's header without the name of its compression.
const HEADER_BYTES: usize = 40;

/// Reason why the records of a chunk cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum UnreadableChunk {
    /// Checksum, length or compressed bytes are wrong.
    Damaged,
    /// Its compression is none that this program reads.
    Compression,
}

/// True if the content of a record is that of a whole compressed chunk, whatever its code says.
pub(crate) fn is_compressed_chunk(content: &[u8]) -> bool {
    parse(content).is_some_and(|(header, data)| {
        let is_known = [ZSTD, "lz4"].contains(&header.compression.as_str());
        is_known && HEADER_BYTES + header.compression.len() + data.len() == content.len()
    })
}

fn parse(content: &[u8]) -> Option<(ChunkHeader, &[u8])> {
    match mcap::parse_record(op::CHUNK, content) {
        Ok(Record::Chunk { header, .. }) => {
            let begin = HEADER_BYTES + header.compression.len();
            let end = begin.checked_add(usize::try_from(header.compressed_size).ok()?)?;
            let data = content.get(begin..end)?;
            Some((header, data))
        }
        _ => None,
    }
}

/// Reader of the records in one chunk.
pub(crate) enum ChunkRecords {
    Plain(PlainRecords),
    Compressed(Box<CompressedRecords>),
}

impl ChunkRecords {
    /// Reader of a chunk, from the content of its record, and the size of what it holds, at most
    /// `limit`, bytes.
    ///
    /// # Errors
    /// When the chunk cannot be read; a damage of compressed bytes may be found later.
    pub(crate) fn new(content: &[u8], limit: u64) -> Result<(Self, u64), UnreadableChunk> {
        let (header, data) = parse(content).ok_or(UnreadableChunk::Damaged)?;
        let n_bytes = header.uncompressed_size;
        if n_bytes > limit {
            return Err(UnreadableChunk::Damaged);
        }
        let records = match header.compression.as_str() {
            "" if n_bytes == data.len() as u64 => {
                let plain = PlainRecords::new(data, header.uncompressed_crc);
                Self::Plain(plain.ok_or(UnreadableChunk::Damaged)?)
            }
            "" => return Err(UnreadableChunk::Damaged),
            ZSTD => Self::Compressed(Box::new(CompressedRecords::new(content, limit))),
            _ => return Err(UnreadableChunk::Compression),
        };
        Ok((records, n_bytes))
    }

    /// Reads the next record of the chunk into the buffer and returns its code; `None` at the end.
    ///
    /// # Errors
    /// When the chunk is damaged.
    pub(crate) fn next(&mut self, content: &mut Vec<u8>) -> Result<Option<u8>, UnreadableChunk> {
        match self {
            Self::Plain(plain) => plain.next(content),
            Self::Compressed(compressed) => compressed.next(content),
        }
    }
}

/// Reader of records that are not compressed.
pub(crate) struct PlainRecords {
    bytes: Vec<u8>,
    at: usize,
}

impl PlainRecords {
    /// Reader of records with this checksum, CRC-32; 0 stands for none. `None` when it is another.
    pub(crate) fn new(bytes: &[u8], crc: u32) -> Option<Self> {
        let is_sound = crc == 0 || crc32fast::hash(bytes) == crc;
        is_sound.then(|| Self {
            bytes: bytes.to_vec(),
            at: 0,
        })
    }

    /// As [`ChunkRecords::next`].
    pub(crate) fn next(&mut self, content: &mut Vec<u8>) -> Result<Option<u8>, UnreadableChunk> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let (opcode, length) = record_head(rest).ok_or(UnreadableChunk::Damaged)?;
        let length = usize::try_from(length).map_err(|_| UnreadableChunk::Damaged)?;
        let behind_head = rest.get(RECORD_HEAD_BYTES..).unwrap_or_default();
        let record = behind_head.get(..length).ok_or(UnreadableChunk::Damaged)?;
        content.clear();
        content.extend_from_slice(record);
        self.at += RECORD_HEAD_BYTES + length;
        Ok(Some(opcode))
    }
}

/// Reader of records compressed with zstd.
pub(crate) struct CompressedRecords {
    reader: LinearReader,
    /// Content of the chunk's record, with its code and length before it.
    record: Vec<u8>,
    n_given: usize,
}

impl CompressedRecords {
    fn new(content: &[u8], limit: u64) -> Self {
        let mut record = Vec::with_capacity(RECORD_HEAD_BYTES + content.len());
        record.push(op::CHUNK);
        record.extend((content.len() as u64).to_le_bytes());
        record.extend_from_slice(content);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(usize::try_from(limit).unwrap_or(usize::MAX));
        Self {
            reader: LinearReader::new_with_options(options),
            record,
            n_given: 0,
        }
    }

    fn next(&mut self, content: &mut Vec<u8>) -> Result<Option<u8>, UnreadableChunk> {
        loop {
            match self.reader.next_event() {
                None => return Ok(None),
                Some(Ok(LinearReadEvent::ReadRequest(n))) => {
                    let left = self.record.get(self.n_given..).unwrap_or_default();
                    let (given, _) = left.split_at(n.min(left.len()));
                    self.reader.insert(given.len()).copy_from_slice(given);
                    self.reader.notify_read(given.len());
                    self.n_given += given.len();
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    content.clear();
                    content.extend_from_slice(data);
                    return Ok(Some(opcode));
                }
                Some(Err(_)) => return Err(UnreadableChunk::Damaged),
            }
        }
    }
}
