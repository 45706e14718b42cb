//! Reader of a database: merges memtables and tables in key order.

use std::cmp::Reverse;
use std::collections::btree_map::Range;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::env_health::EnvHealth;
use crate::error::Error;
use crate::memtable::Memtable;
use crate::table::{Table, TableSet};
use crate::table_cursor::TableCursor;

/// Reader of one state of a database, in key order. Later writes do not change what it reads.
pub struct Reader {
    /// Records in memory, the newest first.
    memtables: Vec<Arc<Memtable>>,
    /// Records on disk, which are older than those in memory.
    tables: Arc<TableSet>,
    health: Arc<EnvHealth>,
}

impl Reader {
    pub(crate) fn new(
        memtables: Vec<Arc<Memtable>>,
        tables: Arc<TableSet>,
        health: Arc<EnvHealth>,
    ) -> Self {
        Self {
            memtables,
            tables,
            health,
        }
    }

    /// Reads the newest value of `key`.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or, outside of the examination, [`Error::Damaged`].
    pub fn get(&self, key: &[u8]) -> Result<Option<Vec<u8>>, Error> {
        let mut value = None;
        self.scan(key, |found, bytes| {
            if found == key {
                value = Some(bytes.to_vec());
            }
            ControlFlow::Break(())
        })?;
        Ok(value)
    }

    /// Visits the records from `from` on until `visit` breaks.
    ///
    /// # Errors
    ///
    /// As [`Self::get`].
    pub fn scan(
        &self,
        from: &[u8],
        mut visit: impl FnMut(&[u8], &[u8]) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let mut cursors = self.cursors(from);
        let mut last: Option<Vec<u8>> = None;
        while let Some(cursor) = first_of(&mut cursors) {
            if cursor.open_when_waiting() {
                // It may be behind another one now.
                continue;
            }
            let Some((key, value)) = cursor.record() else {
                break;
            };
            // Of several records with a key the first is the newest.
            if last.as_deref() != Some(key) {
                let last = last.get_or_insert_default();
                last.clear();
                last.extend_from_slice(key);
                if let Some(value) = value
                    && visit(key, value).is_break()
                {
                    break;
                }
            }
            cursor.advance();
        }
        self.health.check()
    }

    /// Visits the records whose key begins with `prefix`.
    ///
    /// # Errors
    ///
    /// As [`Self::get`].
    pub fn scan_prefix(
        &self,
        prefix: &[u8],
        mut visit: impl FnMut(&[u8], &[u8]),
    ) -> Result<(), Error> {
        self.scan(prefix, |key, value| {
            if !key.starts_with(prefix) {
                return ControlFlow::Break(());
            }
            visit(key, value);
            ControlFlow::Continue(())
        })
    }

    /// Number of detected corruptions, and the first ones as sentences.
    pub fn damages(&self) -> (u64, Vec<String>) {
        self.health.damages()
    }

    fn cursors(&self, from: &[u8]) -> Vec<Cursor<'_>> {
        let memtables = (0_u64..).zip(&self.memtables);
        let memtables = memtables.map(|(age, memtable)| MemtableCursor::new(memtable, from, age));
        let runs = self.tables.runs();
        let runs = runs.map(|run| RunCursor::new(run, from, Arc::clone(&self.health)));
        let cursors = memtables.map(Cursor::Memtable);
        cursors.chain(runs.map(Cursor::Run)).collect()
    }
}

/// Cursor with the smallest key, and of these the newest record; `None` if all are at the end.
fn first_of<'a, 'b>(cursors: &'b mut [Cursor<'a>]) -> Option<&'b mut Cursor<'a>> {
    let heads = cursors.iter().enumerate();
    let heads = heads.filter_map(|(i, cursor)| Some((cursor.head()?, i)));
    let first = heads.min_by_key(|&((key, recency), _)| (key, Reverse(recency)));
    let (_, i) = first?;
    cursors.get_mut(i)
}

/// Cursor over a part of the records.
enum Cursor<'a> {
    Memtable(MemtableCursor<'a>),
    Run(RunCursor<'a>),
}

/// Order in time of records with the same key: the greater one is newer. It is the sequence number
/// for those in tables, and beyond these for those in memory.
type Recency = u64;

impl Cursor<'_> {
    /// Key and recency of the present record; `None` at the end.
    fn head(&self) -> Option<(&[u8], Recency)> {
        match self {
            Self::Memtable(cursor) => Some((cursor.record?.0, cursor.recency)),
            Self::Run(cursor) => cursor.head(),
        }
    }

    /// Present key and value, `None` for a deletion; `None` at the end.
    fn record(&self) -> Option<(&[u8], Option<&[u8]>)> {
        match self {
            Self::Memtable(cursor) => cursor.record,
            Self::Run(cursor) => cursor.record(),
        }
    }

    fn advance(&mut self) {
        match self {
            Self::Memtable(cursor) => cursor.advance(),
            Self::Run(cursor) => cursor.advance(),
        }
    }

    /// Opens the next table of a run; `false` if that is not due.
    fn open_when_waiting(&mut self) -> bool {
        match self {
            Self::Memtable(_) => false,
            Self::Run(cursor) => cursor.open_when_waiting(),
        }
    }
}

/// Cursor over the records in memory.
struct MemtableCursor<'a> {
    records: Range<'a, Vec<u8>, Option<Vec<u8>>>,
    record: Option<(&'a [u8], Option<&'a [u8]>)>,
    recency: Recency,
}

impl<'a> MemtableCursor<'a> {
    /// Cursor at the first record from `from` on. `age` is the number of newer memtables.
    fn new(memtable: &'a Memtable, from: &[u8], age: u64) -> Self {
        let mut cursor = Self {
            records: memtable.range_from(from),
            record: None,
            recency: RunCursor::UNKNOWN - 1 - age,
        };
        cursor.advance();
        cursor
    }

    fn advance(&mut self) {
        let next = self.records.next();
        self.record = next.map(|(key, value)| (&key[..], value.as_deref()));
    }
}

/// Cursor over tables whose keys do not overlap, in key order. A table is opened when its smallest
/// key is due.
struct RunCursor<'a> {
    /// Tables behind the open one.
    waiting: &'a [Arc<Table>],
    open: Option<TableCursor<'a>>,
    health: Arc<EnvHealth>,
}

impl<'a> RunCursor<'a> {
    /// Recency of a record in a table that is not open yet: it must be opened to know.
    const UNKNOWN: Recency = Recency::MAX;

    /// Cursor at the first record from `from` on.
    fn new(run: &'a [Arc<Table>], from: &[u8], health: Arc<EnvHealth>) -> Self {
        let is_before = |table: &Arc<Table>| *table.metadata.largest < *from;
        let first = run.partition_point(is_before);
        let mut cursor = Self {
            waiting: &run[first..],
            open: None,
            health,
        };
        let table = cursor.waiting.first();
        if table.is_some_and(|table| *table.metadata.smallest < *from) {
            cursor.open_next(from);
        }
        cursor
    }

    /// Opens the next table at the first record from `from` on. One that cannot be read is passed
    /// over; the health monitor has recorded that.
    fn open_next(&mut self, from: &[u8]) {
        if let Some((table, behind)) = self.waiting.split_first() {
            self.waiting = behind;
            self.open = TableCursor::open(table, from, &self.health);
        }
    }

    fn open_when_waiting(&mut self) -> bool {
        let is_waiting = self.open.is_none();
        if is_waiting {
            self.open_next(&[]);
        }
        is_waiting
    }

    fn head(&self) -> Option<(&[u8], Recency)> {
        if let Some(open) = &self.open {
            let record = open.record()?;
            return Some((record.key, record.sequence));
        }
        let next = self.waiting.first()?;
        Some((&next.metadata.smallest, Self::UNKNOWN))
    }

    fn record(&self) -> Option<(&[u8], Option<&[u8]>)> {
        let record = self.open.as_ref()?.record()?;
        Some((record.key, record.value))
    }

    fn advance(&mut self) {
        if let Some(open) = &mut self.open
            && !open.advance()
        {
            self.open = None;
        }
    }
}
