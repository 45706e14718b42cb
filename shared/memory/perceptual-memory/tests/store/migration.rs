//! Migration tests: stores of released versions are converted completely.
//!
//! The fixture of schema 1 was written by version 0.1.0: five tracks of three views, taught,
//! corrected and forgotten as below, reopened before the fourth. That of schema 2 was written by
//! the last version before schema 3: the same, then two versions of a document, another one that
//! was removed, a forgotten view that was purged, and the undo of a forgetting.

use std::fs;
use std::path::Path;

use perceptual_memory::{Condition, PerceptualMemory};
use tempfile::TempDir;

use crate::builders::{NOW_NS, apply, counts, fast_folder, name_of, open, store, teach, view};

/// Sum of the digests in the history of the fixture of schema 3.
const DIGESTS_OF_SCHEMA_3: u128 = 0x99b7_1f82_8880_bfdd_1644_cf9e_5e18_0424;

fn fixture(schema: &str) -> TempDir {
    let folder = fast_folder();
    let source = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures")
        .join(schema);
    for sub in ["", "database", "history"] {
        let Ok(entries) = fs::read_dir(source.join(sub)) else {
            continue;
        };
        fs::create_dir_all(folder.path().join(sub)).unwrap();
        for entry in entries.flatten() {
            if entry.file_type().unwrap().is_file() {
                let to = folder.path().join(sub).join(entry.file_name());
                fs::copy(entry.path(), to).unwrap();
            }
        }
    }
    folder
}

fn check_content(memory: &mut PerceptualMemory) {
    // Bowl was forgotten with track 3, and track 1 had been corrected before that.
    for (track, name) in [(1, "Cup"), (2, "Cup"), (4, "Cup"), (5, "Cup")] {
        let stored = memory.views_of_track(track).unwrap();
        let names: Vec<_> = stored.iter().map(name_of).collect();
        assert_eq!(names, [Some(name), Some(name), None], "track {track}");
        for (i, stored) in (0..).zip(&stored) {
            assert_eq!(stored.view, view(track, i, 0));
        }
    }
    let forgotten = memory.views_of_track(3).unwrap();
    assert!(forgotten.iter().all(|stored| name_of(stored).is_none()));
    assert_eq!(counts(memory), [("Cup".to_owned(), 8)]);
}

#[test]
fn migration_of_schema_1_is_complete() {
    let folder = fixture("schema-1");
    let (mut memory, report) = open(&folder);
    let Condition::Migrated {
        schema: 1,
        set_aside,
    } = &report.condition
    else {
        panic!("{report}");
    };
    assert!(set_aside.as_ref().unwrap().join("CURRENT").exists());
    check_content(&mut memory);
    let history = memory.history(1, 100).unwrap();
    assert_eq!(history.len(), 21, "twenty entries, and the one about this");
    assert_eq!(history[1].wall_ns, NOW_NS + 2);
    assert_eq!(&*history[1].author, "anna");
    // What was asked then is answered, and leased ids are not given again.
    assert_eq!(apply(&mut memory, &[teach(2, 1, "Mug")])[0].sequence, 2);
    assert!(memory.lease_track_ids(1).unwrap() > 43);
    let found = memory.checkpoint().unwrap().open().unwrap();
    assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    check_content(&mut memory);
    apply(&mut memory, &[store(99, vec![view(50, 0, 0)])]);
}

#[test]
fn migration_of_a_damaged_schema_1_recovers_intact_records() {
    let folder = fixture("schema-1");
    let log = folder.path().join("database/000006.log");
    let mut bytes = fs::read(&log).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&log, bytes).unwrap();
    let (mut memory, report) = open(&folder);
    assert_eq!(report.loss().n_history, 1, "{report}");
    assert_eq!(memory.views_of_track(1).unwrap().len(), 3);
    assert_eq!(memory.history(1, 100).unwrap().len(), 20);
}

#[test]
fn migration_of_schema_2_is_complete() {
    let folder = fixture("schema-2");
    let (mut memory, report) = open(&folder);
    let is_migrated = matches!(report.condition, Condition::Migrated { schema: 2, .. });
    assert!(is_migrated, "{report}");
    for reopened in [false, true] {
        let cup = Some("Cup".to_owned());
        assert_eq!(names(&mut memory, 4), [cup.clone(), cup.clone(), None]);
        assert_eq!(
            names(&mut memory, 5),
            [cup.clone(), cup],
            "one view was purged"
        );
        assert_eq!(memory.stats().unwrap().n_tombstones, 1);
        let documents = memory.documents();
        assert_eq!(documents.len(), 1);
        let document = memory.document(&documents[0].key).unwrap();
        assert_eq!(document.content, b"second");
        let history = memory.history(1, 100).unwrap();
        assert_eq!(history.len(), 29, "28 entries, and the one about this");
        // The digests that a person may have noted stay.
        let noted = 0xb317_64c9_24e6_424e_6061_b2b1_553b_a0c1;
        assert_eq!(history[28].previous.0, noted);
        let found = memory.checkpoint().unwrap().open().unwrap();
        assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
        if !reopened {
            drop(memory);
            let report;
            (memory, report) = open(&folder);
            assert_eq!(report.condition, Condition::Sound, "{report}");
        }
    }
    assert_eq!(apply(&mut memory, &[teach(2, 1, "Mug")])[0].sequence, 2);
}

/// Names of the views of a track.
fn names(memory: &mut PerceptualMemory, track: u64) -> Vec<Option<String>> {
    let stored = memory.views_of_track(track).unwrap();
    let names = stored.iter().map(name_of);
    names.map(|name| name.map(str::to_owned)).collect()
}

#[test]
fn store_of_schema_3_opens_with_nothing_lost() {
    let folder = fixture("schema-3");
    for _ in 0..2 {
        let (mut memory, report) = open(&folder);
        assert_eq!(report.condition, Condition::Sound, "{report}");
        let mug = || Some("Mug".to_owned());
        assert_eq!(names(&mut memory, 1), [mug(), mug()], "corrected");
        assert_eq!(names(&mut memory, 2), [mug(), mug()], "taught");
        assert_eq!(names(&mut memory, 3), [Some("Bowl".to_owned()), None]);
        assert_eq!(names(&mut memory, 4), [mug()], "merged; one was purged");
        for track in 1..=4 {
            for stored in memory.views_of_track(track).unwrap() {
                let id = stored.view.id;
                assert_eq!(stored.view, view(track, id.view_id, id.view_id));
            }
        }
        let documents = memory.documents();
        assert_eq!(documents.len(), 1, "of two versions, and a removed one");
        assert_eq!(
            memory.document(&documents[0].key).unwrap().content,
            b"second"
        );
        // Twelve of the entries are in the archive.
        let history = memory.history(1, 100).unwrap();
        assert_eq!(history.len(), 21);
        let digests = history.iter().map(|entry| entry.previous.0);
        let of_digests = digests.fold(0, u128::wrapping_add);
        assert_eq!(of_digests, DIGESTS_OF_SCHEMA_3, "{of_digests:#x}");
        let stats = memory.stats().unwrap();
        assert_eq!((stats.n_archived_entries, stats.n_tombstones), (12, 1));
        assert_eq!(stats.next_track_id, 5);
        let found = memory.checkpoint().unwrap().open().unwrap();
        assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
        // What was asked then is answered.
        assert_eq!(apply(&mut memory, &[teach(5, 1, "Cup")])[0].sequence, 5);
    }
}
