//! With the Euclidean metric, too, the answers are those of a comparison of all
//! pairs: the same views, in the same order, with the same bits of distances.

use super::*;
use crate::noise::noise;
use crate::recognition::N_NEAREST;
use proptest::prelude::*;

/// A view to be taught: its category and descriptor.
type Taught = (u8, Vec<f32>);

pub(super) fn name(number: u8) -> CategoryName {
    CategoryName::new(&format!("category {number}")).unwrap()
}

pub(super) fn id(number: usize) -> ViewId {
    ViewId {
        track_id: number as u64 / 3,
        view_id: number as u32 % 3,
    }
}

fn taught(views: &[Taught], dimension: usize) -> CategoryIndex {
    let mut index = CategoryIndex::new(dimension, Metric::Euclidean);
    for (number, (category, descriptor)) in views.iter().enumerate() {
        index
            .insert(id(number), &name(*category), descriptor)
            .unwrap();
    }
    index
}

/// Each view's least distance to any reading, sorted; the first of each category.
fn brute_force<'a>(
    views: impl Iterator<Item = (ViewId, CategoryName, &'a [f32])>,
    readings: &[Vec<f32>],
) -> Vec<Neighbour> {
    let metric = Metric::Euclidean;
    let mut all: Vec<(f32, ViewId, CategoryName)> = views
        .map(|(view, category, stored)| {
            let scores = readings
                .iter()
                .filter_map(|reading| metric.bounded_score(reading, stored, f32::INFINITY));
            (scores.fold(f32::INFINITY, f32::min), view, category)
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut nearest: Vec<Neighbour> = Vec::new();
    for (score, view, category) in all {
        if nearest.len() < N_NEAREST && nearest.iter().all(|n| n.category != category) {
            let distance = metric.distance_from_score(score, 1);
            nearest.push(Neighbour {
                view,
                category,
                distance,
            });
        }
    }
    nearest
}

fn check(views: &[Taught], readings: &[Vec<f32>]) {
    let index = taught(views, readings[0].len());
    let all = views.iter().enumerate();
    let all = all.map(|(number, (category, d))| (id(number), name(*category), d.as_slice()));
    let answer = index.recognise_any(readings, 1.0).unwrap();
    let found: Vec<_> = answer.nearest.into_iter().flatten().collect();
    assert_eq!(found, brute_force(all, readings));
}

/// A point near one of a few centres, so that some views are near and most are not.
pub(super) fn clustered(seed: u64, dimension: usize, spread: f32) -> Vec<f32> {
    let centre = noise(1000 + seed % 7);
    let values = centre.zip(noise(seed)).take(dimension);
    values.map(|(centre, own)| centre + spread * own).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn of_random_views(
        seeds in prop::collection::vec((0_u64..500, 0_u8..9), 0..300),
        asked in prop::collection::vec(0_u64..500, 1..6),
        dimension in prop_oneof![Just(1_usize), Just(15), Just(64), Just(65), Just(309)],
        spread in prop_oneof![Just(0.0_f32), Just(0.1), Just(3.0)],
        scale in prop_oneof![Just(1e-22_f32), Just(1e-3), Just(1.0), Just(2e5)],
    ) {
        let scaled = |seed: u64| -> Vec<f32> {
            clustered(seed, dimension, spread).iter().map(|v| v * scale).collect()
        };
        let views: Vec<_> = seeds.iter().map(|&(seed, c)| (c, scaled(seed))).collect();
        let readings: Vec<_> = asked.into_iter().map(scaled).collect();
        check(&views, &readings);
    }

    #[test]
    fn of_views_that_differ_in_their_last_values_only(
        last in prop::collection::vec((0_u8..6, -3_i8..4, -3_i8..4), 0..200),
        asked in prop::collection::vec((-3_i8..4, -3_i8..4), 1..5),
    ) {
        let descriptor = |a: i8, b: i8| {
            let mut values = clustered(5, 309, 1.0);
            values[307] = f32::from(a);
            values[308] = f32::from(b);
            values
        };
        let views: Vec<_> = last.iter().map(|&(c, a, b)| (c, descriptor(a, b))).collect();
        let readings: Vec<_> = asked.iter().map(|&(a, b)| descriptor(a, b)).collect();
        check(&views, &readings);
    }

    /// The distances differ by less than the bounds are rounded by.
    #[test]
    fn of_views_far_from_the_origin_and_near_to_each_other(
        seeds in prop::collection::vec((0_u64..60, 0_u8..6), 0..200),
        asked in prop::collection::vec(0_u64..60, 1..5),
        offset in prop_oneof![Just(10.0_f32), Just(1e3), Just(9e5)],
        is_signed in any::<bool>(),
    ) {
        let descriptor = |seed: u64| -> Vec<f32> {
            let near = clustered(seed, 309, 1e-3);
            let sign = |i: usize| if is_signed && i % 2 == 1 { -1.0 } else { 1.0 };
            near.iter().enumerate().map(|(i, v)| sign(i) * offset + v).collect()
        };
        let views: Vec<_> = seeds.iter().map(|&(seed, c)| (c, descriptor(seed))).collect();
        let readings: Vec<_> = asked.into_iter().map(descriptor).collect();
        check(&views, &readings);
    }

    /// Parallel descriptors, of which the inequality is an equation.
    #[test]
    fn of_views_on_a_line(
        factors in prop::collection::vec((1_u16..50, 0_u8..6), 0..200),
        asked in prop::collection::vec(1_u16..50, 1..5),
    ) {
        let descriptor = |factor: u16| -> Vec<f32> {
            noise(3).take(309).map(|v| v * f32::from(factor) / 7.0).collect()
        };
        let views: Vec<_> = factors.iter().map(|&(f, c)| (c, descriptor(f))).collect();
        let readings: Vec<_> = asked.into_iter().map(descriptor).collect();
        check(&views, &readings);
    }

    #[test]
    fn after_any_changes_and_of_a_clone_as_it_was(
        before in prop::collection::vec((0_usize..150, 0_u8..6, 0_u64..40, 0_u8..5), 0..300),
        after in prop::collection::vec((0_usize..150, 0_u8..6, 0_u64..40, 0_u8..5), 0..100),
        asked in prop::collection::vec(0_u64..40, 1..5),
    ) {
        let mut index = CategoryIndex::new(309, Metric::Euclidean);
        let mut model = BTreeMap::new();
        let readings: Vec<_> = asked.iter().map(|&seed| clustered(seed, 309, 0.4)).collect();
        let expected = |model: &BTreeMap<usize, (u8, Vec<f32>)>| {
            brute_force(model.iter().map(|(n, (c, d))| (id(*n), name(*c), d.as_slice())), &readings)
        };
        let found = |index: &CategoryIndex| -> Vec<Neighbour> {
            index.recognise_any(&readings, 1.0).unwrap().nearest.into_iter().flatten().collect()
        };
        for change in before {
            apply(&mut index, &mut model, change);
        }
        let (clone, at_the_clone) = (index.clone(), expected(&model));
        for change in after {
            apply(&mut index, &mut model, change);
        }
        prop_assert_eq!(found(&index), expected(&model));
        prop_assert_eq!(found(&clone), at_the_clone);
        prop_assert_eq!(index.n_views(), model.len());
    }
}

/// Inserts, moves or removes a view, by the last number.
fn apply(
    index: &mut CategoryIndex,
    model: &mut BTreeMap<usize, (u8, Vec<f32>)>,
    (number, category, seed, kind): (usize, u8, u64, u8),
) {
    match kind {
        0 => assert_eq!(
            index.remove_view(id(number)),
            model.remove(&number).is_some()
        ),
        1 => {
            let present = model.get_mut(&number);
            assert_eq!(
                index.move_view(id(number), &name(category)),
                present.is_some()
            );
            if let Some(present) = present {
                present.0 = category;
            }
        }
        _ => {
            let descriptor = clustered(seed, 309, 0.4);
            index
                .insert(id(number), &name(category), &descriptor)
                .unwrap();
            model.insert(number, (category, descriptor));
        }
    }
}

#[test]
fn the_bounds_pass_over_most_views() {
    let views: Vec<Taught> = (0..2000_u64)
        .map(|i| ((i / 7 % 6) as u8, clustered(i, 309, 0.2)))
        .collect();
    let index = taught(&views, 309);
    let readings = [clustered(7 * 300 + 3, 309, 0.2)];
    let readings: Vec<&[f32]> = readings.iter().map(Vec::as_slice).collect();
    let mut found = NearestCategories::default();
    let n_compared = pruned_search::search(
        &index.views,
        0..index.views.blocks().len(),
        &readings,
        &mut found,
        |_| {},
    );
    assert!((4..500).contains(&n_compared), "{n_compared} of 2000");
}
