//! Incremental recognition compared with exhaustive recognition.

use super::*;
use crate::category_index::test_views::{clustered, id, name};
use crate::test_noise::noise;

const DIMENSION: usize = 90;

/// More views than are searched at once.
const N_VIEWS: usize = 2_000;

/// Number of calls after which all views have been compared.
const N_CALLS_PER_ROUND: usize = N_VIEWS.div_ceil(128);

fn index() -> CategoryIndex {
    let mut index = CategoryIndex::new(DIMENSION, Metric::Euclidean);
    for number in 0..N_VIEWS {
        let descriptor = clustered(number as u64, DIMENSION, 0.4);
        let category = name((number % 37) as u8);
        index.insert(id(number), &category, &descriptor).unwrap();
    }
    index
}

/// Axis hypotheses near a stored view, with noise of an amplitude.
fn queries(number: u64, disturbance: f32, seed: u64) -> Vec<Vec<f32>> {
    let query = |own: u64| -> Vec<f32> {
        let values = clustered(number + own, DIMENSION, 0.4).into_iter();
        let noise = noise(9_000 + 7 * seed + own);
        values
            .zip(noise)
            .map(|(v, n)| v + disturbance * n)
            .collect()
    };
    (0..4).map(query).collect()
}

fn exhaustive(index: &CategoryIndex, queries: &[Vec<f32>]) -> Recognition {
    index.recognise_any(queries, 1.0).unwrap()
}

fn recognise(
    index: &CategoryIndex,
    queries: &[Vec<f32>],
    cache: &mut NearestViewCache,
) -> Recognition {
    index.recognise_incremental(queries, 1.0, cache).unwrap()
}

#[test]
fn an_unchanged_description_is_recognised_exactly() {
    let (index, mut cache) = (index(), NearestViewCache::default());
    let queries = queries(77, 0.2, 0);
    let expected = exhaustive(&index, &queries);
    for _ in 0..3 * N_CALLS_PER_ROUND {
        assert_eq!(recognise(&index, &queries, &mut cache), expected);
    }
}

#[test]
fn a_small_change_is_recognised_exactly_after_one_round() {
    let (index, mut cache) = (index(), NearestViewCache::default());
    recognise(&index, &queries(77, 0.1, 0), &mut cache);
    for seed in 1..20 {
        let queries = queries(77, 0.1, seed);
        let expected = exhaustive(&index, &queries);
        let mut found = None;
        for _ in 0..=N_CALLS_PER_ROUND {
            let answer = recognise(&index, &queries, &mut cache);
            assert!(answer.distance >= expected.distance);
            found = Some(answer);
        }
        assert_eq!(found, Some(expected));
    }
}

#[test]
fn another_object_or_index_is_searched_exhaustively_at_once() {
    let (mut index, mut cache) = (index(), NearestViewCache::default());
    for number in (0..1_000).step_by(83) {
        let queries = queries(number, 0.05, number);
        let expected = exhaustive(&index, &queries);
        assert_eq!(recognise(&index, &queries, &mut cache), expected);
        // The new view would be the last in turn; a clone keeps the old views.
        let before = index.clone();
        let new = id(10_000 + number as usize);
        index.insert(new, &name(99), &queries[2]).unwrap();
        let taught = recognise(&index, &queries, &mut cache);
        assert_eq!(taught, exhaustive(&index, &queries));
        assert_eq!(taught.nearest[0].as_ref().map(|n| n.view), Some(new));
        assert_eq!(recognise(&before, &queries, &mut cache), expected);
        index.remove_view(new);
        assert_eq!(recognise(&index, &queries, &mut cache), expected);
    }
}

#[test]
fn the_cache_is_bounded() {
    let (index, mut cache) = (index(), NearestViewCache::default());
    for seed in 0..400 {
        let queries = queries(seed % 5, 0.1, seed);
        let answer = recognise(&index, &queries, &mut cache);
        assert!(answer.nearest.iter().all(Option::is_some));
        assert!(cache.n_cached() <= 32);
    }
}

#[test]
fn alternating_descriptions_need_one_exhaustive_search_each() {
    let (index, mut cache) = (index(), NearestViewCache::default());
    let ways = [queries(77, 0.1, 0), queries(400, 0.1, 1)];
    for way in &ways {
        recognise(&index, way, &mut cache);
    }
    let n_references = cache.n_references();
    for way in ways.iter().cycle().take(20) {
        assert_eq!(
            recognise(&index, way, &mut cache),
            exhaustive(&index, way),
            "the cached views of the other description are kept"
        );
    }
    assert_eq!((n_references, cache.n_references()), (2, 2));
}
