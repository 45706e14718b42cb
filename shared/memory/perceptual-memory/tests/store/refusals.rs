//! Refusal tests: invalid requests get a sentence and change nothing.

use learning::{CategoryName, TeachingError as TeachingRefusal};
use nalgebra::{Quaternion, UnitQuaternion};
use perceptual_memory::{
    CapturedView, Condition, MAX_BATCH_VIEWS, MAX_LEASE, MAX_NAME_BYTES, Mutation, MutationReceipt,
    Operation, StoreChange, StoreRefusal,
};
use proptest::prelude::*;

use crate::builders::{
    answer, apply, correct, counts, folder, forget, key, lease_tracks_of, lesson, mutation, name,
    open, refusal, store, teach, view,
};

#[test]
fn teaching_rules_are_enforced() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    assert_eq!(
        lesson(memory.apply(&teach(1, 1, "Mug"))),
        TeachingRefusal::NoViews { track_id: 1 }
    );
    assert_eq!(
        lesson(memory.apply(&correct(1, 1, "Mug"))),
        TeachingRefusal::NoViews { track_id: 1 }
    );
    apply(
        &mut memory,
        &[store(1, vec![view(1, 0, 0)]), teach(2, 1, "Mug")],
    );
    let category = name("Cup");
    assert_eq!(
        lesson(memory.apply(&forget(4, "Cup"))),
        TeachingRefusal::UnknownCategory { category }
    );
    assert_eq!(
        (memory.sequence(), counts(&memory)),
        (2, vec![("Mug".to_owned(), 1)])
    );
    // A refusal is no answer: asked again with the same id it may be granted.
    assert_eq!(apply(&mut memory, &[correct(3, 1, "Cup")])[0].n_views, 1);
}

#[test]
fn contradiction_is_answered_and_recorded() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    let views = vec![view(1, 0, 0)];
    apply(&mut memory, &[store(1, views), teach(2, 1, "Mug")]);
    let bert = Mutation {
        author: "bert".to_owned(),
        ..teach(3, 1, "Cup")
    };
    let told = apply(&mut memory, std::slice::from_ref(&bert)).remove(0);
    assert_eq!((told.sequence, told.n_views), (3, 0));
    let contradiction = told.contradiction.clone().unwrap();
    assert_eq!(contradiction.present, name("Mug"));
    assert_eq!(&*contradiction.decided.author, "anna");
    assert_eq!(counts(&memory), [("Mug".to_owned(), 1)]);
    drop(memory);
    // A repeated request gets the same refusal, also after a restart.
    let (mut memory, _) = open(&folder);
    assert_eq!(apply(&mut memory, &[bert]), [told]);
    let history = memory.history(2, 9).unwrap();
    let said: Vec<_> = history
        .iter()
        .map(|entry| match &entry.operation {
            Operation::Teach { category, .. } => (&*entry.author, category.as_str()),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(said, [("anna", "Mug"), ("bert", "Cup")]);
    assert_eq!(history[1].contradiction, Some(contradiction));
}

#[test]
fn view_is_stored_once_and_never_replaced() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    apply(&mut memory, &[store(1, vec![view(1, 0, 0)])]);
    let differs = StoreRefusal::ViewDiffers { view: key(1, 0) };
    lease_tracks_of(&mut memory, &store(2, vec![view(9, 0, 0)]));
    let mut other_cloud = view(1, 0, 0);
    other_cloud.points = None;
    let mut other_box = view(1, 0, 0);
    other_box.box_in_world.half_sides_m.x += 1e-12;
    for other in [view(1, 0, 1), other_cloud, other_box] {
        // The good view of the batch is not stored either.
        assert_eq!(
            refusal(memory.apply(&store(2, vec![view(9, 0, 0), other]))),
            differs
        );
    }
    let twice = store(3, vec![view(2, 0, 0), view(2, 0, 1)]);
    assert_eq!(
        refusal(memory.apply(&twice)),
        StoreRefusal::ViewDiffers { view: key(2, 0) }
    );
    let twice = store(4, vec![view(3, 0, 0), view(3, 0, 0)]);
    assert_eq!(apply(&mut memory, &[twice])[0].n_views, 1);
    assert_eq!(
        (memory.sequence(), memory.views_of_track(9).unwrap()),
        (2, vec![])
    );
}

fn no_rotation() -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 1.0))
}

#[test]
fn view_with_invalid_values_is_refused() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    let spoil: [fn(&mut CapturedView); 12] = [
        |v| v.id.track_id = u64::MAX,
        |v| v.descriptor.values.clear(),
        |v| v.descriptor.values[3] = f32::NAN,
        |v| v.descriptor.values[3] = f32::INFINITY,
        |v| v.descriptor.values = vec![0.0; perceptual_memory::MAX_DESCRIPTOR_VALUES + 1],
        |v| v.descriptor.kind = "x".repeat(MAX_NAME_BYTES + 1),
        |v| v.source = "x".repeat(MAX_NAME_BYTES + 1),
        |v| v.points = Some(vec![0; perceptual_memory::MAX_POINTS_BYTES + 1]),
        |v| v.box_in_world.half_sides_m.y = -1e-9,
        |v| v.box_in_world.half_sides_m.y = f64::NAN,
        |v| v.box_in_world.frame_from_box.translation.z = f64::NAN,
        |v| v.box_in_world.frame_from_box.rotation = no_rotation(),
    ];
    for (i, spoil) in spoil.iter().enumerate() {
        let mut spoilt = view(1, 0, 0);
        spoil(&mut spoilt);
        let refused = refusal(memory.apply(&store(1, vec![spoilt])));
        assert!(
            matches!(refused, StoreRefusal::InvalidView { .. }),
            "{i}: {refused}"
        );
    }
    assert_eq!(memory.sequence(), 0);
}

#[test]
fn oversized_request_is_refused() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    for n_views in [0, MAX_BATCH_VIEWS + 1] {
        let batch = (0..n_views as u32).map(|i| view(1, i, 0)).collect();
        let refused = refusal(memory.apply(&store(1, batch)));
        assert_eq!(
            refused,
            StoreRefusal::BatchSize {
                n_views,
                most: MAX_BATCH_VIEWS
            }
        );
    }
    let large = |i| CapturedView {
        points: Some(vec![0; perceptual_memory::MAX_POINTS_BYTES]),
        ..view(1, i, 0)
    };
    let refused = refusal(memory.apply(&store(1, (0..4).map(large).collect())));
    assert!(
        matches!(refused, StoreRefusal::BatchBytes { .. }),
        "{refused}"
    );
    assert_eq!(
        apply(&mut memory, &[store(9, (0..3).map(large).collect())])[0].n_views,
        3
    );
    let author = "x".repeat(MAX_NAME_BYTES + 1);
    let refused = refusal(memory.apply(&Mutation {
        author,
        ..teach(1, 1, "Mug")
    }));
    assert!(
        matches!(refused, StoreRefusal::AuthorTooLong { .. }),
        "{refused}"
    );
    for count in [0, MAX_LEASE + 1, u64::MAX] {
        let refused = refusal(memory.lease_track_ids(count));
        assert_eq!(
            refused,
            StoreRefusal::LeaseSize {
                count,
                most: MAX_LEASE
            }
        );
    }
    assert_eq!(memory.sequence(), 1);
}

#[test]
fn track_id_that_was_never_leased_is_refused_and_leases_go_on() {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    assert_eq!(memory.lease_track_ids(2).unwrap(), 1);
    for track_id in [3, 1 << 32, u64::MAX - 1] {
        // The good view of the batch is not stored either.
        let batch = store(1, vec![view(1, 0, 0), view(track_id, 0, 0)]);
        let view = key(track_id, 0);
        let refused = memory.apply(&batch).unwrap_err();
        let sentence = format!("view 0 of track {track_id} cannot be stored");
        assert!(refused.to_string().starts_with(&sentence), "{refused}");
        assert_eq!(
            refusal::<MutationReceipt>(Err(refused)),
            StoreRefusal::TrackNotLeased { view }
        );
    }
    assert_eq!(memory.sequence(), 0);
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(memory.lease_track_ids(1).unwrap(), 3);
    assert_eq!(
        apply(&mut memory, &[store(2, vec![view(3, 0, 0)])]),
        [answer(1, 1)]
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Round trip of arbitrary category names.
    #[test]
    fn category_names_round_trip_even_if_hostile(texts in proptest::collection::vec(any::<String>(), 1..6)) {
        let hostile = ["_", "a\u{0}b", "\u{202e}x", "\u{1f600}", "c\u{ff}", "..", "'; DROP", "a", "aa"];
        let texts = texts.iter().map(String::as_str).chain(hostile);
        let mut names: Vec<CategoryName> = texts.filter_map(|t| CategoryName::new(t).ok()).collect();
        names.sort();
        names.dedup();
        let folder = folder();
        let (mut memory, _) = open(&folder);
        let tracks = || (1..).zip(&names);
        apply(&mut memory, &[store(0, tracks().map(|(track, _)| view(track, 0, 0)).collect())]);
        for (track_id, category) in tracks() {
            let change = StoreChange::Teach { track_id, category: category.clone() };
            apply(&mut memory, &[mutation(track_id as u128, change)]);
        }
        drop(memory);
        let (mut memory, report) = open(&folder);
        prop_assert!(!report.is_loss(), "{}", report);
        let known: Vec<CategoryName> = memory.categories().into_iter().map(|c| c.name).collect();
        prop_assert_eq!(&known, &names);
        for (track_id, category) in tracks() {
            let stored = memory.views_of_track(track_id).unwrap().remove(0);
            prop_assert_eq!(stored.standing.category(), Some(category));
        }
    }
}
