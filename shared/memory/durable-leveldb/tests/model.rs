//! Model test: a database and a sorted map are changed in the same random ways, and hold the same.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use durable_leveldb::{Database, RawDatabase, Reader, WriteBatch, record};
use random::Random;
use tempfile::TempDir;

type Model = BTreeMap<Vec<u8>, Vec<u8>>;

/// A small write buffer, so that tables are made and merged soon.
const WRITE_BUFFER_BYTES: usize = 16 << 10;
/// Number of different keys; each is written many times.
const N_KEYS: usize = 400;
const N_STEPS: usize = 3_000;

fn folder() -> TempDir {
    let in_memory = tempfile::tempdir_in("/dev/shm");
    in_memory.or_else(|_| tempfile::tempdir()).unwrap()
}

fn open(folder: &Path) -> Database {
    let mut database = Database::open(folder, WRITE_BUFFER_BYTES).unwrap();
    assert_eq!(database.damages(), (0, vec![]));
    database.accept().unwrap();
    database
}

/// Key of a random length, so that some are prefixes of others.
fn key(random: &mut Random) -> Vec<u8> {
    let n = random.below(N_KEYS);
    let text = format!("{n:03}");
    let n_bytes = 1 + n % text.len();
    text.as_bytes()[..n_bytes].to_vec()
}

fn change(database: &mut Database, model: &mut Model, random: &mut Random) {
    let mut batch = WriteBatch::default();
    for _ in 0..=random.below(8) {
        let key = key(random);
        if random.below(3) == 0 {
            batch.delete(&key);
            model.remove(&key);
        } else {
            let n_bytes = [10, 100, 5_000][random.below(3)];
            let value = record::seal(&key, &vec![random.below(256) as u8; n_bytes]);
            batch.put(&key, &value);
            model.insert(key, value);
        }
    }
    database.write(batch, random.below(2) == 0).unwrap();
}

/// New database after some changes, and what it holds.
fn changed(folder: &Path, random: &mut Random) -> (Database, Model) {
    let (mut database, mut model) = (open(folder), Model::new());
    for _ in 0..300 {
        change(&mut database, &mut model, random);
    }
    (database, model)
}

fn all(reader: &Reader, from: &[u8]) -> Model {
    let mut found = Model::new();
    let visited = reader.scan(from, |key, value| {
        let last = found.last_key_value().map(|(last, _)| last.clone());
        assert!(last.is_none_or(|last| *last < *key), "keys are in order");
        found.insert(key.to_vec(), value.to_vec());
        ControlFlow::Continue(())
    });
    visited.unwrap();
    found
}

/// Checks that two maps are equal; names the keys that differ.
fn check_same(found: &Model, expected: &Model) {
    let text = |key: &[u8]| String::from_utf8_lossy(key).into_owned();
    let missing = expected.keys().filter(|key| !found.contains_key(*key));
    let missing: Vec<_> = missing.map(|key| text(key)).collect();
    let wrong = found
        .iter()
        .filter(|(key, value)| expected.get(*key) != Some(value));
    let wrong: Vec<_> = wrong.map(|(key, _)| text(key)).collect();
    assert_eq!((missing, wrong), (vec![], vec![]), "missing and wrong keys");
}

fn check(reader: &Reader, model: &Model, random: &mut Random) {
    check_same(&all(reader, &[]), model);
    for _ in 0..20 {
        let key = key(random);
        assert!(reader.get(&key).unwrap().as_ref() == model.get(&key));
        let behind = model.range(key.clone()..);
        assert!(all(reader, &key).iter().eq(behind));
    }
    assert_eq!(reader.damages(), (0, vec![]));
}

/// The reader of damaged files finds the same in intact ones.
fn check_raw(folder: &Path, model: &Model, random: &mut Random) {
    let raw = RawDatabase::read(folder).unwrap();
    for _ in 0..50 {
        let key = key(random);
        assert!(raw.get(&key).as_ref() == model.get(&key));
    }
}

fn check_seed(seed: u64) {
    let folder = folder();
    let mut random = Random::from_seed(seed);
    let mut model = Model::new();
    let mut database = open(folder.path());
    let mut snapshots: Vec<(Reader, Model)> = Vec::new();
    for _ in 0..N_STEPS {
        change(&mut database, &mut model, &mut random);
        match random.below(200) {
            0 => check(&database.reader(), &model, &mut random),
            1 => snapshots.push((database.snapshot().unwrap(), model.clone())),
            2 if !snapshots.is_empty() => {
                let taken = random.below(snapshots.len());
                let (snapshot, then) = snapshots.swap_remove(taken);
                check(&snapshot, &then, &mut random);
            }
            3 => {
                let (from, to) = (key(&mut random), key(&mut random));
                database
                    .compact(from.as_slice().min(&to), from.as_slice().max(&to))
                    .unwrap();
            }
            4 => {
                database.compact(&[], &[0xff]).unwrap();
                database.settle().unwrap();
                check(&database.reader(), &model, &mut random);
            }
            // Ended without closing, as by a crash.
            5 => {
                snapshots.clear();
                drop(database);
                check_raw(folder.path(), &model, &mut random);
                database = open(folder.path());
                check(&database.reader(), &model, &mut random);
            }
            6 => {
                snapshots.clear();
                database.close().unwrap();
                check_raw(folder.path(), &model, &mut random);
                database = open(folder.path());
            }
            _ => {}
        }
    }
    for (snapshot, then) in snapshots {
        check(&snapshot, &then, &mut random);
    }
    database.close().unwrap();
    check(&open(folder.path()).reader(), &model, &mut random);
}

#[test]
fn database_holds_what_a_sorted_map_holds() {
    for seed in 0..6 {
        check_seed(seed);
    }
}

#[test]
#[ignore = "long"]
fn long_database_holds_what_a_sorted_map_holds() {
    for seed in 100..400 {
        check_seed(seed);
    }
}

/// Names of the tables in a folder.
fn n_tables(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let extensions = entries.map(|entry| entry.path().extension().map(ToOwned::to_owned));
    extensions
        .filter(|e| e.as_deref() == Some("ldb".as_ref()))
        .count()
}

#[test]
fn replaced_tables_are_deleted_when_their_last_reader_has_ended() {
    let folder = folder();
    let mut random = Random::from_seed(7);
    let (mut database, mut model) = changed(folder.path(), &mut random);
    database.settle().unwrap();
    let snapshot = database.snapshot().unwrap();
    let then = model.clone();
    for _ in 0..300 {
        change(&mut database, &mut model, &mut random);
    }
    database.compact(&[], &[0xff]).unwrap();
    database.settle().unwrap();
    check(&snapshot, &then, &mut random);
    let n_read = n_tables(folder.path());
    drop(snapshot);
    assert!(n_tables(folder.path()) < n_read, "{n_read}");
    check(&database.reader(), &model, &mut random);
    database.close().unwrap();
    let n_left = n_tables(folder.path());
    drop(open(folder.path()));
    assert_eq!(n_tables(folder.path()), n_left, "nothing was left behind");
}

#[test]
fn examined_database_is_not_changed() {
    let folder = folder();
    let mut random = Random::from_seed(8);
    let (database, model) = changed(folder.path(), &mut random);
    drop(database);
    let files = || {
        let entries = std::fs::read_dir(folder.path()).unwrap().flatten();
        let mut files: Vec<_> = entries
            .map(|entry| (entry.path(), std::fs::read(entry.path()).unwrap()))
            .collect();
        files.sort();
        files
    };
    let before = files();
    let mut database = Database::open(folder.path(), WRITE_BUFFER_BYTES).unwrap();
    check(&database.reader(), &model, &mut random);
    let mut batch = WriteBatch::default();
    batch.put(b"new", b"value");
    assert!(database.write(batch, true).is_err());
    drop(database);
    assert!(files() == before);
}
