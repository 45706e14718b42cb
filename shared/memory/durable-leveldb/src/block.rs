//! Block of a table: records with shared key prefixes, in key order.
//!
//! Format: LevelDB's `doc/table_format.md`.

use std::ops::Range;

use crate::verified_files::take_varint;

/// Cursor over the records of a block, before the first one at the beginning.
#[derive(Debug)]
pub(crate) struct BlockCursor<B> {
    block: B,
    /// Length of the records, without the restart points behind them.
    n_record_bytes: usize,
    offset: usize,
    key: Vec<u8>,
    value: Range<usize>,
}

impl BlockCursor<Vec<u8>> {
    /// Cursor over a block without records.
    pub(crate) fn empty() -> Self {
        Self {
            block: Vec::new(),
            n_record_bytes: 0,
            offset: 0,
            key: Vec::new(),
            value: 0..0,
        }
    }
}

impl<B: AsRef<[u8]>> BlockCursor<B> {
    /// Cursor over a block; `None` if its end is invalid.
    pub(crate) fn new(block: B) -> Option<Self> {
        let bytes = block.as_ref();
        let n_restarts = u32::from_le_bytes(*bytes.last_chunk::<4>()?) as usize;
        let n_restart_bytes = n_restarts.checked_mul(4)?.checked_add(4)?;
        let n_record_bytes = bytes.len().checked_sub(n_restart_bytes)?;
        Some(Self {
            block,
            n_record_bytes,
            offset: 0,
            key: Vec::new(),
            value: 0..0,
        })
    }

    /// Goes to the next record; `false` at the end, and `None` if the record is invalid.
    pub(crate) fn advance(&mut self) -> Option<bool> {
        let records = &self.block.as_ref()[..self.n_record_bytes];
        let mut rest = &records[self.offset..];
        if rest.is_empty() {
            return Some(false);
        }
        let n_shared = usize::try_from(take_varint(&mut rest)?).ok()?;
        let n_new = usize::try_from(take_varint(&mut rest)?).ok()?;
        let n_value = usize::try_from(take_varint(&mut rest)?).ok()?;
        let (new, behind) = rest.split_at_checked(n_new)?;
        let (_, behind) = behind.split_at_checked(n_value)?;
        if n_shared > self.key.len() {
            return None;
        }
        self.key.truncate(n_shared);
        self.key.extend_from_slice(new);
        self.offset = self.n_record_bytes - behind.len();
        self.value = self.offset - n_value..self.offset;
        Some(true)
    }

    pub(crate) fn key(&self) -> &[u8] {
        &self.key
    }

    pub(crate) fn value(&self) -> &[u8] {
        &self.block.as_ref()[self.value.clone()]
    }
}
