//! Retention-limit tests: the most redundant views are pruned first.

use perceptual_memory::{
    CapturedView, Condition, DocumentKey, DocumentKind, MAX_DOCUMENT_VERSIONS, MemoryDocument,
    Operation, PerceptualMemory, RetentionLimits, StoreChange, StoreConfig, StoreThread,
};

use crate::builders::{apply, counts, fast_folder, mutation, open, store, teach, view};

/// View whose descriptor encodes its distance from the others.
fn view_at(track_id: u64, view_id: u32, place: f32) -> CapturedView {
    let mut view = view(track_id, view_id, 0);
    view.descriptor.values = vec![place, 1.0];
    view.captured_ns = u64::from(view_id);
    view
}

#[test]
fn retention_limit_prunes_redundant_views_of_a_category() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    memory.set_limits(RetentionLimits {
        max_views_per_category: 10,
        ..RetentionLimits::default()
    });
    // Nine apart from each other, and two beside the first, the newest.
    let places = [
        0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 0.1, 0.15,
    ];
    let views = (0..).zip(places).map(|(i, place)| view_at(1, i, place));
    apply(
        &mut memory,
        &[store(1, views.collect()), teach(2, 1, "Mug")],
    );
    assert_eq!(counts(&memory), [("Mug".to_owned(), 9)]);
    let kept: Vec<u32> = memory
        .views_of_track(1)
        .unwrap()
        .iter()
        .map(|stored| stored.view.id.view_id)
        .collect();
    assert_eq!(
        kept,
        [1, 2, 3, 4, 5, 6, 7, 8, 10],
        "of the three alike the newest"
    );
    let last = memory.history(3, 1).unwrap().remove(0);
    assert!(matches!(last.operation, Operation::EnforceLimit { .. }));
    // Another robot is not told to forget them.
    let mut n_told = 0;
    let mut reader = memory.checkpoint().unwrap().open().unwrap();
    let take_view = |_| -> Result<(), perceptual_memory::Error> {
        n_told += 1;
        Ok(())
    };
    reader.export(take_view, |_| Ok(())).unwrap();
    assert_eq!(n_told, 9);
    // It can be taken back, and then is done no more until the category grows.
    memory.set_limits(RetentionLimits::default());
    apply(
        &mut memory,
        &[mutation(3, StoreChange::Undo { sequence: Some(3) })],
    );
    assert_eq!(counts(&memory), [("Mug".to_owned(), 11)]);
}

#[test]
fn retention_limit_evicts_the_oldest_unlabelled_views() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    memory.set_limits(RetentionLimits {
        max_unnamed_views: 10,
        ..RetentionLimits::default()
    });
    for track in 1..=12 {
        apply(
            &mut memory,
            &[store(track as u128, vec![view(track, 0, 0)])],
        );
    }
    apply(&mut memory, &[teach(99, 3, "Mug")]);
    let n_kept: Vec<usize> = (1..=12)
        .map(|track| memory.views_of_track(track).unwrap().len())
        .collect();
    assert_eq!(n_kept, [0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]);
    drop(memory);
    let (_, report) = open(&folder);
    assert_eq!(report.n_views, 10);
}

/// Disk use under limits: 500 views of which 20 are kept, with interleaved reads.
#[test]
fn retention_limit_frees_disk_space() {
    let folder = fast_folder();
    let (thread, handle, _) = StoreThread::start(StoreConfig {
        folder: folder.path().to_owned(),
        queue_capacity: 8,
        limits: RetentionLimits {
            max_unnamed_views: 20,
            ..RetentionLimits::default()
        },
        write_buffer_bytes: 256 << 10,
        wall_clock: || 1,
        on_reopened: Box::new(|report| panic!("opened again: {report:?}")),
        on_notice: Box::new(|notice| panic!("{notice}")),
    })
    .unwrap();
    for track in 1..=500_u64 {
        let mut large = view(track, 0, 0);
        large.descriptor.values = (0..3000).map(|i| track as f32 + i as f32).collect();
        handle.lease_track_ids_and_wait(1).unwrap();
        let stored = handle.mutate_and_wait(store(u128::from(track), vec![large]));
        assert!(stored.is_ok(), "{stored:?}");
        if track % 100 == 0 {
            let read = handle.read_and_wait(move |memory| memory.views_of_track(track));
            assert_eq!(read.unwrap().len(), 1);
        }
    }
    for step in 0..PerceptualMemory::N_COMPACT_STEPS {
        let merged = handle.compact_and_wait(step);
        assert!(merged.is_ok(), "{merged:?}");
    }
    let stats = handle.read_and_wait(|memory| memory.stats()).unwrap();
    assert!(stats.n_unnamed <= 20, "{stats:?}");
    assert!(stats.n_content_bytes > 200_000, "{stats:?}");
    // Of six megabytes; the history stays, and what is being written.
    assert!(stats.n_disk_bytes < 1_500_000, "{stats:?}");
    thread.stop().unwrap();
}

#[test]
fn deduplication_stores_equal_content_once() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    let cloud = vec![7; 100_000];
    let with_cloud = |track| CapturedView {
        points: Some(cloud.clone()),
        ..view_at(track, 0, 3.0)
    };
    for track in 1..=50 {
        apply(
            &mut memory,
            &[store(track as u128, vec![with_cloud(track)])],
        );
    }
    let mut n_bytes = 0;
    memory
        .visit_records(|_, record| n_bytes += record.len())
        .unwrap();
    assert!(n_bytes < 2 * cloud.len(), "{n_bytes}");
    assert_eq!(memory.views_of_track(50).unwrap()[0].view, with_cloud(50));
}

#[test]
fn newest_versions_of_a_document_are_kept() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    let key = DocumentKey {
        kind: DocumentKind::TaskKnowledge,
        name: "shelf".into(),
    };
    let n_puts = 2 * MAX_DOCUMENT_VERSIONS as u128;
    let put = |n: u128| {
        let document = MemoryDocument {
            key: key.clone(),
            media_type: "text/plain".to_owned(),
            content: n.to_string().into_bytes(),
        };
        mutation(n, StoreChange::PutDocument(document))
    };
    let verified = |memory: &mut PerceptualMemory| {
        let reader = memory.checkpoint().unwrap().open().unwrap();
        reader.verify(|_| ()).unwrap()
    };
    for n in 1..=n_puts {
        apply(&mut memory, &[put(n)]);
        assert!(verified(&mut memory).n_documents <= MAX_DOCUMENT_VERSIONS as u64);
    }
    assert_eq!(
        verified(&mut memory).n_documents,
        MAX_DOCUMENT_VERSIONS as u64
    );
    // The last one can be undone, and the store is the same when it is opened again.
    let undo = StoreChange::Undo { sequence: None };
    apply(&mut memory, &[mutation(n_puts + 1, undo)]);
    let content = |memory: &mut PerceptualMemory| memory.document(&key).unwrap().content;
    assert_eq!(content(&mut memory), (n_puts - 1).to_string().into_bytes());
    memory.close().unwrap();
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(content(&mut memory), (n_puts - 1).to_string().into_bytes());
    assert_eq!(verified(&mut memory).n_findings, 0);
}
