//! Fuzzing of database files: a corrupted log, manifest or table is read or refused, never a
//! panic, and a record that is read has been written.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use durable_leveldb::{Database, RawDatabase, WriteBatch, record};
use mutation_fuzzing::fuzz;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A small write buffer, so that a few records fill a table.
const WRITE_BUFFER_BYTES: usize = 1 << 12;

fn key(n: u32) -> Vec<u8> {
    format!("key {n:04}").into_bytes()
}

/// Database with tables, a log and deleted records.
fn database(folder: &Path) -> BTreeMap<Vec<u8>, Vec<u8>> {
    let mut database = Database::open(folder, WRITE_BUFFER_BYTES).unwrap();
    database.accept().unwrap();
    let mut written = BTreeMap::new();
    for n in 0..40_u32 {
        let (key, value) = (key(n), record::seal(&key(n), &vec![n; 60]));
        let mut batch = WriteBatch::default();
        batch.put(&key, &value);
        if n > 30 {
            batch.delete(&self::key(n - 30));
        }
        database.write(batch, true).unwrap();
        written.insert(key, value);
    }
    database.close().unwrap();
    written
}

/// Files of a database whose corruption is fuzzed.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_fuzzed = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        name == "CURRENT" || name.starts_with("MANIFEST") || name.contains(".l")
    };
    let mut files: Vec<_> = paths.filter(is_fuzzed).collect();
    files.sort();
    files
}

/// Copy of a database in which one file has other bytes.
struct Damaged(tempfile::TempDir);

impl Damaged {
    fn new(original: &Path, file: &Path, bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir_in("/dev/shm").unwrap();
        for entry in fs::read_dir(original).unwrap() {
            let path = entry.unwrap().path();
            let to = folder.path().join(path.file_name().unwrap());
            if path == file {
                fs::write(to, bytes).unwrap();
            } else {
                fs::copy(&path, to).unwrap();
            }
        }
        Self(folder)
    }
}

#[test]
fn fuzz_database_files() {
    let original = tempfile::tempdir_in("/dev/shm").unwrap();
    let written = database(original.path());
    for file in files(original.path()) {
        let bytes = fs::read(&file).unwrap();
        let n_read = RefCell::new(0_usize);
        fuzz(&[bytes], |bytes| {
            let damaged = Damaged::new(original.path(), &file, bytes);
            let raw = RawDatabase::read(damaged.0.path());
            let Ok(raw) = raw else { return };
            for (key, value) in &written {
                if let Some(found) = raw.get(key) {
                    // Seals find what checksums of blocks did not.
                    let is_sealed = record::unseal::<Vec<u32>>(key, &found).is_ok();
                    assert!(!is_sealed || found == *value, "{}", file.display());
                    *n_read.borrow_mut() += 1;
                }
            }
        });
        assert!(n_read.into_inner() > 0, "{}", file.display());
    }
}
