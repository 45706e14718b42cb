//! Crash tests: power cuts and write errors at every file operation.
//!
//! The operations on the database and the archive are recorded. For each prefix the test
//! reconstructs the disk after a power cut: all synced bytes, and any part of the others.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

use durable_leveldb::{Database, FileOperation, MutationId, Observer, StoreFolder};
use geometry::OrientedBox;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, Vector3};
use random::Random;
use tempfile::TempDir;

use crate::archiving::ArchivingStep;
use crate::consistency_check::check_consistency;
use crate::error::{Error, StorageError};
use crate::history_limits::HistoryLimits;
use crate::model::RetentionLimits;
use crate::mutation::{Mutation, StoreChange as Asked};
use crate::opening::{self, Condition, OpenReport};
use crate::perceptual_memory::PerceptualMemory;
use crate::requester::Requester;
use crate::store_thread::{StoreConfig, StoreThread};
use crate::view::{CapturedView, StoredDescriptor};

/// Write-buffer size that makes the engine compact soon.
const WRITE_BUFFER_BYTES: usize = 4 << 20;
/// Size of a point cloud of which a memtable holds seven, bytes.
const CLOUD_BYTES: usize = 600_000;
/// Number of tracks that makes the engine compact twice: it keeps up to four tables on level zero.
const N_TRACKS: u64 = 80;

fn folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm")
        .or_else(|_| tempfile::tempdir())
        .unwrap()
}

fn open(folder: &Path) -> (PerceptualMemory, OpenReport) {
    let folder = StoreFolder::hold(folder).unwrap();
    let folder = folder.with_write_buffer(WRITE_BUFFER_BYTES);
    opening::open(folder, 1, RetentionLimits::default(), false).unwrap()
}

/// Mutation `n`: stores or teaches track `n / 2`.
fn mutation(n: u64, cloud_bytes: usize) -> Mutation {
    let track_id = n / 2;
    let change = if n.is_multiple_of(2) {
        let first = n as u32;
        let byte = |i: u32| (i.wrapping_mul(2_654_435_761) >> 13) as u8;
        let cloud = (first..first + cloud_bytes as u32).map(byte);
        let half_sides_m = Vector3::repeat(0.1);
        Asked::StoreViews(vec![CapturedView {
            id: ViewId {
                track_id,
                view_id: 0,
            },
            descriptor: StoredDescriptor {
                kind: "test".to_owned(),
                values: vec![n as f32],
            },
            box_in_world: OrientedBox {
                frame_from_box: Isometry3::identity(),
                half_sides_m,
            },
            captured_ns: n,
            frame_sequence: n,
            source: "test".to_owned(),
            mean_rgb: None,
            points: Some(cloud.collect()),
        }])
    } else {
        Asked::Teach {
            track_id,
            category: CategoryName::new("Mug").unwrap(),
        }
    };
    Mutation {
        id: MutationId(n as u128),
        author: String::new(),
        requester: Requester::default(),
        wall_ns: n,
        change,
    }
}

/// Checks that the store holds exactly the first `n` mutations, or one more that was not
/// acknowledged.
fn check_holds(folder: &Path, n: u64, what: &str) {
    let (mut memory, report) = open(folder);
    assert!(
        matches!(report.condition, Condition::Sound | Condition::New),
        "{what}: {report}"
    );
    let sequence = memory.sequence();
    assert!(
        sequence == n || sequence == n + 1,
        "{what}: {sequence} of {n}"
    );
    for track in 0..sequence.div_ceil(2) {
        let stored = memory.views_of_track(track).unwrap();
        let number = [2.0 * track as f32];
        assert_eq!(
            stored[0].view.descriptor.values, number,
            "{what}: track {track}"
        );
        let is_taught = 2 * track + 1 < sequence;
        assert_eq!(
            stored[0].standing.category().is_some(),
            is_taught,
            "{what}: track {track}"
        );
    }
    memory.lease_track_ids(1).unwrap();
}

#[test]
fn synced_write_is_one_fdatasync() {
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.lease_track_ids(N_TRACKS).unwrap();
    let counts = Arc::new(Mutex::new([0_u32; 3]));
    let seen = Arc::clone(&counts);
    memory.engine.set_observer(Box::new(move |change| {
        let i = match change {
            FileOperation::Write(..) | FileOperation::Read(_) => return Ok(()),
            FileOperation::Sync(_) => 0,
            FileOperation::SyncFolder(_) => 1,
            _ => 2,
        };
        seen.lock().unwrap()[i] += 1;
        Ok(())
    }));
    for n in 0..20 {
        memory.apply(&mutation(n, 1000)).unwrap();
        assert_eq!(*counts.lock().unwrap(), [n as u32 + 1, 0, 0]);
    }
    // Asked again, a mutation writes nothing.
    memory.apply(&mutation(3, 1000)).unwrap();
    // A group is one write.
    for n in 20..40 {
        memory.stage(&mutation(n, 1000)).unwrap();
    }
    memory.commit().unwrap();
    assert_eq!(*counts.lock().unwrap(), [21, 0, 0]);
}

/// Recorded file operation, by path in the store folder.
enum Event {
    Create(PathBuf),
    Write(PathBuf, Vec<u8>),
    Sync(PathBuf),
    Rename(PathBuf, PathBuf),
    Delete(PathBuf),
    SyncFolder(PathBuf),
}

type Journal = Arc<Mutex<Vec<Event>>>;

/// Observer that records all operations in a store folder.
fn journaling(store: &Path, journal: &Journal) -> Observer {
    let store = store.canonicalize().unwrap();
    let journal = Arc::clone(journal);
    Box::new(move |change| {
        let inner = |path: &Path| path.strip_prefix(&store).unwrap().to_owned();
        let event = match change {
            FileOperation::Read(_) => return Ok(()),
            FileOperation::Create(path) => Event::Create(inner(path)),
            FileOperation::Write(path, bytes) => Event::Write(inner(path), bytes.to_vec()),
            FileOperation::Sync(path) => Event::Sync(inner(path)),
            FileOperation::Rename(old, new) => Event::Rename(inner(old), inner(new)),
            FileOperation::Delete(path) => Event::Delete(inner(path)),
            FileOperation::SyncFolder(folder) => Event::SyncFolder(inner(folder)),
        };
        journal.lock().unwrap().push(event);
        Ok(())
    })
}

/// Files of a folder, by path in the store folder.
type FolderNames = BTreeMap<PathBuf, usize>;

/// Simulated disk with a write cache.
#[derive(Clone, Default)]
struct Disk {
    /// Durable and unsynced content of each file.
    inodes: Vec<(Vec<u8>, Vec<u8>)>,
    /// Contents of each folder since its last sync, the present one last.
    folders: BTreeMap<PathBuf, Vec<FolderNames>>,
}

impl Disk {
    /// Disk with the fully synced files of database and archive.
    fn of(store: &Path) -> Self {
        let mut disk = Self::default();
        for folder in ["database", "history"] {
            let mut names = FolderNames::new();
            for entry in fs::read_dir(store.join(folder)).into_iter().flatten() {
                let path = entry.unwrap().path();
                names.insert(
                    path.strip_prefix(store).unwrap().to_owned(),
                    disk.inodes.len(),
                );
                disk.inodes.push((fs::read(path).unwrap(), Vec::new()));
            }
            disk.folders.insert(folder.into(), vec![names]);
        }
        disk
    }

    /// States of the folder of a file, the present one last.
    fn folder_of(&mut self, path: &Path) -> &mut Vec<FolderNames> {
        self.folders.get_mut(path.parent().unwrap()).unwrap()
    }

    fn inode(&mut self, path: &Path) -> &mut (Vec<u8>, Vec<u8>) {
        let inode = self.folder_of(path).last().unwrap()[path];
        &mut self.inodes[inode]
    }

    /// Changes the names in the folder of a file.
    fn rename(&mut self, path: &Path, change: impl FnOnce(&mut FolderNames)) {
        let states = self.folder_of(path);
        let mut names = states.last().unwrap().clone();
        change(&mut names);
        states.push(names);
    }

    fn make(&mut self, event: &Event) {
        match event {
            Event::Create(path) if path.ends_with("LOCK") => {}
            Event::Create(path) => {
                let inode = self.inodes.len();
                self.inodes.push(Default::default());
                self.rename(path, |names| {
                    names.insert(path.clone(), inode);
                });
            }
            Event::Write(path, bytes) => self.inode(path).1.extend(bytes),
            Event::Sync(path) => {
                let (synced, written) = self.inode(path);
                synced.append(written);
            }
            Event::Rename(old, new) => self.rename(old, |names| {
                let inode = names.remove(old).unwrap();
                names.insert(new.clone(), inode);
            }),
            Event::Delete(path) => self.rename(path, |names| {
                names.remove(path);
            }),
            Event::SyncFolder(folder) => {
                // The store folder itself gets no names here.
                if let Some(states) = self.folders.get_mut(folder) {
                    states.drain(..states.len() - 1);
                }
            }
        }
    }

    /// Writes one possible state after a power cut: the names of some moment since the last sync of
    /// each folder, and a part of the unsynced bytes.
    fn cut(&self, store: &Path, random: &mut Random) {
        for (folder, states) in &self.folders {
            fs::create_dir(store.join(folder)).unwrap();
            for (path, &inode) in &states[random.below(states.len())] {
                let (synced, written) = &self.inodes[inode];
                let n_kept = match random.below(3) {
                    0 => 0,
                    1 => written.len(),
                    _ => random.below(written.len() + 1),
                };
                fs::write(store.join(path), [synced, &written[..n_kept]].concat()).unwrap();
            }
        }
    }
}

/// Starts the journal of the disk operations of a store; returns the disk as it is now, too.
fn start_journal(memory: &mut PerceptualMemory, folder: &Path) -> (Disk, Journal) {
    let disk = Disk::of(folder);
    let journal = Journal::default();
    memory.engine.set_observer(journaling(folder, &journal));
    (disk, journal)
}

/// Cuts the power after every `step`-th operation of a series of mutations.
fn check_cuts_while_teaching(step: usize) {
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.lease_track_ids(N_TRACKS).unwrap();
    let (mut disk, journal) = start_journal(&mut memory, folder.path());
    let mut acknowledged_at = Vec::new();
    for n in 0..2 * N_TRACKS {
        memory.apply(&mutation(n, CLOUD_BYTES)).unwrap();
        acknowledged_at.push(journal.lock().unwrap().len());
    }
    // The engine thread may be behind.
    memory.engine.settle().unwrap();
    let journal = journal.lock().unwrap();
    let is_table = |path: &Path| path.extension().is_some_and(|e| e == "ldb");
    let n_tables = journal
        .iter()
        .filter(|e| matches!(e, Event::Delete(path) if is_table(path)));
    assert!(n_tables.count() >= 4, "tables were merged");
    let mut random = Random::from_seed(1);
    for (i, event) in journal.iter().enumerate() {
        disk.make(event);
        // Names change seldom and matter most.
        let is_rare = !matches!(event, Event::Write(..) | Event::Sync(_));
        if (i + random.below(step)).is_multiple_of(step)
            || is_rare && random.below(step.min(8)) == 0
        {
            let left = self::folder();
            disk.cut(left.path(), &mut random);
            let n = acknowledged_at.partition_point(|&at| at <= i + 1) as u64;
            check_holds(left.path(), n, &format!("cut after change {i}"));
        }
    }
}

#[test]
fn power_cut_loses_nothing_acknowledged() {
    check_cuts_while_teaching(199);
}

#[test]
#[ignore = "long"]
fn long_power_cut_loses_nothing_acknowledged() {
    check_cuts_while_teaching(13);
}

/// Cuts the power after every `step`-th operation while a store is taught and archives.
fn check_cuts_while_archiving(step: usize) {
    const N_ARCHIVING_TRACKS: u64 = 40;
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.set_limits(archiving_limits());
    memory.lease_track_ids(N_TRACKS).unwrap();
    let (mut disk, journal) = start_journal(&mut memory, folder.path());
    let mut acknowledged_at = Vec::new();
    for n in 0..2 * N_ARCHIVING_TRACKS {
        memory.apply(&mutation(n, 100)).unwrap();
        acknowledged_at.push(journal.lock().unwrap().len());
        memory.archive_step().unwrap();
    }
    let journal = journal.lock().unwrap();
    let segments = journal.iter();
    let segments =
        segments.filter(|e| matches!(e, Event::Rename(_, to) if to.starts_with("history")));
    assert!(segments.count() >= 8, "segments were written");
    let mut random = Random::from_seed(3);
    for (i, event) in journal.iter().enumerate() {
        disk.make(event);
        if (i + random.below(step)).is_multiple_of(step) {
            let left = self::folder();
            disk.cut(left.path(), &mut random);
            let n = acknowledged_at.partition_point(|&at| at <= i + 1) as u64;
            let what = format!("cut after change {i} while archiving");
            check_holds(left.path(), n, &what);
            check_history(left.path(), &what);
        }
    }
}

fn archiving_limits() -> RetentionLimits {
    RetentionLimits {
        history: HistoryLimits {
            kept_entries: 8,
            segment_entries: 4,
            ..HistoryLimits::default()
        },
        ..RetentionLimits::default()
    }
}

/// Checks that the history is complete and sound, and that archiving goes on.
fn check_history(folder: &Path, what: &str) {
    let (mut memory, _) = open(folder);
    memory.set_limits(archiving_limits());
    for _ in 0..2 {
        let history = memory.history(1, usize::MAX).unwrap();
        let sequences = history.iter().map(|entry| entry.sequence);
        assert!(sequences.eq(1..=memory.sequence()), "{what}");
        let found = memory.checkpoint().unwrap().open().unwrap();
        assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0], "{what}");
        while memory.archive_step().unwrap() != ArchivingStep::Idle {}
    }
}

#[test]
fn power_cut_while_archiving_loses_nothing() {
    check_cuts_while_archiving(17);
}

#[test]
#[ignore = "long"]
fn long_power_cut_while_archiving_loses_nothing() {
    check_cuts_while_archiving(1);
}

#[test]
fn archive_that_cannot_be_written_leaves_the_store_usable() {
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.set_limits(archiving_limits());
    memory.lease_track_ids(N_TRACKS).unwrap();
    for n in 0..40 {
        memory.apply(&mutation(n, 100)).unwrap();
    }
    memory.engine.set_observer(Box::new(|change| match change {
        FileOperation::Write(path, _) if path.extension().is_some_and(|e| e == "partial") => {
            Err(io::Error::from(io::ErrorKind::StorageFull))
        }
        _ => Ok(()),
    }));
    let failed = memory.archive_step().unwrap_err();
    assert!(matches!(failed, Error::Storage(StorageError::Io { .. })));
    memory.apply(&mutation(40, 100)).unwrap();
    memory.engine.set_observer(Box::new(|_| Ok(())));
    while memory.archive_step().unwrap() != ArchivingStep::Idle {}
    assert!(memory.stats().unwrap().n_archived_entries > 0);
    drop(memory);
    check_holds(folder.path(), 41, "after a full disk");
    check_history(folder.path(), "after a full disk");
}

/// Cuts the power after random operations of an opening.
fn check_cuts_while_opening(n_cuts: usize) {
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.lease_track_ids(N_TRACKS).unwrap();
    for n in 0..40 {
        memory.apply(&mutation(n, 1000)).unwrap();
    }
    drop(memory);
    let database = folder.path().join("database");
    let before = Disk::of(folder.path());
    let journal = Journal::default();
    let observer = journaling(folder.path(), &journal);
    let mut engine = Database::open_observed(&database, WRITE_BUFFER_BYTES, observer).unwrap();
    assert!(
        check_consistency(&engine.reader(), None)
            .unwrap()
            .findings
            .is_empty()
    );
    engine.accept().unwrap();
    drop(engine);
    let journal = journal.lock().unwrap();
    assert!(
        journal
            .iter()
            .any(|event| matches!(event, Event::Delete(_)))
    );
    let mut random = Random::from_seed(2);
    for _ in 0..n_cuts {
        let mut disk = before.clone();
        let n_made = random.below(journal.len() + 1);
        journal[..n_made].iter().for_each(|event| disk.make(event));
        let left = self::folder();
        disk.cut(left.path(), &mut random);
        check_holds(
            left.path(),
            40,
            &format!("cut after change {n_made} of the opening"),
        );
    }
}

#[test]
fn power_cut_while_opening_loses_nothing() {
    check_cuts_while_opening(60);
}

#[test]
#[ignore = "long"]
fn long_power_cut_while_opening_loses_nothing() {
    check_cuts_while_opening(5_000);
}

/// Observer that fails the operation after `n`, and no other: the store itself must protect its
/// files.
fn disk_full_after(n: usize) -> Observer {
    let mut n_asked = 0;
    Box::new(move |operation| {
        if matches!(operation, FileOperation::Read(_)) {
            return Ok(());
        }
        n_asked += 1;
        if n_asked == n + 1 {
            Err(io::Error::from(io::ErrorKind::StorageFull))
        } else {
            Ok(())
        }
    })
}

/// Applies mutations until operation `n` fails; `true` if it did.
fn check_full_disk(n: usize) -> bool {
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.lease_track_ids(N_TRACKS).unwrap();
    memory.engine.set_observer(disk_full_after(n));
    let mut n_acknowledged = 0;
    let mut is_full = false;
    for m in 0..2 * N_TRACKS {
        match memory.apply(&mutation(m, CLOUD_BYTES)) {
            Ok(_) => n_acknowledged += 1,
            Err(error) => {
                assert!(
                    matches!(error, Error::Storage(StorageError::Io { .. })),
                    "{error}"
                );
                is_full = true;
                break;
            }
        }
    }
    // The engine thread may be behind.
    is_full |= memory.engine.settle().is_err();
    if is_full {
        let again = memory
            .apply(&mutation(n_acknowledged, CLOUD_BYTES))
            .unwrap_err();
        let is_refused = matches!(
            again,
            Error::Failed { .. } | Error::Storage(StorageError::Io { .. })
        );
        assert!(is_refused, "{again}");
    }
    drop(memory);
    check_holds(
        folder.path(),
        n_acknowledged,
        &format!("disk full after change {n}"),
    );
    is_full
}

#[test]
fn full_disk_is_an_error_and_loses_nothing() {
    // While the log is written, while a memtable is, and while tables are merged.
    let n_all = n_changes_on_disk();
    let shares = (0..8).map(|eighth| n_all * eighth / 9);
    for n in shares.chain([1, 2, 3]) {
        assert!(check_full_disk(n), "{n} of {n_all} changes are made");
    }
}

/// Number of file operations of all mutations; about the same each time.
fn n_changes_on_disk() -> usize {
    let folder = folder();
    let (mut memory, _) = open(folder.path());
    memory.lease_track_ids(N_TRACKS).unwrap();
    let (_, journal) = start_journal(&mut memory, folder.path());
    for m in 0..2 * N_TRACKS {
        memory.apply(&mutation(m, CLOUD_BYTES)).unwrap();
    }
    memory.engine.settle().unwrap();
    journal.lock().unwrap().len()
}

#[test]
#[ignore = "long"]
fn long_full_disk_is_an_error_and_loses_nothing() {
    for n in (0..n_changes_on_disk() * 8 / 9).step_by(7) {
        assert!(check_full_disk(n), "{n} changes are made");
    }
}

#[test]
fn failed_store_is_reopened_by_its_thread() {
    let folder = folder();
    let reported: Arc<Mutex<Vec<Condition>>> = Arc::default();
    let tell = Arc::clone(&reported);
    let config = StoreConfig {
        folder: folder.path().to_owned(),
        queue_capacity: 8,
        limits: RetentionLimits::default(),
        write_buffer_bytes: WRITE_BUFFER_BYTES,
        wall_clock: || 7,
        on_reopened: Box::new(move |report| {
            tell.lock()
                .unwrap()
                .push(report.as_ref().unwrap().condition.clone());
        }),
        on_notice: Box::new(|_| {}),
    };
    let (thread, handle, _) = StoreThread::start(config).unwrap();
    handle.mutate_and_wait(mutation(0, 10)).unwrap();
    // Asked before the thread is idle again: idle work would meet the full disk in its place.
    let (answer, answered) = std::sync::mpsc::channel();
    let on_full_disk = handle.clone();
    let fill = move |memory: &mut PerceptualMemory| {
        memory.engine.set_observer(disk_full_after(0));
        on_full_disk.mutate(mutation(1, 10), move |result| answer.send(result).unwrap());
        Ok(())
    };
    handle.read_and_wait(fill).unwrap();
    assert!(matches!(
        answered.recv().unwrap(),
        Err(Error::Storage(StorageError::Io { .. }))
    ));
    // The same again, and there is room now.
    handle.mutate_and_wait(mutation(1, 10)).unwrap();
    assert_eq!(*reported.lock().unwrap(), [Condition::Sound]);
    // Damage is met with a rebuilding.
    let spoil = |memory: &mut PerceptualMemory| {
        memory.engine.note_damage("a test's".to_owned());
        memory.views_of_track(0)
    };
    assert!(matches!(
        handle.read_and_wait(spoil),
        Err(Error::Storage(StorageError::Damaged { .. }))
    ));
    let read = |memory: &mut PerceptualMemory| memory.views_of_track(0);
    assert_eq!(handle.read_and_wait(read).unwrap().len(), 1);
    assert!(matches!(
        reported.lock().unwrap()[1],
        Condition::Rebuilt { .. }
    ));
    thread.stop().unwrap();
    let names: Vec<PathBuf> = fs::read_dir(folder.path())
        .unwrap()
        .flatten()
        .map(|entry| entry.path())
        .collect();
    assert!(
        names.contains(&folder.path().join("database.damaged-1")),
        "{names:?}"
    );
}

/// Observer that makes every `n`-th read fail for the medium, or all of them.
fn unreadable(n: u32) -> Observer {
    /// Linux error code of a medium that could not be read.
    const EIO: i32 = 5;
    let mut n_reads = 0;
    Box::new(move |operation| {
        n_reads += u32::from(matches!(operation, FileOperation::Read(_)));
        if matches!(operation, FileOperation::Read(_)) && n_reads % n == 0 {
            return Err(io::Error::from_raw_os_error(EIO));
        }
        Ok(())
    })
}

/// Store with the views of twenty tracks, which are in tables since it was opened again.
fn reopened_with_tables(folder: &Path) -> PerceptualMemory {
    let (mut memory, _) = open(folder);
    memory.lease_track_ids(N_TRACKS).unwrap();
    for n in 0..40 {
        memory.apply(&mutation(n, CLOUD_BYTES)).unwrap();
    }
    memory.close().unwrap();
    open(folder).0
}

#[test]
fn read_error_that_passes_is_no_damage() {
    let folder = folder();
    let mut memory = reopened_with_tables(folder.path());
    memory.engine.set_observer(unreadable(2));
    for track in 0..20 {
        assert_eq!(memory.views_of_track(track).unwrap().len(), 1);
    }
    memory.engine.set_observer(unreadable(1));
    let read = (0..20).try_for_each(|track| memory.views_of_track(track).map(|_| ()));
    let is_damage = matches!(read, Err(Error::Storage(StorageError::Damaged { .. })));
    assert!(is_damage, "an error that stays is damage: {read:?}");
}

#[test]
fn scan_on_a_medium_that_fails_reads_one_block_and_no_more() {
    let folder = folder();
    let memory = reopened_with_tables(folder.path());
    let n_reads = Arc::new(AtomicU32::new(0));
    let counted = Arc::clone(&n_reads);
    let mut fail = unreadable(1);
    memory.engine.set_observer(Box::new(move |operation| {
        counted.fetch_add(1, Ordering::Relaxed);
        fail(operation)
    }));
    let scanned = memory
        .engine
        .reader()
        .scan(b"", |_, _| ControlFlow::Continue(()));
    assert!(
        matches!(scanned, Err(durable_leveldb::Error::Damaged { .. })),
        "{scanned:?}"
    );
    // The block, and three attempts more.
    assert_eq!(n_reads.load(Ordering::Relaxed), 4);
}
