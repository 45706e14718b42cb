//! Volatile copy of a database: for reading one whose disk cannot be written.
//!
//! LevelDB writes when it opens a database: the log becomes a table, and the manifest is written
//! anew. In a copy in memory-backed storage it can do so, whatever the state of the disk. Tables
//! never change, so links to them suffice, and the copy takes little more than the log.

use std::ffi::OsStr;
use std::fs::{self, DirBuilder};
use std::io;
use std::os::unix::fs::{DirBuilderExt, symlink};
use std::path::{Path, PathBuf};

use crate::database::Database;
use crate::error::Error;

/// Copy of a database's files; dropping it removes them.
#[derive(Debug)]
pub struct VolatileCopy {
    folder: PathBuf,
}

impl VolatileCopy {
    /// Copies the database in a folder to another one, which is replaced.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when a file cannot be read, or the copy has no room.
    pub fn of(database: &Path, folder: &Path) -> Result<Self, Error> {
        match fs::remove_dir_all(folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(Error::io("removing", folder)(error));
            }
            _ => {}
        }
        let mut builder = DirBuilder::new();
        let created = builder.recursive(true).mode(0o700).create(folder);
        created.map_err(Error::io("creating", folder))?;
        // From here on, an error removes the folder again.
        let copy = Self {
            folder: folder.to_owned(),
        };
        let entries = fs::read_dir(database).map_err(Error::io("listing", database))?;
        for entry in entries {
            let from = entry.map_err(Error::io("listing", database))?.path();
            let Some(name) = from.file_name() else {
                continue;
            };
            let to = folder.join(name);
            let copied = if is_table(&from) {
                symlink(&from, &to)
            } else {
                fs::copy(&from, &to).map(|_| ())
            };
            copied.map_err(Error::io("copying", &from))?;
        }
        Ok(copy)
    }

    /// Opens the copy for reading. It stays in examination, so that no table is compacted.
    ///
    /// # Errors
    ///
    /// As [`Database::open`].
    pub fn open(&self, write_buffer_bytes: usize) -> Result<Database, Error> {
        Database::open(&self.folder, write_buffer_bytes)
    }

    /// Folder of the copy.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for VolatileCopy {
    fn drop(&mut self) {
        // What remains is removed with the next copy.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

fn is_table(path: &Path) -> bool {
    let extension = path.extension();
    [Some(OsStr::new("ldb")), Some(OsStr::new("sst"))].contains(&extension)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::WriteBatch;
    use std::collections::BTreeMap;
    use std::time::SystemTime;

    /// Lengths and times of all files in a folder.
    fn files(folder: &Path) -> BTreeMap<PathBuf, (u64, SystemTime)> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| {
            let entry = entry.unwrap();
            let metadata = entry.metadata().unwrap();
            (entry.path(), (metadata.len(), metadata.modified().unwrap()))
        });
        entries.collect()
    }

    /// A full disk leaves an incomplete table, and the log is made a table of that number again.
    #[test]
    fn volatile_copy_never_writes_through_a_link() {
        let guard = tempfile::tempdir().unwrap();
        let folder = guard.path().join("database");
        let mut database = Database::open(&folder, 1 << 20).unwrap();
        database.accept().unwrap();
        let mut batch = WriteBatch::default();
        batch.put(b"cup", b"on the table");
        database.write(batch, true).unwrap();
        drop(database);
        for number in 1..20 {
            fs::write(folder.join(format!("{number:06}.ldb")), "incomplete").unwrap();
        }
        let before = files(&folder);
        let copy = VolatileCopy::of(&folder, &guard.path().join("volatile")).unwrap();
        let mut opened = copy.open(1 << 20).unwrap();
        let found = opened.reader().unwrap().get(b"cup").unwrap();
        assert_eq!(found, Some(b"on the table".to_vec()));
        drop(opened);
        assert_eq!(files(&folder), before);
    }

    #[test]
    fn volatile_copy_is_read_and_leaves_the_database_as_it_is() {
        let guard = tempfile::tempdir().unwrap();
        let folder = guard.path().join("database");
        let volatile = guard.path().join("volatile");
        let mut database = Database::open(&folder, 1 << 12).unwrap();
        database.accept().unwrap();
        for n in 0..100_u32 {
            let mut batch = WriteBatch::default();
            batch.put(&n.to_be_bytes(), &[7; 100]);
            database.write(batch, true).unwrap();
        }
        drop(database);
        let before = files(&folder);
        assert!(before.keys().any(|path| is_table(path)), "{before:?}");
        let copy = VolatileCopy::of(&folder, &volatile).unwrap();
        let mut opened = copy.open(1 << 12).unwrap();
        for n in 0..100_u32 {
            let found = opened.reader().unwrap().get(&n.to_be_bytes()).unwrap();
            assert_eq!(found, Some(vec![7; 100]), "{n}");
        }
        drop(opened);
        assert_eq!(files(&folder), before);
        drop(copy);
        assert!(!volatile.exists());
    }
}
