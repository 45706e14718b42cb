use super::*;
use crate::recognition::N_NEAREST;
use crate::{DescriptorSymmetries, MemoryTerm};
use proptest::prelude::*;

const DIMENSION: usize = 150;

/// Random change of the index; categories and descriptors by number.
#[derive(Debug, Clone)]
enum Change {
    Insert(ViewId, u8, u8),
    Remove(ViewId),
}

fn name(number: u8) -> CategoryName {
    CategoryName::new(&format!("category {number}")).unwrap()
}

/// One of 40 sparse histograms: few enough for duplicates and ties.
fn descriptor(number: u8) -> Vec<f32> {
    let mut values = vec![0.0; DIMENSION];
    for i in 0..30_usize {
        values[(usize::from(number % 40) * 7 + i * i) % DIMENSION] += (i % 5) as f32 / 60.0;
    }
    values
}

fn view() -> impl Strategy<Value = ViewId> {
    (0_u64..6, 0_u32..6).prop_map(|(track_id, view_id)| ViewId { track_id, view_id })
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        6 => (view(), 0_u8..6, any::<u8>()).prop_map(|(v, c, d)| Change::Insert(v, c, d)),
        2 => view().prop_map(Change::Remove),
    ]
}

fn apply(batch: &mut IndexBatch<'_>, change: &Change) {
    match *change {
        Change::Insert(id, category, number) => {
            batch
                .insert(id, &name(category), &descriptor(number))
                .unwrap();
        }
        Change::Remove(id) => drop(batch.remove_view(id)),
    }
}

/// Reference model of the index: a map.
type Model = BTreeMap<ViewId, (CategoryName, Vec<f32>)>;

fn apply_to_model(model: &mut Model, change: &Change) {
    match *change {
        Change::Insert(id, category, number) => {
            model.insert(id, (name(category), descriptor(number)));
        }
        Change::Remove(id) => drop(model.remove(&id)),
    }
}

/// Brute-force search: all views sorted by score, then id; the first of each category.
fn brute_force(model: &Model, metric: Metric, query: &[f32]) -> Vec<Neighbour> {
    let score = |stored: &[f32]| {
        let unbounded = metric.bounded_score(query, stored, f32::INFINITY);
        unbounded.unwrap()
    };
    let mut all: Vec<(f32, ViewId, &CategoryName)> = model
        .iter()
        .map(|(id, (name, stored))| (score(stored), *id, name))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut nearest: Vec<Neighbour> = Vec::new();
    for (score, view, category) in all {
        if nearest.len() < N_NEAREST && nearest.iter().all(|n| n.category != *category) {
            let distance = metric.distance_from_score(score, DIMENSION);
            nearest.push(Neighbour {
                view,
                category: category.clone(),
                distance,
                probability: None,
            });
        }
    }
    nearest
}

fn filled(changes: &[Change], metric: Metric) -> (CategoryIndex, Model) {
    let (mut index, mut model) = (CategoryIndex::new(DIMENSION, metric), Model::new());
    for change in changes {
        apply(&mut index.batch(), change);
        apply_to_model(&mut model, change);
    }
    (index, model)
}

fn answers(index: &CategoryIndex) -> Vec<Recognition> {
    (0..40)
        .map(|i| index.recognise(&descriptor(i), 0.3).unwrap())
        .collect()
}

/// Calibration with two axis hypotheses: a descriptor and its reverse.
const CALIBRATION: Calibration = Calibration {
    symmetries: DescriptorSymmetries {
        turns_of: |stored| vec![stored.to_vec(), stored.iter().rev().copied().collect()],
        ..DescriptorSymmetries::NONE
    },
    learned_metric: None,
    kernel_width: 1.0,
    ridge: 0.03,
    background_distance: 2.0,
    spread_prior: 0.5,
    score_weight: MemoryTerm::constant(8.0),
    unknown_bias: MemoryTerm::constant(4.0),
    unknown_slope: 2.5,
};

fn calibrated() -> CategoryIndex {
    CategoryIndex::new(DIMENSION, Metric::Euclidean).with_calibration(CALIBRATION)
}

proptest! {
    #[test]
    fn probabilities_are_independent_of_the_history_of_the_index(
        batches in prop::collection::vec(prop::collection::vec(change(), 0..8), 0..8),
        asked in any::<u8>(),
    ) {
        let (mut index, mut model) = (calibrated(), Model::new());
        for changes in &batches {
            let mut batch = index.batch();
            for change in changes {
                apply(&mut batch, change);
                apply_to_model(&mut model, change);
            }
        }
        let mut fresh = calibrated();
        for (id, (name, descriptor)) in &model {
            fresh.insert(*id, name, descriptor).unwrap();
        }
        let rule = UnknownRule::LessProbableThan {
    probability: 0.5,
    novelty_prior: 0.25,
};
        let found = index.recognise(&descriptor(asked), rule).unwrap();
        let expected = fresh.recognise(&descriptor(asked), rule).unwrap();
        prop_assert_eq!(&found.label, &expected.label);
        for pair in found.nearest.iter().zip(&expected.nearest) {
            match pair {
                (Some(a), Some(b)) => {
                    prop_assert_eq!((a.view, &a.category, a.distance), (b.view, &b.category, b.distance));
                    prop_assert!((a.probability.unwrap() - b.probability.unwrap()).abs() < 1e-6);
                }
                (a, b) => prop_assert_eq!(a, b),
            }
        }
    }

    #[test]
    fn recognition_equals_brute_force(
        changes in prop::collection::vec(change(), 0..120),
        query in any::<u8>(),
        threshold in 0.0_f32..2.0,
    ) {
        for metric in Metric::ALL {
            let (index, model) = filled(&changes, metric);
            let expected = brute_force(&model, metric, &descriptor(query));
            let answer = index.recognise(&descriptor(query), threshold).unwrap();
            let nearest: Vec<_> = answer.nearest.iter().flatten().cloned().collect();
            prop_assert_eq!(&nearest, &expected);
            let known = expected.first().filter(|first| first.distance <= threshold);
            prop_assert_eq!(answer.label, known.map(|first| first.category.clone()));
            prop_assert_eq!(answer.distance, expected.first().map_or(f32::INFINITY, |n| n.distance));
        }
    }

    #[test]
    fn several_descriptors_give_the_least_distance_per_category(
        changes in prop::collection::vec(change(), 0..120),
        queries in prop::collection::vec(any::<u8>(), 0..5),
        threshold in 0.0_f32..2.0,
    ) {
        let (index, model) = filled(&changes, Metric::default());
        let queries: Vec<_> = queries.into_iter().map(descriptor).collect();
        let answer = index.recognise_any(&queries, threshold).unwrap();
        let distance = |category: &CategoryName| {
            let of_category = model.values().filter(|(name, _)| name == category);
            let pairs = of_category.flat_map(|(_, stored)| queries.iter().map(move |q| (q, stored)));
            let distances = pairs.map(|(q, stored)| index.metric().distance(q, stored).unwrap());
            distances.fold(f32::INFINITY, f32::min)
        };
        let mut expected: Vec<f32> = index.categories().map(|(name, _)| distance(name)).collect();
        expected.retain(|distance| distance.is_finite());
        expected.sort_by(f32::total_cmp);
        expected.truncate(N_NEAREST);
        let found: Vec<_> = answer.nearest.iter().flatten().collect();
        prop_assert_eq!(found.iter().map(|n| n.distance).collect::<Vec<_>>(), expected);
        for neighbour in &found {
            prop_assert_eq!(neighbour.distance, distance(&neighbour.category));
        }
        let known = found.first().filter(|first| first.distance <= threshold);
        prop_assert_eq!(answer.label.as_ref(), known.map(|first| &first.category));
    }

    #[test]
    fn counts_match_the_model(changes in prop::collection::vec(change(), 0..120)) {
        let (index, model) = filled(&changes, Metric::default());
        let mut counts: BTreeMap<&CategoryName, usize> = BTreeMap::new();
        for (category, _) in model.values() {
            *counts.entry(category).or_default() += 1;
        }
        prop_assert_eq!(index.n_views(), model.len());
        prop_assert!(index.categories().eq(counts));
    }

    #[test]
    fn changes_may_be_replayed_over_a_newer_state(
        changes in prop::collection::vec(change(), 0..60),
        from in 0_usize..60,
    ) {
        let (mut index, _) = filled(&changes, Metric::default());
        let expected = answers(&index);
        for change in changes.iter().skip(from) {
            apply(&mut index.batch(), change);
        }
        prop_assert_eq!(answers(&index), expected);
    }

    #[test]
    fn changes_are_idempotent(
        changes in prop::collection::vec(change(), 0..60),
        twice in change(),
    ) {
        let (mut index, _) = filled(&changes, Metric::default());
        apply(&mut index.batch(), &twice);
        let expected = answers(&index);
        apply(&mut index.batch(), &twice);
        prop_assert_eq!(answers(&index), expected);
    }

    #[test]
    fn recognition_is_independent_of_the_order_of_teaching(
        (taught, shuffled) in prop::collection::btree_map(view(), (0_u8..6, any::<u8>()), 0..36)
            .prop_map(|views| {
                views.into_iter().map(|(v, (c, d))| Change::Insert(v, c, d)).collect::<Vec<_>>()
            })
            .prop_flat_map(|inserts| (Just(inserts.clone()), Just(inserts).prop_shuffle())),
    ) {
        let (one, _) = filled(&taught, Metric::default());
        let (other, _) = filled(&shuffled, Metric::default());
        prop_assert_eq!(answers(&one), answers(&other));
    }
}

#[test]
fn a_single_view_can_win_and_a_duplicate_has_distance_zero() {
    let mut index = CategoryIndex::new(DIMENSION, Metric::default());
    let id = ViewId {
        track_id: 1,
        view_id: 0,
    };
    index.insert(id, &name(1), &descriptor(3)).unwrap();
    let answer = index.recognise(&descriptor(3), 0.0).unwrap();
    assert_eq!((answer.label, answer.distance), (Some(name(1)), 0.0));
    assert_eq!(answer.nearest[0].as_ref().map(|n| n.view), Some(id));
    assert_eq!(answer.nearest[1], None);
}

#[test]
fn a_rejected_object_keeps_its_nearest_neighbour() {
    let mut index = CategoryIndex::new(DIMENSION, Metric::default());
    assert_eq!(
        index.recognise(&descriptor(0), 9.0).unwrap().distance,
        f32::INFINITY
    );
    index
        .insert(
            ViewId {
                track_id: 1,
                view_id: 0,
            },
            &name(1),
            &descriptor(3),
        )
        .unwrap();
    let distance = index
        .recognise(&descriptor(4), f32::INFINITY)
        .unwrap()
        .distance;
    for (threshold, label) in [
        (distance, Some(name(1))),
        (0.99 * distance, None),
        (f32::NAN, None),
    ] {
        let answer = index.recognise(&descriptor(4), threshold).unwrap();
        assert_eq!(answer.label, label);
        assert_eq!(
            answer.nearest[0].as_ref().map(|n| &n.category),
            Some(&name(1))
        );
    }
}

#[test]
fn invalid_descriptors_are_rejected_without_effect() {
    let mut index = CategoryIndex::new(3, Metric::default());
    let id = ViewId {
        track_id: 1,
        view_id: 0,
    };
    index.insert(id, &name(1), &[0.0, 1.0, 0.0]).unwrap();
    for wrong in [f32::NAN, f32::INFINITY, -1e-9, 2e6] {
        let error = index.insert(id, &name(2), &[0.0, wrong, 0.0]).unwrap_err();
        assert!(matches!(error, Error::Value { position: 1, .. }));
        assert!(index.recognise(&[wrong, 0.0, 0.0], 1.0).is_err());
    }
    let error = index
        .insert(id, &name(2), &[0.5; 4])
        .unwrap_err()
        .to_string();
    assert!(error.contains("descriptor of 4 values"), "{error}");
    assert!(index.categories().eq([(&name(1), 1)]));
}

#[test]
fn a_cleared_index_is_empty() {
    let mut index = CategoryIndex::new(DIMENSION, Metric::default());
    let id = ViewId {
        track_id: 1,
        view_id: 0,
    };
    index.insert(id, &name(1), &descriptor(3)).unwrap();
    index.clear();
    assert_eq!((index.n_views(), index.categories().len()), (0, 0));
    assert_eq!(index.recognise(&descriptor(3), 1.0).unwrap().label, None);
    assert!(!index.remove_view(id));
}

#[test]
fn a_novel_object_is_improbable_and_unknown() {
    let mut index = calibrated();
    let rule = UnknownRule::LessProbableThan {
        probability: 0.5,
        novelty_prior: 0.25,
    };
    let at = |place: usize, value: f32| {
        let mut values = vec![0.0; DIMENSION];
        values[place] = value;
        values
    };
    let nothing = index.recognise(&at(0, 1.0), rule).unwrap();
    assert_eq!((nothing.label, nothing.probability), (None, Some(0.0)));
    for (view_id, place, value) in [(0, 0, 1.0), (1, 0, 1.2), (2, 60, 1.0), (3, 60, 1.3)] {
        let id = ViewId {
            track_id: 1,
            view_id,
        };
        index
            .insert(id, &name(place as u8), &at(place, value))
            .unwrap();
    }
    let known = index.recognise(&at(0, 1.1), rule).unwrap();
    assert_eq!(known.label, Some(name(0)));
    assert!(known.probability.unwrap() > 0.9);
    let strange = index.recognise(&at(30, 1.0), rule).unwrap();
    assert_eq!(strange.label, None);
    assert!(strange.probability.unwrap() < 0.1);
}

#[test]
fn evidence_of_several_views_outweighs_one_near_stranger() {
    let mut index = calibrated();
    let at = |x: f32, y: f32| {
        let mut values = vec![0.0; DIMENSION];
        (values[0], values[1]) = (x, y);
        values
    };
    // Four mugs around the object, and a can that is nearest by a little.
    let around = [(0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)];
    for (view_id, (x, y)) in (0..).zip(around) {
        let id = ViewId {
            track_id: 1,
            view_id,
        };
        index.insert(id, &name(1), &at(x, y)).unwrap();
    }
    let can = ViewId {
        track_id: 2,
        view_id: 0,
    };
    index.insert(can, &name(2), &at(0.34, 0.34)).unwrap();
    let answer = index.recognise(&at(0.0, 0.0), f32::INFINITY).unwrap();
    assert_eq!(answer.label, Some(name(1)));
    let [first, second, ..] = answer.nearest.each_ref().map(|n| n.as_ref());
    assert!(second.unwrap().distance < first.unwrap().distance);
}

#[test]
fn sides_that_disagree_are_decided_by_their_mean() {
    let mut index = calibrated();
    let at = |place: usize, value: f32| {
        let mut values = vec![0.0; DIMENSION];
        values[place] = value;
        values
    };
    for (track_id, place, category) in [(1, 0, 1), (2, 10, 1), (3, 20, 2), (4, 0, 2)] {
        let id = ViewId {
            track_id,
            view_id: 0,
        };
        let value = if track_id == 4 { 0.8 } else { 1.0 };
        index
            .insert(id, &name(category), &at(place, value))
            .unwrap();
    }
    // Alone the first side is between the categories; the second one decides.
    let sides = [[at(0, 0.88)], [at(10, 1.0)]];
    let alone = index.recognise(&sides[0][0], f32::INFINITY).unwrap();
    assert_eq!(alone.label, Some(name(2)));
    let both = index.recognise_sides(&sides, f32::INFINITY).unwrap();
    assert_eq!((both.label, both.n_sides), (Some(name(1)), 2));
}

#[test]
fn without_calibration_the_sides_add_their_distances() {
    let mut index = CategoryIndex::new(2, Metric::Euclidean);
    for (track_id, category, values) in [(1, 1, [0.0, 0.0]), (2, 2, [0.3, 0.0]), (3, 2, [0.0, 1.0])]
    {
        let id = ViewId {
            track_id,
            view_id: 0,
        };
        index.insert(id, &name(category), &values).unwrap();
    }
    // 0 + 1 to the first category, 0.3 + 0 to the second.
    let sides = [[vec![0.0, 0.0]], [vec![0.0, 1.0]]];
    let answer = index.recognise_sides(&sides, f32::INFINITY).unwrap();
    assert_eq!(answer.label, Some(name(2)));
    assert!((answer.distance - 0.15).abs() < 1e-6, "{}", answer.distance);
}
