use super::*;
use control_client::read_history;
use learning::CategoryName;
use perceptual_memory::{Mutation, StoreChange};
use std::convert::Infallible;

fn name(text: &str) -> CategoryName {
    CategoryName::new(text).unwrap()
}

fn empty(sequence: u64, operation: &Operation) -> HistoryReport {
    report(&HistoryEntry {
        sequence,
        previous: perceptual_memory::Digest::default(),
        wall_ns: 5,
        author: "anna".into(),
        uid: Some(1000),
        operation: operation.clone(),
        mutation: None,
        effects: Vec::new(),
        contradiction: None,
    })
}

#[test]
fn history_report_has_the_fields_of_its_operation() {
    let taught = empty(
        1,
        &Operation::Teach {
            track_id: 3,
            category: name("mug"),
        },
    );
    assert_eq!(taught.operation, HistoryOperation::Teach);
    assert_eq!(taught.author, "anna");
    let category = taught.category.as_deref();
    assert_eq!((taught.track_id, category), (Some(3), Some("mug")));
    assert_eq!((taught.from, taught.to), (None, None));

    let target = Target::Category(name("mug"));
    let corrected = empty(
        2,
        &Operation::Correct {
            target,
            category: name("cup"),
        },
    );
    let (from, to) = (corrected.from.as_deref(), corrected.to.as_deref());
    assert_eq!((from, to), (Some("mug"), Some("cup")));
    assert_eq!(corrected.category.as_deref(), Some("cup"));

    let renamed = empty(
        3,
        &Operation::Rename {
            from: name("cup"),
            to: name("bowl"),
        },
    );
    let (from, to) = (renamed.from.as_deref(), renamed.to.as_deref());
    assert_eq!((from, to), (Some("cup"), Some("bowl")));

    let view = learning::ViewId {
        track_id: 3,
        view_id: 7,
    };
    let target = Target::View(view);
    let forgotten = empty(4, &Operation::Forget { target });
    assert_eq!(forgotten.view, Some(translate::view_id(view)));
    let undo = |redone| Operation::Undo {
        sequence: 4,
        redone,
    };
    let undone = empty(5, &undo(None));
    assert_eq!((undone.undone, undone.redone), (Some(4), None));
    let redone = empty(5, &undo(Some(3)));
    assert_eq!((redone.undone, redone.redone), (Some(4), Some(3)));
    assert_eq!(redone.what, "redo entry 3");
}

/// Store with `n` history entries that change nothing.
fn memory_with_history(folder: &std::path::Path, n: u64, author: &str) -> PerceptualMemory {
    let (mut memory, _) = PerceptualMemory::open(folder, 1).unwrap();
    for i in 0..n {
        let mutation = Mutation {
            id: perceptual_memory::MutationId(u128::from(i)),
            author: author.to_owned(),
            requester: perceptual_memory::Requester::default(),
            wall_ns: i,
            change: StoreChange::Purge { before_ns: 0 },
        };
        memory.apply(&mutation).unwrap();
    }
    memory
}

/// Sequence numbers that a paging client reads, and its number of queries.
fn read(memory: &mut PerceptualMemory, from: Option<u64>, count: u64) -> (Vec<u64>, usize) {
    let mut n_queries = 0;
    let ask = |from, max| -> Result<_, Infallible> {
        n_queries += 1;
        let entries = page(memory, from, max).unwrap();
        Ok((entries, memory.sequence()))
    };
    let Ok((entries, last_sequence)) = read_history(from, count, ask);
    assert_eq!(last_sequence, memory.sequence());
    let sequences = entries.iter().map(|entry| entry.sequence).collect();
    (sequences, n_queries)
}

#[test]
fn history_beyond_one_page_is_read_page_by_page() {
    let folder = tempfile::tempdir_in("/dev/shm")
        .or_else(|_| tempfile::tempdir())
        .unwrap();
    let mut memory = memory_with_history(folder.path(), 1500, "anna");
    assert!(page(&mut memory, Some(1), u32::MAX).unwrap().len() <= PAGE_ENTRIES as usize);
    let (all, n_queries) = read(&mut memory, Some(1), u64::MAX);
    assert!(all.into_iter().eq(1..=1500));
    assert!(n_queries >= 2, "{n_queries}");
    assert!(read(&mut memory, None, 1200).0.into_iter().eq(301..=1500));
    assert!(read(&mut memory, None, 9000).0.into_iter().eq(1..=1500));
    assert!(
        read(&mut memory, Some(1490), 5)
            .0
            .into_iter()
            .eq(1490..=1494)
    );
    assert_eq!(read(&mut memory, Some(1501), 5).0, [0; 0]);
    assert_eq!(read(&mut memory, None, 1).0, [1500]);
}

#[test]
fn history_page_fits_a_message_whatever_the_names() {
    let folder = tempfile::tempdir_in("/dev/shm")
        .or_else(|_| tempfile::tempdir())
        .unwrap();
    let author = "x".repeat(perceptual_memory::MAX_NAME_BYTES);
    let mut memory = memory_with_history(folder.path(), 1200, &author);
    for from in [Some(1), None] {
        let entries = page(&mut memory, from, 1000).unwrap();
        let n_bytes: usize = entries.iter().map(estimated_bytes).sum();
        assert!(n_bytes <= PAGE_BYTES && entries.len() > 300, "{n_bytes}");
        assert_eq!(entries.last().unwrap().sequence == 1200, from.is_none());
    }
    assert!(read(&mut memory, None, 1200).0.into_iter().eq(1..=1200));
}
