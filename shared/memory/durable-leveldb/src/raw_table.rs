//! Low-level reader of LevelDB table files (SST).
//!
//! The engine needs the index block of a table; this reader also recovers the blocks of a table
//! without one. Format: LevelDB's `doc/table_format.md`.

use std::ops::Range;

use crate::block::BlockCursor;
use crate::crc32c::{crc32c, unmask};
use crate::verified_files::{
    FOOTER_BYTES, TRAILER_BYTES, UNCOMPRESSED, footer_handles, le_u32, take_varint,
};

/// Length of the key suffix: sequence number and kind in one number.
const KEY_TAIL_BYTES: usize = 8;

/// Record of a table or log file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RawRecord<'a> {
    pub(crate) key: &'a [u8],
    /// Database sequence number of the write; the greater one is newer.
    pub(crate) sequence: u64,
    /// Value of the record; `None` for a deletion.
    pub(crate) value: Option<&'a [u8]>,
}

/// Visits every record of the intact blocks.
pub(crate) fn visit_table(table: &[u8], mut visit: impl FnMut(RawRecord<'_>)) {
    let blocks = indexed_blocks(table).unwrap_or_else(|| consecutive_blocks(table));
    for block in blocks {
        visit_block(&table[block], &mut |key, value| {
            if let Some(record) = record_of(key, value) {
                visit(record);
            }
        });
    }
}

/// Record of an entry of a data block; `None` if its key is too short.
pub(crate) fn record_of<'a>(key: &'a [u8], value: &'a [u8]) -> Option<RawRecord<'a>> {
    let (key, tail) = key.split_last_chunk::<KEY_TAIL_BYTES>()?;
    let tail = u64::from_le_bytes(*tail);
    Some(RawRecord {
        key,
        sequence: tail >> 8,
        value: (tail & 0xff == 1).then_some(value),
    })
}

/// Key of a record in a key of LevelDB, which has sequence number and kind behind it.
pub(crate) fn user_key(key: &[u8]) -> Option<&[u8]> {
    let (key, _) = key.split_last_chunk::<KEY_TAIL_BYTES>()?;
    Some(key)
}

/// Data blocks in the index whose checksum matches; `None` without an intact index.
fn indexed_blocks(table: &[u8]) -> Option<Vec<Range<usize>>> {
    let footer = table.last_chunk::<FOOTER_BYTES>()?;
    let [_, index] = footer_handles(footer, table.len() as u64).ok()?;
    let index = whole_block(table, index)?;
    let mut blocks = Vec::new();
    visit_block(&table[index], &mut |_, mut handle| {
        let handle = take_varint(&mut handle).zip(take_varint(&mut handle));
        if let Some((offset, size)) = handle {
            blocks.extend(whole_block(table, (offset, size)));
        }
    });
    Some(blocks)
}

/// Byte range of the block behind a handle, if it is intact and uncompressed.
fn whole_block(table: &[u8], (offset, size): (u64, u64)) -> Option<Range<usize>> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(size).ok()?)?;
    let content = table.get(start..end)?;
    let trailer = table.get(end..end.checked_add(TRAILER_BYTES)?)?;
    let is_whole = crc32c(&[content, &trailer[..1]]) == unmask(le_u32(&trailer[1..]));
    (is_whole && trailer[0] == UNCOMPRESSED).then_some(start..end)
}

/// Data blocks found by scanning: the end of a block is where its checksum matches. The first
/// damaged block ends the search.
fn consecutive_blocks(table: &[u8]) -> Vec<Range<usize>> {
    let mut blocks = Vec::new();
    let mut start = 0;
    while let Some(end) = end_of_block(table, start) {
        blocks.push(start..end);
        start = end + TRAILER_BYTES;
    }
    blocks
}

fn end_of_block(table: &[u8], start: usize) -> Option<usize> {
    let last_end = table.len().checked_sub(TRAILER_BYTES)?;
    let mut crc = crate::crc32c::IncrementalCrc::default();
    for end in start..=last_end {
        let expected = unmask(le_u32(&table[end + 1..]));
        let is_end = end > start && table[end] == UNCOMPRESSED;
        if is_end && crc.with(UNCOMPRESSED) == expected {
            return Some(end);
        }
        crc.push(table[end]);
    }
    None
}

/// Visits the records of a block up to the first invalid one.
fn visit_block(block: &[u8], visit: &mut dyn FnMut(&[u8], &[u8])) {
    let Some(mut cursor) = BlockCursor::new(block) else {
        return;
    };
    while cursor.advance() == Some(true) {
        visit(cursor.key(), cursor.value());
    }
}
