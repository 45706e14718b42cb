//! Checksum verification of LevelDB files while they are read.
//!
//! rusty-leveldb reads a damaged block as a missing key or an older value, and a damaged log record
//! as the end of the log. Here every block is verified before it is returned, and a log is scanned
//! to its real end.
//!
//! Formats: LevelDB's `doc/table_format.md` and `doc/log_format.md`.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::sync::Arc;

use rusty_leveldb::env::RandomAccess;

use crate::crc32c::{crc32c, unmask};
use crate::env_health::{EnvHealth, FileOperation};
use crate::read_retry::retried;

/// Length of a table footer: two block handles, padding, and the magic number.
pub(crate) const FOOTER_BYTES: usize = 48;
const FOOTER_MAGIC: [u8; 8] = 0xdb47_7524_8b80_fb57_u64.to_le_bytes();
/// Compression type of a block that is not compressed, as this program writes them.
pub(crate) const UNCOMPRESSED: u8 = 0;
/// Compression type of a block that another program compressed.
const SNAPPY: u8 = 1;
/// Length of a block trailer: compression type (one byte) and checksum (four bytes).
pub(crate) const TRAILER_BYTES: usize = 5;

/// Reads a whole file; the health monitor records a failure.
pub(crate) fn read_file(path: &Path, health: &EnvHealth) -> io::Result<Vec<u8>> {
    let read = retried(|| {
        health.observe(&FileOperation::Read(path))?;
        std::fs::read(path)
    });
    health.noted(path, read)
}

/// Reads a whole log or manifest; the health monitor records a failure and any corruption.
pub(crate) fn read_log(path: &Path, health: &EnvHealth) -> io::Result<Vec<u8>> {
    let bytes = read_file(path, health)?;
    if let Some(damage) = check_log(&bytes) {
        health.note_damage(format!("{}: {damage}", path.display()));
    }
    Ok(bytes)
}

/// Length of a log block. No record header crosses the end of a block.
pub(crate) const LOG_BLOCK_BYTES: usize = 32 * 1024;
pub(crate) const LOG_HEADER_BYTES: usize = 7;
/// Type of a log fragment that is a complete record.
pub(crate) const LOG_FULL: u8 = 1;
/// Type of the first fragment of a log record.
pub(crate) const LOG_FIRST: u8 = 2;
/// Type of a fragment in the middle of a log record.
pub(crate) const LOG_MIDDLE: u8 = 3;
/// Type of the last fragment of a log record.
pub(crate) const LOG_LAST: u8 = 4;

/// Table file with verified reads.
pub(crate) struct VerifiedTable {
    file: Arc<File>,
    path: Arc<Path>,
    n_bytes: u64,
    health: Arc<EnvHealth>,
}

impl VerifiedTable {
    /// Opens a table; the health monitor records a failure.
    pub(crate) fn open(path: Arc<Path>, health: Arc<EnvHealth>) -> io::Result<Self> {
        let opened = retried(|| {
            let file = File::open(&path)?;
            let n_bytes = file.metadata()?.len();
            Ok((Arc::new(file), n_bytes))
        });
        let (file, n_bytes) = health.noted(&path, opened)?;
        Ok(Self::of((file, n_bytes), path, health))
    }

    /// Table in an open file of a known length, bytes.
    pub(crate) fn of(
        (file, n_bytes): (Arc<File>, u64),
        path: Arc<Path>,
        health: Arc<EnvHealth>,
    ) -> Self {
        Self {
            file,
            path,
            n_bytes,
            health,
        }
    }

    /// The open file, for further readers.
    pub(crate) fn file(&self) -> Arc<File> {
        Arc::clone(&self.file)
    }

    /// Handles of the two blocks in the footer; the health monitor records its corruption.
    pub(crate) fn footer(&self) -> io::Result<[(u64, u64); 2]> {
        let mut footer = [0; FOOTER_BYTES];
        let offset = self.n_bytes.checked_sub(FOOTER_BYTES as u64);
        let Some(offset) = offset else {
            return Err(self.damaged(0, "it is too short for a table"));
        };
        self.read(offset, &mut footer)?;
        footer_handles(&footer, self.n_bytes).map_err(|wrong| self.damaged(offset, wrong))
    }

    /// Reads and decompresses the block behind a handle; the health monitor records its corruption.
    pub(crate) fn block(&self, (offset, size): (u64, u64)) -> io::Result<Vec<u8>> {
        let n_bytes = size.checked_add(TRAILER_BYTES as u64);
        let end = n_bytes.and_then(|n| offset.checked_add(n));
        if end.is_none_or(|end| end > self.n_bytes) {
            return Err(self.damaged(offset, "a block is beyond the end of the file"));
        }
        let mut block = vec![0; size as usize + TRAILER_BYTES];
        self.read(offset, &mut block)?;
        let compression = block[size as usize];
        block.truncate(size as usize);
        match compression {
            UNCOMPRESSED => Ok(block),
            SNAPPY => snap::raw::Decoder::new()
                .decompress_vec(&block)
                .map_err(|_| self.damaged(offset, "a block cannot be decompressed")),
            _ => Err(self.damaged(offset, "the compression of a block is not known")),
        }
    }

    /// Records a corruption, and returns the error that reports it.
    pub(crate) fn damaged(&self, offset: u64, wrong: &str) -> io::Error {
        let what = format!("{} at byte {offset}: {wrong}", self.path.display());
        self.health.note_damage(what.clone());
        io::Error::new(io::ErrorKind::InvalidData, what)
    }

    /// Reads and verifies `bytes`; the health monitor records a failure. After a failure it reads
    /// again through another descriptor. Outside of the examination nothing is read after a
    /// failure: a medium that fails may take half a second for each block.
    fn read(&self, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
        if self.health.is_failed() {
            return Err(io::Error::other("an earlier read or write failed"));
        }
        let mut is_first = true;
        let read = retried(|| {
            self.health.observe(&FileOperation::Read(&self.path))?;
            if std::mem::take(&mut is_first) {
                self.read_from(&self.file, offset, bytes)
            } else {
                self.read_from(&File::open(&self.path)?, offset, bytes)
            }
        });
        match read {
            Ok(None) => Ok(()),
            Ok(Some(wrong)) => Err(self.damaged(offset, wrong)),
            Err(error) => Err(self.damaged(offset, &error.to_string())),
        }
    }

    fn read_from(
        &self,
        file: &File,
        offset: u64,
        bytes: &mut [u8],
    ) -> io::Result<Option<&'static str>> {
        file.read_exact_at(bytes, offset)?;
        if offset + bytes.len() as u64 == self.n_bytes && bytes.len() == FOOTER_BYTES {
            return Ok(check_footer(bytes, self.n_bytes));
        }
        if has_valid_trailer(bytes) {
            return Ok(None);
        }
        // The filter block is read without its trailer.
        let mut trailer = [0; TRAILER_BYTES];
        file.read_exact_at(&mut trailer, offset + bytes.len() as u64)?;
        let expected = unmask(le_u32(&trailer[1..]));
        let is_valid = crc32c(&[bytes, &trailer[..1]]) == expected;
        Ok((!is_valid).then_some("the checksum of a block is wrong"))
    }
}

impl RandomAccess for VerifiedTable {
    fn read_at(&self, offset: usize, bytes: &mut [u8]) -> rusty_leveldb::Result<usize> {
        self.read(offset as u64, bytes)?;
        Ok(bytes.len())
    }
}

/// Little-endian number in the first four bytes; zero if there are fewer.
pub(crate) fn le_u32(bytes: &[u8]) -> u32 {
    bytes
        .first_chunk()
        .map_or(0, |four| u32::from_le_bytes(*four))
}

/// `true` if the last four bytes are the checksum of the others.
fn has_valid_trailer(bytes: &[u8]) -> bool {
    match bytes.split_last_chunk::<4>() {
        Some((block, checksum)) => crc32c(&[block]) == unmask(u32::from_le_bytes(*checksum)),
        None => false,
    }
}

/// Description of a corrupted footer.
fn check_footer(footer: &[u8], n_file_bytes: u64) -> Option<&'static str> {
    footer_handles(footer, n_file_bytes).err()
}

/// Offset and size of the two blocks in a footer, or a description of its corruption. It has no
/// checksum, and rusty-leveldb allocates any size in it.
pub(crate) fn footer_handles(
    footer: &[u8],
    n_file_bytes: u64,
) -> Result<[(u64, u64); 2], &'static str> {
    if !footer.ends_with(&FOOTER_MAGIC) {
        return Err("the footer does not end with the magic number of a table");
    }
    let mut rest = footer;
    let mut handles = [(0, 0); 2];
    for handle in &mut handles {
        let (Some(offset), Some(size)) = (take_varint(&mut rest), take_varint(&mut rest)) else {
            return Err("the footer's block handle cannot be read");
        };
        let end = offset
            .checked_add(size)
            .and_then(|end| end.checked_add(TRAILER_BYTES as u64));
        if end.is_none_or(|end| end > n_file_bytes) {
            return Err("the footer names a block beyond the end of the file");
        }
        *handle = (offset, size);
    }
    Ok(handles)
}

/// Decodes a LEB128 varint and advances the slice.
pub(crate) fn take_varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0;
    for shift in (0..63).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= ((byte & 0x7f) as u64) << shift;
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}

/// Description of the first corruption in a log or manifest; `None` if every record up to its end
/// is intact.
///
/// A truncated last record is not a corruption: it is left by a process killed while writing, and
/// was never acknowledged. It is a corruption if another record begins after it, since that one is
/// written only when the earlier ones are on disk.
pub(crate) fn check_log(log: &[u8]) -> Option<String> {
    let mut first_bad = None;
    let mut expected = 0;
    for piece in log_pieces(log) {
        if piece.offset != expected {
            first_bad = first_bad.or(Some(expected));
        }
        if let Some(bad) = first_bad
            && (piece.kind == LOG_FULL || piece.kind == LOG_FIRST)
        {
            let offset = piece.offset;
            return Some(format!(
                "the record at byte {bad} is damaged, and a whole one follows at byte {offset}"
            ));
        }
        expected = piece.next_offset;
    }
    None
}

/// Intact fragment of a log record.
pub(crate) struct LogPiece<'a> {
    pub(crate) offset: usize,
    /// Offset of the next fragment in an undamaged log.
    pub(crate) next_offset: usize,
    pub(crate) kind: u8,
    pub(crate) data: &'a [u8],
}

/// Intact fragments, including those after damaged parts.
pub(crate) fn log_pieces(log: &[u8]) -> impl Iterator<Item = LogPiece<'_>> {
    let mut offset = 0;
    std::iter::from_fn(move || {
        while offset < log.len() {
            let end_of_block = (offset / LOG_BLOCK_BYTES + 1) * LOG_BLOCK_BYTES;
            let rest = &log[offset..end_of_block.min(log.len())];
            if rest.len() < LOG_HEADER_BYTES {
                // No header crosses the end of a block.
                offset = end_of_block;
                continue;
            }
            let Some((kind, n_bytes)) = whole_log_record(rest) else {
                // The length itself may be damaged, so the next fragment may begin anywhere.
                offset += 1;
                continue;
            };
            let begin = offset;
            offset += n_bytes;
            if end_of_block - offset < LOG_HEADER_BYTES {
                offset = end_of_block;
            }
            return Some(LogPiece {
                offset: begin,
                next_offset: offset,
                kind,
                data: &rest[LOG_HEADER_BYTES..n_bytes],
            });
        }
        None
    })
}

/// Type and length (with header) of the fragment at the beginning of `rest`, if its checksum
/// matches.
fn whole_log_record(rest: &[u8]) -> Option<(u8, usize)> {
    let kind = *rest.get(6)?;
    if !(LOG_FULL..=LOG_LAST).contains(&kind) {
        return None;
    }
    let n_bytes = LOG_HEADER_BYTES + u16::from_le_bytes([rest[4], rest[5]]) as usize;
    let type_and_data = rest.get(6..n_bytes)?;
    (crc32c(&[type_and_data]) == unmask(le_u32(rest))).then_some((kind, n_bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log_file::tests::log_of;

    /// Test log with records of these lengths, and the offset of each record.
    fn log(records: &[usize]) -> (Vec<usize>, Vec<u8>) {
        let records = records.iter().enumerate();
        let records: Vec<_> = records.map(|(i, &n)| vec![i as u8 + 0x50; n]).collect();
        log_of(records.iter().map(Vec::as_slice))
    }

    #[test]
    fn truncated_log_is_no_damage() {
        let (_, log) = log(&[10, 300, 32_000, 1, 70_000, 40]);
        for cut in (0..=log.len())
            .step_by(61)
            .chain(log.len() - 60..=log.len())
        {
            assert_eq!(check_log(&log[..cut]), None, "cut at {cut}");
            // As a file system may leave it: longer, but never written.
            let mut padded = log[..cut].to_vec();
            padded.resize(cut + 5000, 0);
            assert_eq!(check_log(&padded), None, "cut at {cut} and padded");
        }
    }

    #[test]
    fn damaged_record_before_a_whole_one_is_damage() {
        let (starts, log) = log(&[10, 300, 32_000, 1, 70_000, 40]);
        let last = *starts.last().unwrap();
        for at in (0..log.len()).step_by(17) {
            let mut damaged = log.clone();
            damaged[at] ^= 0x08;
            assert_eq!(
                check_log(&damaged).is_some(),
                at < last,
                "byte {at} of {}",
                log.len()
            );
        }
    }

    #[test]
    fn footer_with_invalid_handles_is_damage() {
        let footer = |handles: &[u8]| {
            let mut footer = [0; FOOTER_BYTES];
            footer[..handles.len()].copy_from_slice(handles);
            footer[FOOTER_BYTES - 8..].copy_from_slice(&FOOTER_MAGIC);
            footer
        };
        // Blocks at 0 and 95 of 90 and 200 bytes, in a file of 400.
        let whole = footer(&[0, 90, 95, 0xc8, 1]);
        assert_eq!(check_footer(&whole, 400), None);
        assert!(check_footer(&whole, 299).is_some());
        assert!(check_footer(&footer(&[0xff; 40]), 400).is_some());
        assert!(check_footer(&footer(&[0, 90, 95, 0xff, 0xff, 0xff, 0xff, 0x7f]), 400).is_some());
        let mut no_table = whole;
        no_table[47] ^= 1;
        assert!(check_footer(&no_table, 400).is_some());
    }
}
