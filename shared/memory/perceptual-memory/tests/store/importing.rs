//! Merge tests: memories merge in any order, any number of times, on any robot.

use perceptual_memory::{
    CapturedView, Condition, DocumentKey, DocumentKind, Error, ForeignDocument, ForeignView,
    ImportPart, LabelStatus, MemoryDocument, Mutation, Origin, PerceptualMemory, StoreChange,
    Target,
};
use proptest::prelude::*;
use tempfile::TempDir;

use crate::builders::{
    NOW_NS, apply, correct, counts, fast_folder, forget, key, mutation, name, open, store, teach,
    view,
};

/// Export of a memory.
#[derive(Debug, Clone, PartialEq)]
struct Exported {
    views: Vec<ForeignView>,
    documents: Vec<ForeignDocument>,
}

fn exported(memory: &mut PerceptualMemory) -> Exported {
    let mut all = Exported {
        views: Vec::new(),
        documents: Vec::new(),
    };
    let mut reader = memory.checkpoint().unwrap().open().unwrap();
    let Exported { views, documents } = &mut all;
    let take_view = |view| -> Result<(), Error> {
        views.push(view);
        Ok(())
    };
    let take_document = |document| {
        documents.push(document);
        Ok(())
    };
    reader.export(take_view, take_document).unwrap();
    all
}

/// Export of a memory, without local view ids.
fn meaning(memory: &mut PerceptualMemory) -> Exported {
    let mut all = exported(memory);
    for view in &mut all.views {
        if let ForeignView::Present { view, origin, .. } = view {
            view.id = origin.view;
        }
    }
    all
}

fn import(id: u128, from: &Exported) -> Mutation {
    mutation(
        id,
        StoreChange::Import {
            source: "test".to_owned(),
            views: from.views.clone(),
            documents: from.documents.clone(),
            part: ImportPart::default(),
        },
    )
}

fn put(id: u128, name: &str, content: u8) -> Mutation {
    mutation(
        id,
        StoreChange::PutDocument(MemoryDocument {
            key: DocumentKey {
                kind: DocumentKind::ObjectModel,
                name: name.into(),
            },
            media_type: "model/ply".to_owned(),
            content: vec![content; 9],
        }),
    )
}

/// Memory with taught content that depends on `robot`.
fn taught(robot: u32) -> (TempDir, PerceptualMemory) {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    let id = u128::from(robot) * 100;
    apply(
        &mut memory,
        &[
            store(
                id + 1,
                vec![view(1, 0, robot), view(1, 1, robot), view(2, 0, robot)],
            ),
            teach(id + 2, 1, "Mug"),
            teach(id + 3, 2, "Bowl"),
            put(id + 4, "mug 1", robot as u8),
            store(id + 5, vec![view(3, 0, robot)]),
            mutation(id + 6, StoreChange::Forget(Target::Track(2))),
        ],
    );
    (folder, memory)
}

#[test]
fn import_merges_two_memories() {
    let (_a, mut ours) = taught(1);
    let (_b, mut theirs) = taught(2);
    let (from_ours, from_theirs) = (exported(&mut ours), exported(&mut theirs));
    let answer = apply(&mut ours, &[import(900, &from_theirs)]).remove(0);
    // Two views of the mug and one without a name; the forgotten one only as such.
    assert_eq!(answer.n_views, 3);
    assert_eq!(counts(&ours), [("Mug".to_owned(), 4)]);
    apply(&mut theirs, &[import(900, &from_ours)]);
    assert_eq!(meaning(&mut ours), meaning(&mut theirs));
    // Views of one track stay together, apart from our own.
    let tracks: Vec<usize> = (1..9)
        .map(|track| ours.views_of_track(track).unwrap().len())
        .collect();
    assert_eq!(tracks.iter().sum::<usize>(), 6);
    assert_eq!(tracks.iter().filter(|n| **n == 2).count(), 2);
    // Again, and what they know of us: nothing new.
    let before = meaning(&mut ours);
    let again = apply(
        &mut ours,
        &[
            import(901, &from_theirs),
            import(902, &exported(&mut theirs)),
        ],
    );
    assert!(again.iter().all(|answer| answer.n_views == 0));
    assert_eq!(meaning(&mut ours), before);
    let found = ours.checkpoint().unwrap().open().unwrap();
    assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
}

#[test]
fn import_keeps_the_later_of_two_decisions() {
    let (_a, mut ours) = taught(1);
    let (_b, mut theirs) = {
        let folder = fast_folder();
        let (mut memory, _) = open(&folder);
        apply(&mut memory, &[import(1, &exported(&mut ours))]);
        (folder, memory)
    };
    assert_eq!(counts(&theirs), [("Mug".to_owned(), 2)]);
    apply(&mut ours, &[correct(500, 1, "Cup")]);
    apply(&mut theirs, &[forget(600, "Mug")]);
    let (from_ours, from_theirs) = (exported(&mut ours), exported(&mut theirs));
    apply(&mut ours, &[import(901, &from_theirs)]);
    apply(&mut theirs, &[import(902, &from_ours)]);
    assert_eq!(counts(&ours), [], "forgetting was later");
    assert_eq!(meaning(&mut ours), meaning(&mut theirs));
}

#[test]
fn import_does_not_revive_purged_views() {
    let (_a, mut ours) = taught(1);
    let early = exported(&mut ours);
    apply(
        &mut ours,
        &[mutation(700, StoreChange::Forget(Target::Track(1)))],
    );
    let before_ns = NOW_NS + 10_000;
    apply(
        &mut ours,
        &[mutation(701, StoreChange::Purge { before_ns })],
    );
    assert_eq!(ours.categories(), []);
    let answer = apply(&mut ours, &[import(702, &early)]).remove(0);
    assert_eq!((answer.n_views, ours.categories()), (0, vec![]));
    // Unless a later decision says so.
    let folder = fast_folder();
    let (mut other, _) = open(&folder);
    apply(&mut other, &[import(1, &early)]);
    let track = (1..9)
        .find(|track| other.views_of_track(*track).unwrap().len() == 2)
        .unwrap();
    apply(&mut other, &[correct(800, track, "Cup")]);
    apply(&mut ours, &[import(703, &exported(&mut other))]);
    assert_eq!(counts(&ours), [("Cup".to_owned(), 2)]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Order independence: a fourth robot imports three memories with shared views in any order,
    /// with the same result.
    #[test]
    fn import_order_does_not_matter(
        opinions in prop::collection::vec((0..3_usize, 1..4_u64, 0..3_usize, 0..5_u64), 0..10),
        order in Just([0_usize, 1, 2]).prop_shuffle(),
        twice in 0..3_usize,
    ) {
        let mut robots: Vec<_> = (1..4).map(taught).collect();
        let first = exported(&mut robots[0].1);
        for (_, memory) in &mut robots[1..] {
            apply(memory, &[import(400, &first)]);
        }
        for (i, (robot, track, category, later)) in opinions.into_iter().enumerate() {
            let target = Target::Track(track);
            let change = match category {
                2 => StoreChange::Forget(target),
                _ => StoreChange::Correct { target, category: name(["Mug", "Cup"][category]) },
            };
            let mut asked = mutation(1000 + i as u128, change);
            asked.wall_ns = NOW_NS + 500 + later;
            // A track may be forgotten already.
            let _ = robots[robot].1.apply(&asked);
        }
        let all: Vec<Exported> = robots.iter_mut().map(|(_, memory)| exported(memory)).collect();
        let merged = |order: &[usize]| {
            let folder = fast_folder();
            let (mut memory, _) = open(&folder);
            for (id, robot) in (1..).zip(order) {
                apply(&mut memory, &[import(id, &all[*robot])]);
            }
            meaning(&mut memory)
        };
        let [a, b, c] = order;
        prop_assert_eq!(merged(&[0, 1, 2]), merged(&[a, b, c, twice]));
    }
}

/// Recovery of a lost point cloud from an earlier export.
#[test]
fn import_of_a_backup_restores_a_lost_cloud() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    let with_cloud = CapturedView {
        // Larger than a block of the table, so that it has one for itself.
        points: Some(vec![0xa5; 100_000]),
        ..view(1, 0, 0)
    };
    let views = vec![with_cloud, view(1, 1, 0)];
    apply(&mut memory, &[store(1, views), teach(2, 1, "Mug")]);
    let backup = exported(&mut memory);
    let before = meaning(&mut memory);
    drop(memory);
    drop(open(&folder));
    let files = std::fs::read_dir(folder.path().join("database")).unwrap();
    let mut n_damaged = 0;
    for path in files.flatten().map(|entry| entry.path()) {
        let mut bytes = std::fs::read(&path).unwrap();
        if let Some(at) = bytes.windows(1000).position(|run| run == [0xa5; 1000]) {
            bytes[at] ^= 0x10;
            std::fs::write(&path, bytes).unwrap();
            n_damaged += 1;
        }
    }
    assert_eq!(n_damaged, 1);
    let (mut memory, report) = PerceptualMemory::open_and_rebuild(folder.path(), NOW_NS).unwrap();
    let loss = report.loss();
    assert_eq!((loss.n_views, loss.n_clouds), (0, 1), "{report}");
    assert_eq!(counts(&memory), [("Mug".to_owned(), 2)]);
    assert_ne!(meaning(&mut memory), before);
    for id in [900, 901] {
        apply(&mut memory, &[import(id, &backup)]);
        assert_eq!(meaning(&mut memory), before);
    }
}

#[test]
fn import_of_own_view_under_a_track_id_never_leased_gets_another_id() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    assert_eq!(memory.lease_track_ids(4).unwrap(), 1);
    let own = |track_id| ForeignView::Present {
        view: Box::new(view(track_id, 0, 0)),
        origin: Origin {
            memory_id: memory.memory_id(),
            view: key(track_id, 0),
        },
        standing: LabelStatus::Unnamed,
        decided: None,
    };
    let views = vec![own(3), own(u64::MAX - 1)];
    let change = StoreChange::Import {
        source: "test".to_owned(),
        views,
        documents: Vec::new(),
        part: ImportPart::default(),
    };
    apply(&mut memory, &[mutation(1, change)]);
    let summaries = memory.views(None, None, 9).unwrap();
    let ids: Vec<_> = summaries.iter().map(|summary| summary.view).collect();
    assert_eq!(ids, [key(3, 0), key(5, 0)]);
    assert_eq!(memory.lease_track_ids(1).unwrap(), 6);
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(memory.lease_track_ids(1).unwrap(), 7);
}

#[test]
fn tombstone_blocks_a_merge_until_it_is_purged() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    apply(
        &mut memory,
        &[store(1, vec![view(1, 0, 0)]), teach(2, 1, "Mug")],
    );
    let before = exported(&mut memory);
    let forget = StoreChange::Forget(Target::Track(1));
    let purge = |before_ns| StoreChange::Purge { before_ns };
    let purge_notes = |before_ns| StoreChange::PurgeTombstones { before_ns };
    apply(
        &mut memory,
        &[mutation(3, forget), mutation(4, purge(u64::MAX))],
    );
    // The view was forgotten at `NOW_NS + 3`.
    assert!(!memory.has_purgeable_tombstones(NOW_NS + 3));
    apply(
        &mut memory,
        &[mutation(5, purge_notes(NOW_NS + 3)), import(6, &before)],
    );
    assert_eq!(counts(&memory), []);
    assert_eq!(memory.stats().unwrap().n_tombstones, 1);
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    apply(&mut memory, &[import(7, &before)]);
    assert_eq!(counts(&memory), []);
    assert!(memory.has_purgeable_tombstones(NOW_NS + 4));
    apply(&mut memory, &[mutation(8, purge_notes(NOW_NS + 4))]);
    assert_eq!(memory.stats().unwrap().n_tombstones, 0);
    apply(&mut memory, &[import(9, &before)]);
    assert_eq!(counts(&memory), [("Mug".to_owned(), 1)]);
    let found = memory.checkpoint().unwrap().open().unwrap();
    assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
}

#[test]
fn purge_deletes_a_limited_number_of_views_at_once() {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    for track in 1..=2 {
        let views = (0..600).map(|i| view(track, i, 0)).collect();
        let forget = StoreChange::Forget(Target::Track(track));
        let id = u128::from(10 * track);
        apply(&mut memory, &[store(id, views), mutation(id + 1, forget)]);
    }
    let mut n_views = Vec::new();
    while memory.has_purgeable(u64::MAX) {
        let id = 100 + n_views.len() as u128;
        let before_ns = u64::MAX;
        let purge = mutation(id, StoreChange::Purge { before_ns });
        n_views.push(apply(&mut memory, &[purge])[0].n_views);
    }
    assert_eq!(n_views, [1000, 200]);
}
