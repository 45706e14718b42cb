//! What the files of a database hold, read without the engine: the newest whole
//! record of every key, whatever else is damaged or missing.

use std::collections::HashMap;
use std::collections::hash_map::Entry as Slot;
use std::fs::{self, File};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::raw_log::visit_log;
use crate::raw_table::{RawRecord, visit_table};
use crate::record;

/// Values up to this size are kept in memory instead of being read again.
const MAX_KEPT_BYTES: usize = 1 << 10;

/// The newest whole records.
pub(crate) struct RawDatabase {
    files: Vec<PathBuf>,
    newest: HashMap<Vec<u8>, Newest>,
    /// Files that could not be read.
    pub(crate) unreadable: Vec<String>,
}

struct Newest {
    sequence: u64,
    /// None: deleted.
    place: Option<Place>,
}

enum Place {
    Memory(Vec<u8>),
    File {
        file_idx: usize,
        offset: u64,
        n_bytes: usize,
    },
}

impl RawDatabase {
    /// Reads all tables and logs in `folder`; what is not whole is passed by.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be listed.
    pub(crate) fn read(folder: &Path) -> Result<Self, Error> {
        let entries = fs::read_dir(folder).map_err(Error::io("listing", folder))?;
        let mut raw = Self {
            files: Vec::new(),
            newest: HashMap::new(),
            unreadable: Vec::new(),
        };
        for path in entries.flatten().map(|entry| entry.path()) {
            match path.extension().and_then(|extension| extension.to_str()) {
                Some("ldb" | "sst") => raw.read_file(path, true),
                Some("log") => raw.read_file(path, false),
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
                note(newest, record, |value| Place::File {
                    file_idx,
                    offset: (value.as_ptr() as usize - base) as u64,
                    n_bytes: value.len(),
                });
            });
        } else {
            visit_log(&bytes, |record| {
                note(newest, record, |value| Place::Memory(value.to_vec()));
            });
        }
    }

    /// The newest whole record of a key.
    pub(crate) fn get(&self, key: &[u8]) -> Option<Vec<u8>> {
        self.value(self.newest.get(key)?)
    }

    pub(crate) fn contains(&self, key: &[u8]) -> bool {
        let newest = self.newest.get(key);
        newest.is_some_and(|newest| newest.place.is_some())
    }

    /// All keys that begin with this letter, with their records, in no order.
    pub(crate) fn table(&self, table: u8) -> impl Iterator<Item = (&[u8], Vec<u8>)> {
        let of_table = self
            .newest
            .iter()
            .filter(move |(key, _)| key.first() == Some(&table));
        of_table.filter_map(|(key, newest)| Some((&key[..], self.value(newest)?)))
    }

    /// The greatest version of any record.
    pub(crate) fn version(&self) -> Option<u8> {
        let versions = self
            .newest
            .iter()
            .filter_map(|(key, newest)| record::version(key, &self.value(newest)?));
        versions.max()
    }

    fn value(&self, newest: &Newest) -> Option<Vec<u8>> {
        match newest.place.as_ref()? {
            Place::Memory(value) => Some(value.clone()),
            Place::File {
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

/// Keeps a record if it is whole and newer than what is known of its key.
fn note(
    newest: &mut HashMap<Vec<u8>, Newest>,
    record: RawRecord<'_>,
    place: impl FnOnce(&[u8]) -> Place,
) {
    let RawRecord {
        key,
        sequence,
        value,
    } = record;
    if value.is_some_and(|value| record::version(key, value).is_none()) {
        return;
    }
    let place = value.map(|value| {
        if value.len() <= MAX_KEPT_BYTES {
            Place::Memory(value.to_vec())
        } else {
            place(value)
        }
    });
    let found = Newest { sequence, place };
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
