//! Corruption tests: a store with damaged files opens, reports its losses exactly, and works.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use perceptual_memory::{
    CapturedView, Condition, LabelStatus, Mutation, OpenReport, Operation, PerceptualMemory,
};
use random::Random;
use tempfile::TempDir;

use crate::builders::{NOW_NS, apply, correct, fast_folder, forget, open, store, teach, view};

/// Twenty mutations of every kind; mutation `n` makes history entry `n`.
fn mutations() -> Vec<Mutation> {
    let mut mutations = Vec::new();
    for track in 1..=5_u64 {
        let id = mutations.len() as u128 + 1;
        let category = ["Mug", "Bowl"][track as usize % 2];
        mutations.push(store(id, vec![view(track, 0, 0), view(track, 1, 0)]));
        mutations.push(teach(id + 1, track, category));
        if track == 3 {
            mutations.push(forget(id + 2, "Bowl"));
        } else {
            mutations.push(correct(id + 2, track, "Cup"));
        }
        mutations.push(store(id + 3, vec![view(track, 2, 0)]));
    }
    mutations
}

/// Views and label status of each track.
type StoreContents = Vec<Vec<(CapturedView, LabelStatus)>>;

/// Content of an undamaged store after the first `n` mutations.
fn state_after(n: usize) -> &'static StoreContents {
    static STATES: LazyLock<Vec<StoreContents>> = LazyLock::new(|| {
        let folder = fast_folder();
        let (mut memory, _) = open(&folder);
        let mut states = vec![state(&mut memory)];
        for mutation in mutations() {
            apply(&mut memory, &[mutation]);
            states.push(state(&mut memory));
        }
        states
    });
    &STATES[n]
}

fn state(memory: &mut PerceptualMemory) -> StoreContents {
    let track = |track| {
        let stored = memory.views_of_track(track).unwrap();
        stored.into_iter().map(|s| (s.view, s.standing)).collect()
    };
    (1..=5).map(track).collect()
}

/// Store with all mutations, in a table file if `is_closed`, otherwise in the log.
fn whole_store(is_closed: bool) -> TempDir {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    apply(&mut memory, &mutations());
    if is_closed {
        memory.close().unwrap();
    } else {
        drop(memory);
    }
    folder
}

fn copy(folder: &Path) -> TempDir {
    let copy = fast_folder();
    fs::create_dir(copy.path().join("database")).unwrap();
    for sub in ["", "database"] {
        for entry in fs::read_dir(folder.join(sub)).unwrap().flatten() {
            if entry.file_type().unwrap().is_file() {
                fs::copy(entry.path(), copy.path().join(sub).join(entry.file_name())).unwrap();
            }
        }
    }
    copy
}

/// Newest non-empty database file with this extension.
fn newest(folder: &Path, extension: &str) -> PathBuf {
    let entries = fs::read_dir(folder.join("database")).unwrap().flatten();
    let paths = entries.map(|entry| entry.path());
    let is_wanted = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        (name.ends_with(extension) || name.starts_with(extension))
            && fs::metadata(path).unwrap().len() > 0
    };
    paths.filter(is_wanted).max().expect("such a file")
}

/// Checks that the store takes a mutation and keeps it across a reopening.
fn check_it_goes_on(folder: &TempDir, mut memory: PerceptualMemory) {
    let sequence = memory.sequence();
    apply(
        &mut memory,
        &[store(1000, vec![view(50, 0, 0)]), teach(1001, 50, "Later")],
    );
    let expected = state(&mut memory);
    drop(memory);
    let (mut memory, report) = open(folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(memory.sequence(), sequence + 2);
    assert_eq!(memory.views_of_track(50).unwrap().len(), 1);
    assert_eq!(state(&mut memory), expected);
}

fn check_cut_log(step: usize) {
    let whole = whole_store(false);
    let n_bytes = fs::metadata(newest(whole.path(), ".wal")).unwrap().len() as usize;
    for cut in (0..=n_bytes).step_by(step) {
        let folder = copy(whole.path());
        let log = newest(folder.path(), ".wal");
        fs::OpenOptions::new()
            .write(true)
            .open(&log)
            .unwrap()
            .set_len(cut as u64)
            .unwrap();
        let cut_log = fs::read(&log).unwrap();
        let (mut memory, report) = open(&folder);
        let n_kept = match &report.condition {
            Condition::Sound => mutations().len(),
            Condition::Rebuilt {
                loss, set_aside, ..
            } => {
                let kept = set_aside.as_ref().unwrap().join(log.file_name().unwrap());
                assert_eq!(fs::read(kept).unwrap(), cut_log, "the damaged log is kept");
                mutations().len() - loss.n_history as usize
            }
            // Not even the record about the store is left.
            Condition::Replaced { .. } => 0,
            other => panic!("cut at {cut}: {other:?}"),
        };
        assert_eq!(report.is_loss(), cut != n_bytes, "cut at {cut}: {report}");
        assert_eq!(
            state(&mut memory),
            *state_after(n_kept),
            "cut at {cut}: {report}"
        );
        check_it_goes_on(&folder, memory);
    }
}

#[test]
fn truncated_log_loses_whole_changes_and_counts_them() {
    check_cut_log(397);
}

#[test]
#[ignore = "long"]
fn long_truncated_log_loses_whole_changes_and_counts_them() {
    check_cut_log(1);
}

/// `true` if every view and label in the store was really stored.
fn is_part_of_the_truth(memory: &mut PerceptualMemory) -> bool {
    let known = || (0..=mutations().len()).map(state_after);
    state(memory).iter().enumerate().all(|(track, views)| {
        views.iter().all(|(view, standing)| {
            let mut later = known().flat_map(|state| &state[track]);
            later.any(|(known, known_standing)| {
                let without_cloud = CapturedView {
                    points: None,
                    ..known.clone()
                };
                standing == known_standing && (view == known || *view == without_cloud)
            })
        })
    })
}

/// Number of lost history entries, views and point clouds.
fn count_missing(memory: &mut PerceptualMemory) -> (u64, u64, u64) {
    let n = mutations().len() as u64;
    let history = memory.history(1, usize::MAX).unwrap();
    let is_own = |operation: &Operation| matches!(operation, Operation::Rebuild { .. });
    let n_whole = history.iter().filter(|e| !is_own(&e.operation)).count() as u64;
    let (mut n_views, mut n_clouds) = (0, 0);
    for (kept, whole) in state(memory).iter().zip(state_after(n as usize)) {
        for (view, _) in whole {
            match kept.iter().find(|(known, _)| known.id == view.id) {
                None => n_views += 1,
                Some((known, _)) => n_clouds += u64::from(known.points != view.points),
            }
        }
    }
    (n - n_whole, n_views, n_clouds)
}

/// Opens a store with damaged files, verifies it, and rebuilds it after a late finding. The
/// reported losses must be the actual ones.
fn check_damaged(folder: &TempDir, what: &str) -> OpenReport {
    let (mut memory, mut report) =
        PerceptualMemory::open(folder.path(), NOW_NS).unwrap_or_else(|e| panic!("{what}: {e}"));
    let read = (1..=5).try_for_each(|track| memory.views_of_track(track).map(|_| ()));
    if let Err(error) = read {
        let is_new = report.is_damage();
        assert!(!is_new, "{what}: a store just rebuilt is damaged: {error}");
        assert!(
            matches!(
                error,
                perceptual_memory::Error::Storage(perceptual_memory::StorageError::Damaged { .. })
            ),
            "{what}: {error}"
        );
        let failed = memory.apply(&teach(77, 1, "Mug")).unwrap_err();
        assert!(
            matches!(failed, perceptual_memory::Error::Failed { .. }),
            "{what}: {failed}"
        );
        drop(memory);
        (memory, report) = PerceptualMemory::open_and_rebuild(folder.path(), NOW_NS).unwrap();
        assert!(report.is_damage(), "{what}: {report}");
    }
    if let Condition::Replaced { .. } = report.condition {
        assert_eq!(memory.categories(), [], "{what}: {report}");
    }
    let loss = report.loss();
    let told = (loss.n_history, loss.n_views, loss.n_clouds);
    let missing = count_missing(&mut memory);
    assert_eq!(told.0, missing.0, "{what}: history: {report}");
    if !matches!(report.condition, Condition::Replaced { .. }) {
        assert_eq!(told, missing, "{what}: {report}");
    }
    assert!(is_part_of_the_truth(&mut memory), "{what}: {report}");
    check_it_goes_on(folder, memory);
    report
}

fn check_flipped_bytes(extension: &str, is_closed: bool, step: usize, seed: u64) {
    let whole = whole_store(is_closed);
    let n_bytes = fs::metadata(newest(whole.path(), extension)).unwrap().len() as usize;
    let mut random = Random::from_seed(seed);
    let (mut n_told, mut n_flips) = (0, 0);
    for block in 0..n_bytes.div_ceil(step) {
        let at = (block * step + random.below(step)).min(n_bytes - 1);
        let folder = copy(whole.path());
        let path = newest(folder.path(), extension);
        let mut bytes = fs::read(&path).unwrap();
        bytes[at] ^= 1 << random.below(8);
        fs::write(&path, bytes).unwrap();
        let report = check_damaged(&folder, &format!("{extension}, byte {at}"));
        n_told += u32::from(report.is_damage());
        n_flips += 1;
    }
    // A few bytes of a table's footer mean nothing.
    assert!(
        2 * n_told >= n_flips,
        "{n_told} of {n_flips} flips in {extension} were told"
    );
}

#[test]
fn corrupted_byte_is_reported_and_the_rest_is_kept() {
    check_flipped_bytes(".wal", false, 499, 1);
    check_flipped_bytes(".ldb", true, 499, 2);
    check_flipped_bytes("MANIFEST", true, 31, 3);
    check_flipped_bytes("CURRENT", true, 5, 4);
}

#[test]
#[ignore = "long"]
fn long_corrupted_byte_is_reported_and_the_rest_is_kept() {
    check_flipped_bytes(".wal", false, 3, 5);
    check_flipped_bytes(".ldb", true, 3, 6);
    check_flipped_bytes("MANIFEST", true, 1, 7);
    check_flipped_bytes("CURRENT", true, 1, 8);
}

#[test]
fn corrupted_byte_in_the_log_costs_one_change() {
    let folder = whole_store(false);
    let log = newest(folder.path(), ".wal");
    let mut bytes = fs::read(&log).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x40;
    fs::write(&log, bytes).unwrap();
    let store_id = fs::read(folder.path().join("acknowledged")).unwrap()[8..24].to_vec();
    let report = check_damaged(&folder, "the middle of the log");
    let Condition::Rebuilt { loss, findings, .. } = &report.condition else {
        panic!("{report}");
    };
    assert_eq!(loss.n_history, 1, "{report}");
    assert!(
        findings
            .iter()
            .any(|finding| finding.contains("history entries 10 to 10 are missing")),
        "{report}"
    );
    let (memory, _) = open(&folder);
    assert_ne!(
        memory.store_id().0.to_le_bytes().to_vec(),
        store_id,
        "readers must load again"
    );
}

#[test]
fn missing_manifest_or_current_loses_nothing() {
    for file in ["MANIFEST", "CURRENT"] {
        let folder = whole_store(true);
        fs::remove_file(newest(folder.path(), file)).unwrap();
        let report = check_damaged(&folder, file);
        assert!(report.is_damage() && !report.is_loss(), "{file}: {report}");
        assert!(folder.path().join("database.damaged-1").exists());
    }
}

#[test]
fn missing_file_is_reported_as_loss() {
    for (file, is_kept) in [(".ldb", false), (".wal", true)] {
        let folder = whole_store(file != ".wal");
        fs::remove_file(newest(folder.path(), file)).unwrap();
        let (mut memory, report) = open(&folder);
        assert!(report.is_loss(), "{file}: {report}");
        let set_aside = folder.path().join("database.damaged-1");
        // Without its log the database had nothing but its name.
        assert!(set_aside.exists() || is_kept, "{file}: {report}");
        // The ids of tracks that perception may still use.
        assert!(memory.lease_track_ids(1).unwrap() > 5, "{file}");
        check_it_goes_on(&folder, memory);
    }
}

/// Damages a file in a random way; returns a description.
fn damage(path: &Path, random: &mut Random) -> String {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let mut bytes = fs::read(path).unwrap();
    let at = random.below(bytes.len());
    let end = (at + random.below(600)).min(bytes.len());
    let how = match random.below(6) {
        0 => {
            fs::remove_file(path).unwrap();
            return format!("{name} missing");
        }
        1 => {
            bytes.truncate(at);
            format!("{name} cut at {at}")
        }
        2 => {
            bytes[at..end].fill(0);
            format!("{name} zero from {at} to {end}")
        }
        3 => {
            bytes[at..end].fill_with(|| random.next_u64() as u8);
            format!("{name} rubbish from {at} to {end}")
        }
        _ => {
            let bit = random.below(8);
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << bit;
            }
            format!("{name} byte {at} bit {bit}")
        }
    };
    fs::write(path, bytes).unwrap();
    how
}

fn check_random_damage(n_rounds: usize, seed: u64) {
    let mut random = Random::from_seed(seed);
    let wholes = [whole_store(false), whole_store(true)];
    let kinds = [
        ".wal",
        ".ldb",
        "MANIFEST",
        "CURRENT",
        "acknowledged",
        "LOCK",
    ];
    let (mut n_damages, mut n_losses) = (0, 0);
    for round in 0..n_rounds {
        let is_closed = random.below(2);
        let folder = copy(wholes[is_closed].path());
        // In a closed store everything is in the table, otherwise in the log.
        let kind = kinds[random.below(kinds.len())];
        let path = match kind {
            "acknowledged" => folder.path().join(kind),
            "LOCK" => folder.path().join("database").join(kind),
            ".ldb" if is_closed == 0 => newest(folder.path(), ".wal"),
            ".wal" if is_closed == 1 => newest(folder.path(), ".ldb"),
            _ => newest(folder.path(), kind),
        };
        let how = damage(&path, &mut random);
        let report = check_damaged(&folder, &format!("seed {seed}, round {round}: {how}"));
        n_damages += u32::from(report.is_damage());
        n_losses += u32::from(report.is_loss());
    }
    println!("{n_rounds} damages: {n_damages} found and told, {n_losses} with a loss");
    assert!(n_damages > 0 && n_losses > 0);
}

#[test]
fn random_damage_is_reported_exactly() {
    check_random_damage(100, 1);
}

#[test]
#[ignore = "long"]
fn long_random_damage_is_reported_exactly() {
    for seed in 0..10 {
        check_random_damage(1_000, 100 + seed);
    }
}

#[test]
fn invalid_file_name_in_current_is_damage() {
    let long = "x".repeat(4000);
    for current in [
        "MAN\0\0-000004\n",
        "\n",
        "..\n",
        "/\n",
        "CURRENT/x\n",
        &long,
    ] {
        let folder = whole_store(true);
        fs::write(folder.path().join("database/CURRENT"), current).unwrap();
        let report = check_damaged(&folder, &format!("CURRENT is {current:?}"));
        assert!(report.is_damage() && !report.is_loss(), "{report}");
    }
}

#[test]
fn missing_database_is_reported() {
    let folder = whole_store(true);
    fs::remove_dir_all(folder.path().join("database")).unwrap();
    let (mut memory, report) = open(&folder);
    assert!(
        matches!(
            report.condition,
            Condition::Replaced {
                set_aside: None,
                ..
            }
        ),
        "{report}"
    );
    assert_eq!(memory.lease_track_ids(1).unwrap(), 6);
}

#[test]
fn two_newest_damaged_databases_are_kept() {
    let folder = whole_store(true);
    for n in 1..=4 {
        fs::write(folder.path().join("database/CURRENT"), "MANIFEST-999999\n").unwrap();
        let (memory, report) = open(&folder);
        assert!(report.is_damage() && !report.is_loss(), "{report}");
        assert!(
            folder
                .path()
                .join(format!("database.damaged-{n}/CURRENT"))
                .exists()
        );
        let is_kept = |n: u32| folder.path().join(format!("database.damaged-{n}")).exists();
        let kept: Vec<u32> = (1..=n).filter(|n| is_kept(*n)).collect();
        assert_eq!(kept, (n.saturating_sub(1).max(1)..=n).collect::<Vec<_>>());
        if n == 4 {
            check_it_goes_on(&folder, memory);
        }
    }
}

#[test]
fn watermark_that_is_unreadable_loses_nothing() {
    for bytes in [&b""[..], b"x", &[7; 40], &[0; 4000]] {
        let folder = whole_store(true);
        fs::write(folder.path().join("acknowledged"), bytes).unwrap();
        let (memory, report) = open(&folder);
        assert_eq!(report.condition, Condition::Sound, "{report}");
        assert_eq!(
            report.notes.len(),
            usize::from(!bytes.is_empty()),
            "{report}"
        );
        check_it_goes_on(&folder, memory);
    }
}

#[test]
fn rebuild_that_was_interrupted_is_finished_or_restarted() {
    // Half a copy, beside a whole database.
    let folder = whole_store(true);
    fs::create_dir(folder.path().join("database.rebuilding")).unwrap();
    fs::write(folder.path().join("database.rebuilding/CURRENT"), "half").unwrap();
    let (memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound);
    check_it_goes_on(&folder, memory);
    // A whole copy, before and after the damaged one was set aside.
    for is_aside in [false, true] {
        let folder = whole_store(true);
        let database = folder.path().join("database");
        let copied = copy(folder.path());
        fs::rename(&database, folder.path().join("database.rebuilt")).unwrap();
        if !is_aside {
            fs::rename(copied.path().join("database"), &database).unwrap();
        }
        let (mut memory, report) = open(&folder);
        assert_eq!(report.condition, Condition::Sound);
        assert_eq!(folder.path().join("database.damaged-1").exists(), !is_aside);
        assert_eq!(state(&mut memory), *state_after(mutations().len()));
    }
}
