//! Fuzzing of records beneath their checksum, as a faulty program could have written them: they
//! are read or refused, never a panic.

use durable_leveldb::{MutationId, record};
use mutation_fuzzing::fuzz;

use crate::digest::Digest;
use crate::history::HistoryEntry;
use crate::keys;
use crate::model::{ImportPart, Operation, Target};

pub(super) const SEQUENCE: u64 = 9;
/// Bytes before the payload: version and checksum.
const HEADER_BYTES: usize = 5;

/// History entry of an operation without effects.
pub(super) fn entry(operation: Operation) -> HistoryEntry {
    HistoryEntry {
        sequence: SEQUENCE,
        previous: Digest::of(b"before"),
        wall_ns: 7,
        author: "anna".into(),
        uid: Some(1000),
        operation,
        mutation: Some(MutationId(5)),
        effects: Vec::new(),
        contradiction: None,
    }
}

/// Record with a valid checksum over any payload.
fn sealed(key: &[u8], payload: &[u8]) -> Vec<u8> {
    let mut hasher = crc32fast::Hasher::new();
    for part in [key, &[record::VERSION], payload] {
        hasher.update(part);
    }
    let checksum = hasher.finalize().to_le_bytes();
    [&[record::VERSION][..], &checksum, payload].concat()
}

#[test]
fn fuzz_history_records() {
    let target = Target::Track(3);
    let entries = [
        entry(Operation::StoreViews),
        entry(Operation::Forget { target }),
        entry(Operation::Undo {
            sequence: 4,
            redone: Some(3),
        }),
        entry(Operation::Import {
            source: "anna".to_owned(),
            part: ImportPart {
                first: Some(2),
                is_continued: true,
            },
        }),
    ];
    let key = keys::history_key(SEQUENCE);
    let seeds = entries.map(|entry| entry.seal().0[HEADER_BYTES..].to_vec());
    let n_read = std::cell::Cell::new(0);
    fuzz(&seeds, |payload| {
        let record = sealed(&key, payload);
        if let Ok((entry, _)) = HistoryEntry::unseal(SEQUENCE, &record) {
            let (again, _) = HistoryEntry::unseal(SEQUENCE, &entry.seal().0).unwrap();
            assert_eq!(again, entry);
            n_read.set(n_read.get() + 1);
        }
        // Without its checksum it is no record.
        let mut broken = record;
        broken[1] ^= 1;
        assert!(HistoryEntry::unseal(SEQUENCE, &broken).is_err());
    });
    assert!(n_read.get() > seeds.len(), "some corruptions are records");
}
