//! Exactness of the pruned search: same views, same order and same bits of distances as
//! a brute-force comparison.

use super::*;
use crate::category_index::test_views::{clustered, id, name};
use crate::nearest_categories::NearestCategories;
use crate::recognition::N_NEAREST;
use crate::test_noise::noise;
use crate::{CategoryIndex, CategoryName, Neighbour, ViewId};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Category and descriptor of a taught view.
type Taught = (u8, Vec<f32>);

fn taught(views: &[Taught], dimension: usize) -> CategoryIndex {
    let mut index = CategoryIndex::new(dimension, Metric::Euclidean);
    for (number, (category, descriptor)) in views.iter().enumerate() {
        index
            .insert(id(number), &name(*category), descriptor)
            .unwrap();
    }
    index
}

/// Brute-force search: least distance of each view to any query, sorted; the first of
/// each category.
fn brute_force<'a>(
    views: impl Iterator<Item = (ViewId, CategoryName, &'a [f32])>,
    queries: &[Vec<f32>],
) -> Vec<Neighbour> {
    let metric = Metric::Euclidean;
    let mut all: Vec<(f32, ViewId, CategoryName)> = views
        .map(|(view, category, stored)| {
            let scores = queries
                .iter()
                .filter_map(|query| metric.bounded_score(query, stored, f32::INFINITY));
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
                probability: None,
            });
        }
    }
    nearest
}

fn check(views: &[Taught], queries: &[Vec<f32>]) {
    let index = taught(views, queries[0].len());
    let all = views.iter().enumerate();
    let all = all.map(|(number, (category, d))| (id(number), name(*category), d.as_slice()));
    let answer = index.recognise_any(queries, 1.0).unwrap();
    let found: Vec<_> = answer.nearest.into_iter().flatten().collect();
    assert_eq!(found, brute_force(all, queries));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn search_is_exact_for_random_views(
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
        let queries: Vec<_> = asked.into_iter().map(scaled).collect();
        check(&views, &queries);
    }

    #[test]
    fn search_is_exact_for_views_that_differ_in_their_last_values(
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
        let queries: Vec<_> = asked.iter().map(|&(a, b)| descriptor(a, b)).collect();
        check(&views, &queries);
    }

    /// Undecided comparison: the distances differ by less than the rounding errors of the bounds.
    #[test]
    fn search_is_exact_for_close_views_far_from_the_origin(
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
        let queries: Vec<_> = asked.into_iter().map(descriptor).collect();
        check(&views, &queries);
    }

    /// Parallel descriptors, for which the Cauchy-Schwarz inequality is an equality.
    #[test]
    fn search_is_exact_for_parallel_views(
        factors in prop::collection::vec((1_u16..50, 0_u8..6), 0..200),
        asked in prop::collection::vec(1_u16..50, 1..5),
    ) {
        let descriptor = |factor: u16| -> Vec<f32> {
            noise(3).take(309).map(|v| v * f32::from(factor) / 7.0).collect()
        };
        let views: Vec<_> = factors.iter().map(|&(f, c)| (c, descriptor(f))).collect();
        let queries: Vec<_> = asked.into_iter().map(descriptor).collect();
        check(&views, &queries);
    }

    #[test]
    fn search_is_exact_after_changes_and_in_an_older_clone(
        before in prop::collection::vec((0_usize..150, 0_u8..6, 0_u64..40, 0_u8..5), 0..300),
        after in prop::collection::vec((0_usize..150, 0_u8..6, 0_u64..40, 0_u8..5), 0..100),
        asked in prop::collection::vec(0_u64..40, 1..5),
    ) {
        let mut index = CategoryIndex::new(309, Metric::Euclidean);
        let mut model = BTreeMap::new();
        let queries: Vec<_> = asked.iter().map(|&seed| clustered(seed, 309, 0.4)).collect();
        let expected = |model: &BTreeMap<usize, (u8, Vec<f32>)>| {
            brute_force(model.iter().map(|(n, (c, d))| (id(*n), name(*c), d.as_slice())), &queries)
        };
        let found = |index: &CategoryIndex| -> Vec<Neighbour> {
            index.recognise_any(&queries, 1.0).unwrap().nearest.into_iter().flatten().collect()
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
            if let Some((present, descriptor)) = model.get_mut(&number) {
                index
                    .insert(id(number), &name(category), descriptor)
                    .unwrap();
                *present = category;
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
fn the_bounds_prune_most_views() {
    let views: Vec<Taught> = (0..2000_u64)
        .map(|i| ((i / 7 % 6) as u8, clustered(i, 309, 0.2)))
        .collect();
    let index = taught(&views, 309);
    let queries = [clustered(7 * 300 + 3, 309, 0.2)];
    let queries: Vec<&[f32]> = queries.iter().map(Vec::as_slice).collect();
    let mut found = NearestCategories::default();
    let n_compared = search(
        &index.views,
        0..index.views.blocks().len(),
        &queries,
        &mut found,
    );
    assert!((4..500).contains(&n_compared), "{n_compared} of 2000");
}
