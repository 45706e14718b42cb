//! A store that cannot be written: it is read, and refuses changes.

use durable_leveldb::{MutationId, StorageFailure};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::document::MemoryDocument;
use crate::document_key::{DocumentKey, DocumentKind};
use crate::error::{Error, StorageError};
use crate::model::RetentionLimits;
use crate::mutation::{Mutation, StoreChange};
use crate::perceptual_memory::PerceptualMemory;
use crate::read_only;
use crate::requester::Requester;

fn put(id: u128, content: &str) -> Mutation {
    Mutation {
        id: MutationId(id),
        author: "anna".to_owned(),
        requester: Requester::administrator(1000),
        wall_ns: 7,
        change: StoreChange::PutDocument(MemoryDocument {
            key: DocumentKey {
                kind: DocumentKind::TaskKnowledge,
                name: format!("note {id}").into(),
            },
            media_type: "text/plain".to_owned(),
            content: content.as_bytes().to_vec(),
        }),
    }
}

fn no_room() -> Error {
    Error::Storage(StorageError::Io(StorageFailure {
        doing: "syncing",
        path: PathBuf::from("000003.wal"),
        source: Arc::new(std::io::Error::from(std::io::ErrorKind::StorageFull)),
    }))
}

fn open(folder: &Path) -> Result<PerceptualMemory, Error> {
    let limits = RetentionLimits::default();
    let why = (9, no_room());
    let opened = read_only::open(folder, limits, why);
    opened.map(|(memory, report)| {
        assert!(report.is_read_only(), "{report}");
        memory
    })
}

/// Content of all files below a folder.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.append(&mut contents(&path));
        } else {
            found.insert(path.clone(), fs::read(path).unwrap());
        }
    }
    found
}

#[test]
fn read_only_store_is_read_and_exported_and_left_as_it_is() {
    let guard = tempfile::tempdir().unwrap();
    let folder = guard.path().join("store");
    let (mut memory, _) = PerceptualMemory::open(&folder, 1).unwrap();
    let receipt = memory.apply(&put(1, "kept")).unwrap();
    let key = DocumentKey {
        kind: DocumentKind::TaskKnowledge,
        name: "note 1".into(),
    };
    drop(memory);
    let before = contents(&folder);

    let mut memory = open(&folder).unwrap();
    assert_eq!(memory.document(&key).unwrap().content, b"kept");
    assert_eq!(memory.history(1, 9).unwrap().len(), 1);
    // What was acknowledged is acknowledged again; what is new is refused.
    assert_eq!(memory.apply(&put(1, "kept")).unwrap(), receipt);
    let refused = memory.apply(&put(2, "new")).unwrap_err();
    assert!(matches!(refused, Error::ReadOnly { .. }), "{refused}");
    assert!(matches!(
        memory.lease_track_ids(1),
        Err(Error::ReadOnly { .. })
    ));
    assert!(matches!(
        memory.compact_step(0),
        Err(Error::ReadOnly { .. })
    ));
    assert!(matches!(memory.archive_step(), Err(Error::ReadOnly { .. })));
    let mut exported = 0;
    let mut reader = memory.checkpoint().unwrap().open().unwrap();
    reader
        .export::<Error>(
            |_| Ok(()),
            |_| {
                exported += 1;
                Ok(())
            },
        )
        .unwrap();
    assert_eq!(exported, 1);
    drop(reader);
    drop(memory);
    assert_eq!(contents(&folder), before);

    // With room again it goes on.
    let (mut memory, report) = PerceptualMemory::open(&folder, 10).unwrap();
    assert!(!report.is_damage(), "{report}");
    memory.apply(&put(2, "new")).unwrap();
}

/// An entry that a failed write left behind the last acknowledged one may not be on disk.
#[test]
fn read_only_store_acknowledges_nothing_that_was_not_acknowledged() {
    let guard = tempfile::tempdir().unwrap();
    let folder = guard.path().join("store");
    let (mut memory, _) = PerceptualMemory::open(&folder, 1).unwrap();
    memory.apply(&put(1, "acknowledged")).unwrap();
    let mark = fs::read(folder.join("acknowledged")).unwrap();
    memory.apply(&put(2, "in the log only")).unwrap();
    drop(memory);
    fs::write(folder.join("acknowledged"), mark).unwrap();
    let mut memory = open(&folder).unwrap();
    memory.apply(&put(1, "acknowledged")).unwrap();
    let refused = memory.apply(&put(2, "in the log only")).unwrap_err();
    assert!(matches!(refused, Error::ReadOnly { .. }), "{refused}");
}

#[test]
fn damaged_store_is_not_read_only() {
    let guard = tempfile::tempdir().unwrap();
    let folder = guard.path().join("store");
    let (mut memory, _) = PerceptualMemory::open(&folder, 1).unwrap();
    memory.apply(&put(1, "kept")).unwrap();
    drop(memory);
    for (path, mut bytes) in contents(&folder.join("database")) {
        if path.extension().is_some_and(|extension| extension == "wal") {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 0xff;
            fs::write(path, bytes).unwrap();
        }
    }
    assert!(open(&folder).is_err());
}
