//! Archive tests: old history leaves the database, and nothing else changes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use perceptual_memory::{
    ArchivingStep, Condition, Error, HistoryEntry, HistoryLimits, PerceptualMemory,
    RetentionLimits, StoreRefusal, Verification,
};
use tempfile::TempDir;

use crate::builders::{
    answer, apply, correct, counts, fast_folder, forget, mutation, name, open, refusal, store,
    teach, undo, view,
};
use crate::reading::Follower;

/// Entries that stay in the database, and entries of a segment.
const KEPT: u64 = 8;
const SEGMENT: u64 = 4;
const N_TRACKS: u64 = 20;

pub(crate) fn limits() -> RetentionLimits {
    RetentionLimits {
        history: HistoryLimits {
            kept_entries: KEPT,
            segment_entries: SEGMENT,
            ..HistoryLimits::default()
        },
        ..RetentionLimits::default()
    }
}

/// Archives until nothing is due; returns the dropped ranges.
pub(crate) fn archive(memory: &mut PerceptualMemory) -> Vec<(u64, u64)> {
    let mut dropped = Vec::new();
    loop {
        match memory.archive_step().unwrap() {
            ArchivingStep::Idle => return dropped,
            ArchivingStep::Done => {}
            ArchivingStep::Dropped { first, last } => dropped.push((first, last)),
        }
    }
}

/// Store with two entries a track: a view is stored and taught.
fn taught_store() -> (TempDir, PerceptualMemory) {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    memory.set_limits(limits());
    for track in 1..=N_TRACKS {
        let id = u128::from(2 * track);
        apply(
            &mut memory,
            &[
                store(id - 1, vec![view(track, 0, 0)]),
                teach(id, track, "Mug"),
            ],
        );
    }
    (folder, memory)
}

fn history(memory: &mut PerceptualMemory) -> Vec<HistoryEntry> {
    memory.history(1, usize::MAX).unwrap()
}

fn verify(memory: &mut PerceptualMemory) -> Verification {
    let checkpoint = memory.checkpoint().unwrap().open().unwrap();
    checkpoint.verify(|_| {}).unwrap()
}

/// Names of the segment files, in order.
fn segments(folder: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(folder.join("history")).unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn archive_keeps_the_whole_history_readable() {
    let (folder, mut memory) = taught_store();
    let before = history(&mut memory);
    assert_eq!(archive(&mut memory), []);
    let stats = memory.stats().unwrap();
    assert_eq!(stats.n_archived_entries, 2 * N_TRACKS - KEPT);
    assert_eq!(
        segments(folder.path()).len() as u64,
        (2 * N_TRACKS - KEPT) / SEGMENT
    );
    assert!(stats.n_archive_bytes > 0);
    for _ in 0..2 {
        assert_eq!(history(&mut memory), before);
        // A page from the archive and the database.
        let page = memory.history(2 * N_TRACKS - KEPT - 1, 4).unwrap();
        let sequences: Vec<u64> = page.iter().map(|entry| entry.sequence).collect();
        let first = 2 * N_TRACKS - KEPT - 1;
        assert_eq!(sequences, (first..first + 4).collect::<Vec<_>>());
        let found = verify(&mut memory);
        assert_eq!(found.findings, [""; 0]);
        assert_eq!(found.n_history, 2 * N_TRACKS);
        drop(memory);
        let report;
        (memory, report) = open(&folder);
        assert_eq!(report.condition, Condition::Sound, "{report}");
        assert_eq!(report.n_history, 2 * N_TRACKS);
        assert_eq!(report.notes, [""; 0]);
    }
}

#[test]
fn archived_entries_leave_the_database() {
    let (_folder, mut memory) = taught_store();
    archive(&mut memory);
    let mut n_entries = 0;
    let count = |key: &[u8], _: &[u8]| n_entries += u64::from(key.first() == Some(&b'h'));
    memory.visit_records(count).unwrap();
    assert_eq!(n_entries, KEPT);
}

#[test]
fn archived_mutation_is_answered_and_undone() {
    let (folder, mut memory) = taught_store();
    archive(&mut memory);
    drop(memory);
    let (mut memory, _) = open(&folder);
    assert_eq!(apply(&mut memory, &[teach(2, 1, "Mug")]), [answer(2, 1)]);
    assert_eq!(memory.sequence(), 2 * N_TRACKS, "nothing was made twice");
    apply(&mut memory, &[undo(100, 2)]);
    assert_eq!(counts(&memory), [("Mug".to_owned(), N_TRACKS - 1)]);
    assert_eq!(verify(&mut memory).findings, [""; 0]);
}

#[test]
fn archived_mutation_is_forgotten_after_its_time() {
    let (_folder, mut memory) = taught_store();
    let mut limits = limits();
    // The times of the mutations are their ids.
    limits.history.answered_kept_ns = 20;
    memory.set_limits(limits);
    archive(&mut memory);
    assert_eq!(apply(&mut memory, &[teach(30, 15, "Mug")]), [answer(30, 1)]);
    let again = apply(&mut memory, &[teach(2, 1, "Mug")]);
    assert_eq!(again, [answer(2 * N_TRACKS + 1, 0)], "it is a new request");
}

#[test]
fn replica_with_an_archived_position_loads_again() {
    let (_folder, mut memory) = taught_store();
    let mut follower = Follower::load(&mut memory, 0, |_| {});
    apply(&mut memory, &[correct(100, 1, "Cup")]);
    archive(&mut memory);
    assert!(follower.follow(&mut memory, 300), "its position is recent");
    for id in 101..150 {
        apply(
            &mut memory,
            &[correct(id, 1, ["Cup", "Mug"][id as usize % 2])],
        );
    }
    archive(&mut memory);
    assert!(
        !follower.follow(&mut memory, 300),
        "its position is archived"
    );
}

#[test]
fn replay_reads_the_archive() {
    let (_folder, mut memory) = taught_store();
    apply(&mut memory, &[forget(100, "Mug")]);
    archive(&mut memory);
    let copy = fast_folder();
    let (mut copy, _) = memory.replay_into(copy.path()).unwrap();
    copy.set_limits(limits());
    archive(&mut copy);
    assert_eq!(records(&mut copy), records(&mut memory));
}

pub(crate) fn records(memory: &mut PerceptualMemory) -> BTreeMap<Vec<u8>, Vec<u8>> {
    let mut records = BTreeMap::new();
    let note = |key: &[u8], record: &[u8]| {
        records.insert(key.to_vec(), record.to_vec());
    };
    memory.visit_records(note).unwrap();
    records
}

#[test]
fn segment_beyond_the_archive_record_does_not_count() {
    let (folder, mut memory) = taught_store();
    let before = history(&mut memory);
    // As a crash leaves it: the segment is there, its entries are still in the database.
    while segments_or_none(folder.path()) == 0 {
        memory.archive_step().unwrap();
    }
    fs::write(
        folder
            .path()
            .join("history/000000000005-000000000008.partial"),
        "half",
    )
    .unwrap();
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(segments_or_none(folder.path()), 0, "it was removed");
    memory.set_limits(limits());
    archive(&mut memory);
    assert_eq!(history(&mut memory), before);
    assert_eq!(verify(&mut memory).findings, [""; 0]);
}

/// Number of files in the archive that are complete.
fn segments_or_none(folder: &Path) -> usize {
    if !folder.join("history").exists() {
        return 0;
    }
    let is_whole = |path: &&PathBuf| path.extension().is_none();
    segments(folder).iter().filter(is_whole).count()
}

/// Damages the second segment in every way and checks what it costs.
fn check_damaged_segment(how: &str, damage: impl FnOnce(&Path), n_lost: u64) {
    let (folder, mut memory) = taught_store();
    archive(&mut memory);
    drop(memory);
    damage(&segments(folder.path())[1]);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{how}: {report}");
    assert!(verify(&mut memory).n_findings > 0, "{how}");
    // The store works, and reading the damaged part is an error, not a loss of the store.
    let read = memory.history(1, usize::MAX);
    let is_told = matches!(read, Err(Error::ArchiveDamaged { .. }));
    assert!(is_told || !report.notes.is_empty(), "{how}: {read:?}");
    apply(&mut memory, &[teach(100, 1, "Mug")]);
    drop(memory);
    let (mut memory, report) = PerceptualMemory::open_and_rebuild(folder.path(), 5).unwrap();
    let loss = report.loss();
    assert_eq!(
        (loss.n_history, loss.n_views),
        (n_lost, 0),
        "{how}: {report}"
    );
    assert_eq!(counts(&memory), [("Mug".to_owned(), N_TRACKS)], "{how}");
    assert_eq!(verify(&mut memory).findings, [""; 0], "{how}");
    let n_entries = history(&mut memory).len() as u64;
    assert_eq!(n_entries, 2 * N_TRACKS + 2 - n_lost, "{how}");
    memory.set_limits(limits());
    archive(&mut memory);
    assert_eq!(verify(&mut memory).findings, [""; 0], "{how}");
}

#[test]
fn damaged_segment_costs_its_damaged_entries() {
    check_damaged_segment("missing", |path| fs::remove_file(path).unwrap(), SEGMENT);
    let flip = |at: fn(usize) -> usize| {
        move |path: &Path| {
            let mut bytes = fs::read(path).unwrap();
            let at = at(bytes.len());
            bytes[at] ^= 0x10;
            fs::write(path, bytes).unwrap();
        }
    };
    check_damaged_segment("an entry", flip(|_| 60), 1);
    check_damaged_segment("the index", flip(|n| n - 20), SEGMENT);
    check_damaged_segment("its end", flip(|n| n - 1), SEGMENT);
    let cut = |path: &Path| fs::write(path, &fs::read(path).unwrap()[..100]).unwrap();
    check_damaged_segment("cut", cut, SEGMENT);
}

#[test]
fn damaged_database_is_rebuilt_from_the_archive() {
    let (folder, mut memory) = taught_store();
    archive(&mut memory);
    let before = history(&mut memory);
    drop(memory);
    // Everything but the archive and the content is lost.
    fs::write(folder.path().join("database/CURRENT"), "MANIFEST-999999\n").unwrap();
    let (mut memory, report) = open(&folder);
    assert!(report.is_damage() && !report.is_loss(), "{report}");
    let after = history(&mut memory);
    assert_eq!(after[..before.len()], before);
    assert_eq!(counts(&memory), [("Mug".to_owned(), N_TRACKS)]);
    assert_eq!(verify(&mut memory).findings, [""; 0]);
    assert_eq!(apply(&mut memory, &[teach(2, 1, "Mug")]), [answer(2, 1)]);
}

#[test]
fn archive_survives_the_loss_of_the_database() {
    let (folder, mut memory) = taught_store();
    archive(&mut memory);
    let n_archived = memory.stats().unwrap().n_archived_entries;
    let before = history(&mut memory);
    drop(memory);
    fs::remove_dir_all(folder.path().join("database")).unwrap();
    let (mut memory, report) = open(&folder);
    let loss = report.loss();
    assert_eq!((loss.n_history, loss.n_views), (KEPT, N_TRACKS), "{report}");
    let after = history(&mut memory);
    let n_archived = n_archived as usize;
    assert_eq!(after[..n_archived], before[..n_archived]);
    assert_eq!(counts(&memory), []);
    assert_eq!(verify(&mut memory).findings, [""; 0]);
    assert!(memory.lease_track_ids(1).unwrap() > N_TRACKS);
}

#[test]
fn archive_above_its_limit_drops_the_oldest_entries() {
    let (folder, mut memory) = taught_store();
    archive(&mut memory);
    let n_bytes = memory.stats().unwrap().n_archive_bytes;
    let mut limits = limits();
    limits.history.archive_max_bytes = n_bytes / 2;
    memory.set_limits(limits);
    // While a checkpoint is read, nothing is dropped.
    let checkpoint = memory.checkpoint().unwrap();
    assert_eq!(archive(&mut memory), []);
    drop(checkpoint);
    let dropped = archive(&mut memory);
    assert_eq!(dropped[0], (1, SEGMENT));
    let last = dropped[dropped.len() - 1].1;
    let stats = memory.stats().unwrap();
    assert!(stats.n_archive_bytes <= n_bytes / 2);
    assert_eq!(stats.n_dropped_entries, last);
    assert_eq!(
        refusal(memory.apply(&undo(100, 1))),
        StoreRefusal::UnknownEntry { sequence: 1 }
    );
    for must_rebuild in [false, true] {
        assert_eq!(history(&mut memory)[0].sequence, last + 1);
        assert_eq!(verify(&mut memory).findings, [""; 0]);
        assert_eq!(counts(&memory), [("Mug".to_owned(), N_TRACKS)]);
        drop(memory);
        let open = if must_rebuild {
            PerceptualMemory::open_and_rebuild
        } else {
            PerceptualMemory::open
        };
        let report;
        (memory, report) = open(folder.path(), 5).unwrap();
        assert!(!report.is_loss(), "{report}");
    }
    assert_eq!(verify(&mut memory).findings, [""; 0]);
}

#[test]
fn archive_skips_lost_entries() {
    let (folder, memory) = taught_store();
    drop(memory);
    let logs = fs::read_dir(folder.path().join("database")).unwrap();
    let mut logs: Vec<PathBuf> = logs.map(|file| file.unwrap().path()).collect();
    logs.retain(|path| path.extension().is_some_and(|extension| extension == "wal"));
    let log = logs.iter().max().unwrap();
    let mut bytes = fs::read(log).unwrap();
    let middle = bytes.len() / 3;
    bytes[middle] ^= 1;
    fs::write(log, bytes).unwrap();
    let (mut memory, report) = open(&folder);
    assert_eq!(report.loss().n_history, 1, "{report}");
    let before = history(&mut memory);
    memory.set_limits(limits());
    for id in 200..210 {
        apply(&mut memory, &[mutation(id, rename(id))]);
        archive(&mut memory);
    }
    assert_eq!(history(&mut memory)[..before.len()], before);
    let found = verify(&mut memory);
    assert_eq!(found.findings, [""; 0]);
    assert_eq!(found.n_history, before.len() as u64 + 10);
    let n_lost = memory.stats().unwrap().n_lost_entries;
    drop(memory);
    let (memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(memory.stats().unwrap().n_lost_entries, n_lost);
}

/// Renames a category to and fro.
fn rename(id: u128) -> perceptual_memory::StoreChange {
    let names = ["Mug", "Jug"].map(name);
    let [from, to] = if id.is_multiple_of(2) {
        names
    } else {
        let [mug, jug] = names;
        [jug, mug]
    };
    perceptual_memory::StoreChange::Rename { from, to }
}
