//! Table of a database (SST), and the tables of all levels.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use crate::block::BlockCursor;
use crate::env_health::{EnvHealth, FileOperation};
use crate::manifest::{Manifest, TableMetadata};
use crate::raw_table::user_key;
use crate::verified_files::{VerifiedTable, take_varint};

/// Maximum number of tables of a process that are kept open for reading: a quarter of the usual
/// limit of descriptors. Further ones are opened for each read.
const MAX_KEPT_OPEN: usize = 256;

/// Number of tables that are kept open.
static N_KEPT_OPEN: AtomicUsize = AtomicUsize::new(0);

/// Table file. It never changes; one that compaction has replaced is deleted when its last reader
/// has ended.
pub(crate) struct Table {
    pub(crate) metadata: TableMetadata,
    pub(crate) path: Arc<Path>,
    /// The open file, of the first tables that are read.
    file: OnceLock<Arc<File>>,
    /// Entries of the index block, once they were read.
    index: OnceLock<Box<[BlockEntry]>>,
    /// Health monitor of the deletion of a table that was replaced; unset before.
    replaced: OnceLock<Arc<EnvHealth>>,
}

/// Data block of a table.
#[derive(Debug)]
pub(crate) struct BlockEntry {
    /// Key that is not less than those in the block, nor greater than those behind it.
    pub(crate) last: Box<[u8]>,
    /// Offset and size of the block.
    pub(crate) handle: (u64, u64),
}

impl Table {
    fn new(folder: &Path, metadata: TableMetadata, health: &EnvHealth) -> Self {
        let named = |extension| folder.join(format!("{:06}.{extension}", metadata.number));
        let mut path = named("ldb");
        let mut size = fs::metadata(&path);
        if size.is_err() && named("sst").exists() {
            path = named("sst");
            size = fs::metadata(&path);
        }
        match size.map(|file| file.len()) {
            Ok(n_bytes) if n_bytes == metadata.n_bytes => {}
            Ok(n_bytes) => health.note_damage(format!(
                "{}: it has {n_bytes} bytes, not {}",
                path.display(),
                metadata.n_bytes
            )),
            Err(error) => health.note_read_error(&path, &error),
        }
        Self {
            metadata,
            path: path.into(),
            file: OnceLock::new(),
            index: OnceLock::new(),
            replaced: OnceLock::new(),
        }
    }

    /// Opens the table for reading. It stays open unless too many do.
    pub(crate) fn open(&self, health: &Arc<EnvHealth>) -> io::Result<VerifiedTable> {
        let (path, health) = (Arc::clone(&self.path), Arc::clone(health));
        if let Some(file) = self.file.get() {
            let file = (Arc::clone(file), self.metadata.n_bytes);
            return Ok(VerifiedTable::of(file, path, health));
        }
        let table = VerifiedTable::open(path, health)?;
        if N_KEPT_OPEN.fetch_add(1, Ordering::Relaxed) >= MAX_KEPT_OPEN
            || self.file.set(table.file()).is_err()
        {
            N_KEPT_OPEN.fetch_sub(1, Ordering::Relaxed);
        }
        Ok(table)
    }

    /// Index of the table, read by the first caller.
    pub(crate) fn index(&self, file: &VerifiedTable) -> io::Result<&[BlockEntry]> {
        if let Some(index) = self.index.get() {
            return Ok(index);
        }
        let [_, handle] = file.footer()?;
        let damaged = || file.damaged(handle.0, "the index of the table is invalid");
        let mut cursor = BlockCursor::new(file.block(handle)?).ok_or_else(damaged)?;
        let mut index = Vec::new();
        while cursor.advance().ok_or_else(damaged)? {
            let mut value = cursor.value();
            let handle = take_varint(&mut value).zip(take_varint(&mut value));
            let last = user_key(cursor.key());
            let (last, handle) = last.zip(handle).ok_or_else(damaged)?;
            index.push(BlockEntry {
                last: last.into(),
                handle,
            });
        }
        Ok(self.index.get_or_init(|| index.into()))
    }

    /// Marks a table that compaction has replaced.
    pub(crate) fn set_replaced(&self, health: &Arc<EnvHealth>) {
        self.replaced.get_or_init(|| Arc::clone(health));
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        if self.file.get().is_some() {
            N_KEPT_OPEN.fetch_sub(1, Ordering::Relaxed);
        }
        if let Some(health) = self.replaced.get() {
            // The health monitor records a failure, and the next opening deletes the file.
            let _ = delete(&self.path, health);
        }
    }
}

/// Deletes a file of the database, if it is there.
pub(crate) fn delete(path: &Path, health: &EnvHealth) -> io::Result<()> {
    let change = FileOperation::Delete(path);
    health.perform("deleting", path, &change, || match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        deleted => deleted,
    })
}

/// Tables of a database at one time.
#[derive(Default)]
pub(crate) struct TableSet {
    /// Tables of each level. Those of level zero may overlap; those of the others are in key order.
    levels: Vec<Vec<Arc<Table>>>,
}

impl TableSet {
    /// Tables of a manifest; those of an earlier set are shared. A missing table is recorded by the
    /// health monitor.
    pub(crate) fn of(
        manifest: Manifest,
        folder: &Path,
        earlier: &Self,
        health: &EnvHealth,
    ) -> Self {
        let known: HashMap<u64, &Arc<Table>> = earlier
            .tables()
            .map(|table| (table.metadata.number, table))
            .collect();
        let table = |metadata: TableMetadata| match known.get(&metadata.number) {
            Some(known) => Arc::clone(known),
            None => Arc::new(Table::new(folder, metadata, health)),
        };
        let levels = manifest.levels.into_iter();
        let mut levels: Vec<Vec<Arc<Table>>> = levels
            .map(|tables| tables.into_iter().map(table).collect())
            .collect();
        for (number, level) in levels.iter_mut().enumerate() {
            if number == 0 {
                level.sort_by_key(|table| Reverse(table.metadata.number));
            } else {
                level.sort_by(|a, b| a.metadata.smallest.cmp(&b.metadata.smallest));
            }
        }
        Self { levels }
    }

    /// All tables.
    pub(crate) fn tables(&self) -> impl Iterator<Item = &Arc<Table>> {
        self.levels.iter().flatten()
    }

    /// Runs of tables in key order, which together are all tables.
    pub(crate) fn runs(&self) -> impl Iterator<Item = &[Arc<Table>]> {
        let (first, others) = match self.levels.split_first() {
            Some((first, others)) => (&first[..], others),
            None => (&[][..], &[][..]),
        };
        let others = others.iter().map(Vec::as_slice);
        let runs = first.chunks(1).chain(others);
        runs.filter(|run| !run.is_empty())
    }
}
