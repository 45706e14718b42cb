//! Interoperability with C++ LevelDB, in both directions.
//!
//! The two programs are in `tests/peers/leveldb`. Each prints a record as a line of key, length and
//! checksum of the value.

#![expect(clippy::unwrap_used, reason = "the helpers of tests fail as tests do")]

use std::fmt::Write;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Command;

use durable_leveldb::{Database, WriteBatch};
use tempfile::TempDir;

/// Write-buffer size that makes the engine write tables and compact soon.
const WRITE_BUFFER_BYTES: usize = 4 << 20;
/// Size of a value that fills a memtable after a few tracks, bytes.
const CLOUD_BYTES: usize = 150_000;
const VALUES_PER_TRACK: u64 = 3;
/// Number of tracks that makes tables on several levels.
const N_TRACKS: u64 = 90;

fn folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm")
        .or_else(|_| tempfile::tempdir())
        .unwrap()
}

/// Compiles one of the C++ programs into `folder`.
fn build(name: &str, folder: &Path) -> PathBuf {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/peers/leveldb");
    let program = folder.join(name);
    let built = Command::new("g++")
        .args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&program)
        .arg(sources.join(format!("{name}.cc")))
        .arg("-lleveldb")
        .status();
    assert!(built.unwrap().success(), "{name}.cc is not built");
    program
}

/// Output lines of a program that was run.
fn lines_of(command: &mut Command) -> Vec<String> {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(str::to_owned).collect()
}

/// Copy of the database in `folder`, since opening a database modifies it.
fn copy(folder: &Path) -> TempDir {
    let copy = self::folder();
    for entry in fs::read_dir(folder).unwrap().flatten() {
        fs::copy(entry.path(), copy.path().join(entry.file_name())).unwrap();
    }
    copy
}

/// Records as C++ LevelDB reads them, and the number of tables on each level.
fn read_by_cpp(dump: &Path, database: &Path) -> (Vec<String>, Vec<usize>) {
    let copy = copy(database);
    let mut lines = lines_of(Command::new(dump).arg(copy.path()));
    let levels = lines.remove(0);
    let levels = levels.strip_prefix("levels ").unwrap().split(' ');
    (lines, levels.map(|n| n.parse().unwrap()).collect())
}

/// Records as this engine reads them.
fn records(engine: &mut Database) -> Vec<String> {
    let mut lines = Vec::new();
    let mut tell = |key: &[u8], value: &[u8]| {
        let mut line = String::new();
        for byte in key {
            write!(line, "{byte:02x}").unwrap();
        }
        write!(line, " {} {:08x}", value.len(), crc32fast::hash(value)).unwrap();
        lines.push(line);
        ControlFlow::Continue(())
    };
    let reader = engine.reader();
    reader.scan(&[], &mut tell).unwrap();
    assert_eq!(engine.damages(), (0, vec![]));
    lines
}

fn read_by_ours(database: &Path) -> Vec<String> {
    let copy = copy(database);
    records(&mut Database::open(copy.path(), WRITE_BUFFER_BYTES).unwrap())
}

fn check_same(found: &[String], expected: &[String], what: &str) {
    let n_same = found.iter().zip(expected).take_while(|(a, b)| a == b);
    let at = n_same.count();
    assert_eq!(
        (found.get(at), expected.get(at)),
        (None, None),
        "{what}: record {at} of {} differs",
        expected.len()
    );
}

fn noise(track_id: u64, n_bytes: usize) -> Vec<u8> {
    let noise = |i: u64| (i * 7 + track_id).wrapping_mul(0x9e37_79b9) >> 9;
    (0..n_bytes as u64).map(|i| noise(i) as u8).collect()
}

fn key(table: u8, number: u64) -> Vec<u8> {
    [&[table][..], &number.to_be_bytes()].concat()
}

/// Writes synced batches about a track: large and small new records, records that replace earlier
/// ones, and deletions.
fn live(engine: &mut Database, track_id: u64, cloud_bytes: usize) {
    let mut batch = WriteBatch::default();
    for i in 0..VALUES_PER_TRACK {
        let number = track_id << 8 | i;
        batch.put(&key(b'b', number), &noise(number, cloud_bytes));
        batch.put(&key(b'd', number), &noise(number, 1_236));
        batch.put(&key(b'v', number), &noise(number, 120));
    }
    batch.put(b"m", &noise(track_id, 60));
    engine.write(batch, true).unwrap();
    let mut batch = WriteBatch::default();
    for i in 0..VALUES_PER_TRACK {
        batch.put(&key(b'l', track_id << 8 | i), &noise(track_id, 30));
    }
    batch.put(b"m", &noise(track_id + 1, 60));
    if track_id.is_multiple_of(10) {
        // An earlier track is forgotten, without its large values.
        for i in 0..VALUES_PER_TRACK {
            batch.delete(&key(b'l', (track_id / 2) << 8 | i));
            batch.delete(&key(b'd', (track_id / 2) << 8 | i));
        }
    }
    engine.write(batch, true).unwrap();
}

/// Opens the database in `folder` for writing.
fn open(folder: &Path) -> Database {
    let mut engine = Database::open(folder, WRITE_BUFFER_BYTES).unwrap();
    engine.accept().unwrap();
    engine
}

#[test]
#[ignore = "needs g++ and libleveldb-dev"]
fn cpp_leveldb_reads_our_tables() {
    let programs = folder();
    let dump = build("dump", programs.path());
    let folder = folder();
    let database = folder.path();
    let mut n_found = 0;
    for tracks in [0..N_TRACKS / 2, N_TRACKS / 2..N_TRACKS] {
        let mut engine = open(database);
        for track in tracks {
            live(&mut engine, track, CLOUD_BYTES);
        }
        let ours = records(&mut engine);
        engine.settle().unwrap();
        check_same(&read_by_ours(database), &ours, "an open database");
        engine.close().unwrap();
        let (found, levels) = read_by_cpp(&dump, database);
        check_same(&found, &ours, "a closed database");
        check_same(&read_by_ours(database), &ours, "a database opened again");
        let n_levels = levels.iter().filter(|&&n| n > 0).count();
        assert!(n_levels >= 2, "tables on one level only: {levels:?}");
        n_found = found.len();
    }
    assert!(n_found as u64 > N_TRACKS * VALUES_PER_TRACK * 3);
}

fn check_ours_reads_cpp(compression: &str) {
    let programs = folder();
    let fill = build("fill", programs.path());
    let dump = build("dump", programs.path());
    let folder = folder();
    let expected = lines_of(Command::new(fill).arg(folder.path()).arg(compression));
    assert!(expected.len() > 10_000);
    let mut engine = Database::open(folder.path(), WRITE_BUFFER_BYTES).unwrap();
    check_same(&records(&mut engine), &expected, "opened by ours");
    // The C++ library reads the result of this engine in turn.
    engine.accept().unwrap();
    let mut batch = WriteBatch::default();
    let first = expected[0].split(' ').next().unwrap();
    let key: Vec<u8> = (0..first.len() / 2)
        .map(|i| u8::from_str_radix(&first[2 * i..2 * i + 2], 16).unwrap())
        .collect();
    batch.delete(&key);
    engine.write(batch, true).unwrap();
    check_same(&records(&mut engine), &expected[1..], "changed by ours");
    engine.close().unwrap();
    let (found, levels) = read_by_cpp(&dump, folder.path());
    check_same(&found, &expected[1..], "read by C++ again");
    assert!(levels.iter().filter(|&&n| n > 0).count() >= 2, "{levels:?}");
}

#[test]
#[ignore = "needs g++ and libleveldb-dev"]
fn ours_reads_a_plain_database_of_cpp_leveldb() {
    check_ours_reads_cpp("plain");
}

#[test]
#[ignore = "needs g++ and libleveldb-dev"]
fn ours_reads_a_compressed_database_of_cpp_leveldb() {
    check_ours_reads_cpp("snappy");
}
