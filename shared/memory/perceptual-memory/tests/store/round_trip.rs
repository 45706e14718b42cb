//! Round-trip tests: stored content is unchanged, also after a reopening.

use perceptual_memory::{Condition, DecisionStamp, Effect, LabelStatus, Operation, Target};

use crate::builders::{
    NOW_NS, answer, apply, correct, counts, folder, forget, key, name, open, store, teach, view,
};

#[test]
fn new_store_is_empty() {
    let folder = folder();
    let (memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::New);
    assert!(!report.is_loss());
    assert_eq!((memory.sequence(), memory.categories()), (0, vec![]));
    drop(memory);
    let (_, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound);
}

#[test]
fn views_and_labels_round_trip_bit_by_bit() {
    let folder = folder();
    let views = vec![view(1, 0, 0), view(1, 1, 0), view(9, u32::MAX, 9)];
    let (mut memory, _) = open(&folder);
    let answers = apply(&mut memory, &[store(1, views.clone()), teach(2, 1, "Mug")]);
    assert_eq!(answers, [answer(1, 3), answer(2, 2)]);
    let mug = LabelStatus::Named(name("Mug"));
    let decided = Some(DecisionStamp {
        author: "anna".into(),
        stamp_ns: NOW_NS + 2,
    });
    let check = |memory: &mut perceptual_memory::PerceptualMemory| {
        let stored = memory.views_of_track(1).unwrap();
        assert_eq!(
            stored.iter().map(|s| &s.view).collect::<Vec<_>>(),
            [&views[0], &views[1]]
        );
        for stored in stored {
            assert_eq!((&stored.standing, &stored.decided), (&mug, &decided));
            assert_eq!(stored.sequence, 2);
            assert_eq!(stored.origin.view, stored.view.id);
            assert_eq!(stored.origin.memory_id, memory.memory_id());
        }
        let last = memory.views_of_track(9).unwrap().remove(0);
        assert_eq!(
            (&last.view, last.standing),
            (&views[2], LabelStatus::Unnamed)
        );
        assert_eq!((last.decided, last.sequence), (None, 1));
        assert_eq!(counts(memory), [("Mug".to_owned(), 2)]);
    };
    check(&mut memory);
    memory.close().unwrap();
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound);
    assert_eq!(
        (report.n_views, report.n_labelled, report.n_categories),
        (3, 2, 1)
    );
    check(&mut memory);
}

#[test]
fn repeated_mutation_gets_its_first_answer() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    let first = apply(
        &mut memory,
        &[store(1, vec![view(1, 0, 0)]), teach(2, 1, "Mug")],
    );
    apply(&mut memory, &[correct(3, 1, "Cup")]);
    // Asked now for the first time it would be refused.
    assert_eq!(&memory.apply(&teach(2, 1, "Mug")).unwrap(), &first[1]);
    drop(memory);
    let (mut memory, _) = open(&folder);
    let again = apply(
        &mut memory,
        &[teach(2, 1, "Mug"), store(1, vec![view(1, 0, 0)])],
    );
    assert!(again.iter().eq(first.iter().rev()));
    assert_eq!(
        (counts(&memory), memory.sequence()),
        (vec![("Cup".to_owned(), 1)], 3)
    );
}

#[test]
fn redundant_mutation_is_acknowledged_without_effects() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    apply(
        &mut memory,
        &[store(1, vec![view(1, 0, 0)]), teach(2, 1, "Mug")],
    );
    let again = [
        store(3, vec![view(1, 0, 0)]),
        teach(4, 1, "Mug"),
        correct(5, 1, "Mug"),
    ];
    let nothing = [answer(3, 0), answer(4, 0), answer(5, 0)];
    assert_eq!(apply(&mut memory, &again), nothing);
    // Views stored since then are what a second teaching adds.
    apply(&mut memory, &[store(6, vec![view(1, 0, 0), view(1, 1, 0)])]);
    assert_eq!(apply(&mut memory, &[teach(7, 1, "Mug")]), [answer(7, 1)]);
}

#[test]
fn correction_and_forgetting_move_views_between_categories() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    let views = vec![view(1, 0, 0), view(2, 0, 0), view(2, 1, 0)];
    apply(
        &mut memory,
        &[store(1, views), teach(2, 1, "Mug"), correct(3, 2, "Mug")],
    );
    assert_eq!(counts(&memory), [("Mug".to_owned(), 3)]);
    apply(&mut memory, &[correct(4, 1, "Bowl")]);
    assert_eq!(
        counts(&memory),
        [("Bowl".to_owned(), 1), ("Mug".to_owned(), 2)]
    );
    apply(&mut memory, &[forget(5, "Mug")]);
    assert_eq!(counts(&memory), [("Bowl".to_owned(), 1)]);
    let bowl = &memory.categories()[0];
    assert_eq!(bowl.last_taught_ns, NOW_NS + 4);
    assert!(bowl.n_bytes > 4 * 75);
    drop(memory);
    let (memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound);
    assert_eq!(
        (report.n_views, counts(&memory)),
        (3, vec![("Bowl".to_owned(), 1)])
    );
}

#[test]
fn history_records_author_operation_and_time() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    apply(
        &mut memory,
        &[
            store(1, vec![view(3, 2, 0)]),
            teach(2, 3, "Mug"),
            correct(3, 3, "Cup"),
        ],
    );
    apply(&mut memory, &[forget(4, "Cup")]);
    let history = memory.history(1, 100).unwrap();
    let operations = [
        Operation::StoreViews,
        Operation::Teach {
            track_id: 3,
            category: name("Mug"),
        },
        Operation::Correct {
            target: Target::Track(3),
            category: name("Cup"),
        },
        Operation::Forget {
            target: Target::Category(name("Cup")),
        },
    ];
    for ((entry, operation), sequence) in history.iter().zip(operations).zip(1..) {
        assert_eq!(entry.operation, operation);
        assert_eq!(
            (entry.sequence, entry.wall_ns),
            (sequence, NOW_NS + sequence)
        );
        assert_eq!(&*entry.author, "anna");
        assert_eq!(entry.mutation.map(|id| id.0), Some(sequence as u128));
    }
    let [Effect::Stored { view, .. }] = history[0].effects[..] else {
        panic!("{:?}", history[0].effects);
    };
    assert_eq!(view, key(3, 2));
    let standing =
        |text: Option<&str>| text.map_or(LabelStatus::Unnamed, |t| LabelStatus::Named(name(t)));
    let change = |before: Option<&str>, after: Option<&str>| {
        [Effect::Changed {
            view: key(3, 2),
            before: standing(before),
            after: standing(after),
            decided: None,
        }]
    };
    assert_eq!(history[1].effects, change(None, Some("Mug")));
    assert_eq!(history[2].effects, change(Some("Mug"), Some("Cup")));
    assert_eq!(history[3].effects, change(Some("Cup"), None));
    assert_eq!(memory.history(2, 2).unwrap(), history[1..3]);
    assert_eq!(memory.history(5, 9).unwrap(), []);
    assert_eq!(memory.history(0, usize::MAX).unwrap(), history);
}

#[test]
fn track_id_lease_is_unique() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    assert_eq!(memory.lease_track_ids(10).unwrap(), 1);
    assert_eq!(memory.lease_track_ids(1).unwrap(), 11);
    drop(memory);
    let (mut memory, _) = open(&folder);
    assert_eq!(memory.lease_track_ids(5).unwrap(), 12);
    // Storing a view leaves the counter as it is.
    apply(&mut memory, &[store(1, vec![view(16, 0, 0)])]);
    assert_eq!(memory.lease_track_ids(1).unwrap(), 17);
}

#[test]
fn clock_set_back_is_reported_and_loses_nothing() {
    const HOUR_NS: u64 = 3_600_000_000_000;
    let folder = folder();
    let (mut memory, _) = open(&folder);
    apply(
        &mut memory,
        &[store(1, vec![view(1, 0, 0)]), teach(2, 1, "Mug")],
    );
    drop(memory);
    let early = NOW_NS - 3 * HOUR_NS;
    let (mut memory, report) =
        perceptual_memory::PerceptualMemory::open(folder.path(), early).unwrap();
    assert_eq!(report.condition, Condition::Sound);
    assert!(
        report.to_string().contains("the clock is 10800 s behind"),
        "{report}"
    );
    // A new decision is later than earlier ones, independent of the clock.
    let mut late = correct(3, 1, "Cup");
    late.wall_ns = early;
    apply(&mut memory, &[late]);
    let stored = memory.views_of_track(1).unwrap().remove(0);
    assert_eq!(stored.decided.unwrap().stamp_ns, NOW_NS + 3);
    let order: Vec<u64> = memory
        .history(1, 9)
        .unwrap()
        .iter()
        .map(|entry| entry.wall_ns)
        .collect();
    assert_eq!(order, [NOW_NS + 1, NOW_NS + 2, early]);
}

#[test]
fn clouds_are_read_in_order_as_many_as_fit() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    let with_points = |number: u32, n_bytes: usize| {
        let mut view = view(1, number, 0);
        view.points = Some(vec![number as u8; n_bytes]);
        view
    };
    let mut without = view(1, 2, 0);
    without.points = None;
    let views = vec![with_points(0, 100), with_points(1, 300), without];
    let ids: Vec<_> = views.iter().map(|view| view.id).collect();
    apply(&mut memory, &[store(1, views)]);
    let unknown = learning::ViewId {
        track_id: 77,
        view_id: 0,
    };
    let wanted = [ids[0], ids[2], unknown, ids[1]];
    let clouds = memory.clouds(&wanted, 1000).unwrap();
    assert_eq!(clouds, [vec![0; 100], vec![], vec![], vec![1; 300]]);
    assert_eq!(memory.clouds(&wanted, 350).unwrap().len(), 3);
    // At least one, however large.
    assert_eq!(memory.clouds(&wanted[3..], 10).unwrap(), [vec![1; 300]]);
    assert!(memory.clouds(&[], 10).unwrap().is_empty());
}
