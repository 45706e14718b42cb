//! Interoperability with C++ LevelDB, in both directions.
//!
//! The two programs are in `tests/peers/leveldb`. Each prints a record as a line of key, length and
//! checksum of the value.

use std::fmt::Write;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Command;

use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use rusty_leveldb::WriteBatch;
use tempfile::TempDir;

use crate::engine::database::{Database, WRITE_BUFFER_BYTES};
use crate::mutation_id::MutationId;
use crate::perceptual::model::Target;
use crate::perceptual::mutation::{Mutation, StoreChange};
use crate::perceptual::perceptual_memory::PerceptualMemory;
use crate::perceptual::view::{CapturedView, StoredDescriptor};

/// Size of a point cloud that fills a memtable after a few tracks, bytes.
const CLOUD_BYTES: usize = 150_000;
const VIEWS_PER_TRACK: u32 = 3;
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

/// Output lines of a program.
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
    let mut reader = engine.reader().unwrap();
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

fn view(id: ViewId, cloud_bytes: usize) -> CapturedView {
    let noise = |i: u64| (i * 7 + id.track_id + id.view_id as u64).wrapping_mul(0x9e37_79b9) >> 9;
    CapturedView {
        id,
        descriptor: StoredDescriptor {
            kind: "test".to_owned(),
            values: (0..309).map(|i| noise(i) as f32).collect(),
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.1),
        },
        captured_ns: id.track_id,
        frame_sequence: id.track_id,
        source: "test".to_owned(),
        mean_rgb: None,
        points: Some((0..cloud_bytes as u64).map(|i| noise(i) as u8).collect()),
    }
}

/// Applies changes of all kinds to a track.
fn live(memory: &mut PerceptualMemory, track_id: u64, cloud_bytes: usize) {
    let name = |kind: u64| CategoryName::new(&format!("Thing {}", kind % 7)).unwrap();
    let views = (0..VIEWS_PER_TRACK).map(|view_id| view(ViewId { track_id, view_id }, cloud_bytes));
    let mut changes = vec![StoreChange::StoreViews(views.collect())];
    memory.lease_track_ids(1).unwrap();
    let category = name(track_id);
    changes.push(StoreChange::Teach { track_id, category });
    if track_id.is_multiple_of(3) {
        let category = name(track_id + 1);
        let target = Target::Track(track_id);
        changes.push(StoreChange::Correct { target, category });
    }
    if track_id.is_multiple_of(10) {
        let category = name(track_id / 10);
        // The name may be nobody's, and then there is nothing to forget.
        if memory.categories().iter().any(|c| c.name == category) {
            changes.push(StoreChange::Forget(Target::Category(category)));
        }
    }
    for (i, change) in changes.into_iter().enumerate() {
        let mutation = Mutation {
            id: MutationId((track_id as u128) << 8 | i as u128),
            author: "test".to_owned(),
            wall_ns: track_id,
            change,
        };
        memory.apply(&mutation).unwrap();
    }
}

#[test]
#[ignore = "needs g++ and libleveldb-dev"]
fn cpp_leveldb_reads_our_log() {
    let programs = folder();
    let dump = build("dump", programs.path());
    let folder = folder();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
    for track in 0..20 {
        live(&mut memory, track, 40_000);
    }
    let (found, levels) = read_by_cpp(&dump, &folder.path().join("database"));
    check_same(&found, &records(&mut memory.engine), "a log only");
    // The copy was taken from an open store, so what is in tables C++ has put there.
    let n_ours = fs::read_dir(folder.path().join("database")).unwrap();
    let is_table = |entry: &fs::DirEntry| entry.path().extension().is_some_and(|e| e == "ldb");
    assert_eq!(n_ours.flatten().filter(is_table).count(), 0);
    assert_eq!(levels.iter().sum::<usize>(), 1);
}

#[test]
#[ignore = "needs g++ and libleveldb-dev"]
fn cpp_leveldb_reads_our_tables() {
    let programs = folder();
    let dump = build("dump", programs.path());
    let folder = folder();
    let database = folder.path().join("database");
    let mut n_found = 0;
    for tracks in [0..N_TRACKS / 2, N_TRACKS / 2..N_TRACKS] {
        let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
        for track in tracks {
            live(&mut memory, track, CLOUD_BYTES);
        }
        let ours = records(&mut memory.engine);
        let (found, _) = read_by_cpp(&dump, &database);
        check_same(&found, &ours, "an open store");
        memory.close().unwrap();
        let (found, levels) = read_by_cpp(&dump, &database);
        check_same(&found, &ours, "a closed store");
        check_same(&read_by_ours(&database), &ours, "a store opened again");
        let n_levels = levels.iter().filter(|&&n| n > 0).count();
        assert!(n_levels >= 2, "tables on one level only: {levels:?}");
        n_found = found.len();
    }
    assert!(n_found as u64 > N_TRACKS * VIEWS_PER_TRACK as u64 * 3);
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
    // What ours makes of it C++ reads in turn.
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
