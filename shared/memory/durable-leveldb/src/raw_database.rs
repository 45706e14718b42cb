//! Low-level reader of LevelDB files without the engine: the newest intact record of every key.

use std::collections::HashMap;
use std::collections::hash_map::Entry as Slot;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::log_file::LOG;
use crate::raw_log::visit_log;
use crate::raw_table::{RawRecord, visit_table};
use crate::record;

/// Size up to which values are kept in memory instead of being read again, bytes.
const MAX_KEPT_BYTES: usize = 1 << 10;

/// Newest intact record of every key.
pub struct RawDatabase {
    files: Vec<PathBuf>,
    newest: HashMap<Vec<u8>, Newest>,
    /// Database files that could not be read.
    pub unreadable: Vec<String>,
}

struct Newest {
    sequence: u64,
    /// Location of the newest value; `None` for a deletion.
    location: Option<RecordLocation>,
}

enum RecordLocation {
    Memory(Vec<u8>),
    File {
        file_idx: usize,
        offset: u64,
        n_bytes: usize,
    },
}

impl RawDatabase {
    /// Reads all tables and logs in `folder` and skips damaged parts. A missing folder has none.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be listed.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            entries => Some(entries.map_err(Error::io("listing", folder))?),
        };
        let mut raw = Self {
            files: Vec::new(),
            newest: HashMap::new(),
            unreadable: Vec::new(),
        };
        for path in entries
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
        {
            match path.extension().and_then(|extension| extension.to_str()) {
                Some("ldb" | "sst") => raw.read_file(path, true),
                Some("log" | LOG) => raw.read_file(path, false),
                _ => {}
            }
        }
        Ok(raw)
    }

    fn read_file(&mut self, path: PathBuf, is_table: bool) {
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.unreadable.push(format!("{}: {error}", path.display()));
                return;
            }
        };
        let file_idx = self.files.len();
        self.files.push(path);
        let newest = &mut self.newest;
        let base = bytes.as_ptr() as usize;
        if is_table {
            visit_table(&bytes, |record| {
                note(newest, record, |value| RecordLocation::File {
                    file_idx,
                    offset: (value.as_ptr() as usize - base) as u64,
                    n_bytes: value.len(),
                });
            });
        } else {
            visit_log(&bytes, |record| {
                note(newest, record, |value| {
                    RecordLocation::Memory(value.to_vec())
                });
            });
        }
    }

    /// Newest intact value of a database key.
    pub fn get(&self, key: &[u8]) -> Option<Vec<u8>> {
        self.value(self.newest.get(key)?)
    }

    /// `true` if there is an intact value of a key.
    pub fn contains(&self, key: &[u8]) -> bool {
        let newest = self.newest.get(key);
        newest.is_some_and(|newest| newest.location.is_some())
    }

    /// All records whose key begins with a table letter, unordered.
    pub fn table(&self, table: u8) -> impl Iterator<Item = (&[u8], Vec<u8>)> {
        let of_table = self
            .newest
            .iter()
            .filter(move |(key, _)| key.first() == Some(&table));
        of_table.filter_map(|(key, newest)| Some((&key[..], self.value(newest)?)))
    }

    /// Greatest schema version found in any record.
    pub fn version(&self) -> Option<u8> {
        let versions = self
            .newest
            .iter()
            .filter_map(|(key, newest)| record::version(key, &self.value(newest)?));
        versions.max()
    }

    fn value(&self, newest: &Newest) -> Option<Vec<u8>> {
        match newest.location.as_ref()? {
            RecordLocation::Memory(value) => Some(value.clone()),
            RecordLocation::File {
                file_idx,
                offset,
                n_bytes,
            } => {
                let mut value = vec![0; *n_bytes];
                let file = File::open(self.files.get(*file_idx)?).ok()?;
                file.read_exact_at(&mut value, *offset).ok()?;
                Some(value)
            }
        }
    }
}

/// Keeps a record if it is intact and newer than the known one of its key.
fn note(
    newest: &mut HashMap<Vec<u8>, Newest>,
    record: RawRecord<'_>,
    location: impl FnOnce(&[u8]) -> RecordLocation,
) {
    let RawRecord {
        key,
        sequence,
        value,
    } = record;
    if value.is_some_and(|value| record::version(key, value).is_none()) {
        return;
    }
    let location = value.map(|value| {
        if value.len() <= MAX_KEPT_BYTES {
            RecordLocation::Memory(value.to_vec())
        } else {
            location(value)
        }
    });
    let found = Newest { sequence, location };
    match newest.entry(key.to_vec()) {
        Slot::Occupied(mut known) if known.get().sequence < sequence => {
            known.insert(found);
        }
        Slot::Vacant(slot) => {
            slot.insert(found);
        }
        Slot::Occupied(_) => {}
    }
}
