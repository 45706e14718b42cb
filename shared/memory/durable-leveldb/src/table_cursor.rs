//! Cursor over the records of one table.

use std::sync::Arc;

use crate::block::BlockCursor;
use crate::env_health::EnvHealth;
use crate::raw_table::{RawRecord, record_of, user_key};
use crate::table::{BlockEntry, Table};
use crate::verified_files::VerifiedTable;

/// Cursor at a record of a table. A damaged block is recorded by the health monitor and passed
/// over.
pub(crate) struct TableCursor<'a> {
    file: VerifiedTable,
    /// Data blocks behind the present one.
    blocks: &'a [BlockEntry],
    block: BlockCursor<Vec<u8>>,
}

impl<'a> TableCursor<'a> {
    /// Opens a table at its first record from `from` on; `None` if there is none, or the table
    /// cannot be read.
    pub(crate) fn open(table: &'a Table, from: &[u8], health: &Arc<EnvHealth>) -> Option<Self> {
        let file = table.open(health).ok()?;
        let index = table.index(&file).ok()?;
        let mut cursor = Self {
            file,
            blocks: &index[index.partition_point(|block| *block.last < *from)..],
            block: BlockCursor::empty(),
        };
        while cursor.advance() {
            if cursor.key().is_some_and(|key| key >= from) {
                return Some(cursor);
            }
        }
        None
    }

    /// Present record.
    pub(crate) fn record(&self) -> Option<RawRecord<'_>> {
        record_of(self.block.key(), self.block.value())
    }

    fn key(&self) -> Option<&[u8]> {
        user_key(self.block.key())
    }

    /// Goes to the next record; `false` at the end.
    pub(crate) fn advance(&mut self) -> bool {
        loop {
            match self.block.advance() {
                Some(true) if self.key().is_some() => return true,
                Some(false) => {}
                Some(true) | None => {
                    self.file.damaged(0, "a block has an invalid record");
                }
            }
            let Some((next, behind)) = self.blocks.split_first() else {
                return false;
            };
            self.blocks = behind;
            let Ok(block) = self.file.block(next.handle) else {
                // The health monitor has recorded it.
                self.block = BlockCursor::empty();
                continue;
            };
            self.block = BlockCursor::new(block).unwrap_or_else(|| {
                self.file
                    .damaged(next.handle.0, "the end of a block is invalid");
                BlockCursor::empty()
            });
        }
    }
}
