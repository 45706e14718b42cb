use super::*;
use crate::test_noise::noise;
use proptest::prelude::*;

/// Reference implementation: all pairs are compared in each round.
fn reference(descriptors: &[Vec<f32>], n_to_drop: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..descriptors.len()).collect();
    let mut dropped = Vec::new();
    while dropped.len() < n_to_drop && !left.is_empty() {
        let mut pairs: Vec<(f32, usize)> = Vec::new();
        for (i, &older) in left.iter().enumerate() {
            for &newer in &left[i + 1..] {
                let (a, b) = (&descriptors[older], &descriptors[newer]);
                let score = METRIC.bounded_score(a, b, f32::INFINITY);
                pairs.push((score.unwrap(), older));
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let goes = pairs.first().map_or(left[0], |(_, older)| *older);
        left.retain(|place| *place != goes);
        dropped.push(goes);
    }
    dropped
}

/// Views in clusters of `n_views` around each centre of a category.
fn clustered(category: u64, n_clusters: u64, n_views: u64) -> Vec<Vec<f32>> {
    let around = |cluster: u64, view: u64| -> Vec<f32> {
        let centre = noise(category * 1000 + cluster);
        let shift = noise(1_000_000 + category * 100_000 + cluster * 1000 + view);
        let values = centre
            .zip(shift)
            .map(|(centre, shift)| centre + 0.3 * shift);
        values.take(30).collect()
    };
    let clusters = 0..n_clusters;
    clusters
        .flat_map(|cluster| (0..n_views).map(move |view| around(cluster, view)))
        .collect()
}

#[test]
fn duplicates_are_pruned_first_and_outliers_last() {
    let descriptors = [[0.0, 0.0], [9.0, 9.0], [1.0, 0.0], [0.0, 0.0], [1.5, 0.0]];
    assert_eq!(redundant_views(&descriptors, 1), Ok(vec![0]));
    // Of three similar views the newest remains, and the outlier.
    assert_eq!(redundant_views(&descriptors, 3), Ok(vec![0, 2, 3]));
}

#[test]
fn ties_are_broken_by_age() {
    let descriptors = [[5.0], [0.0], [6.0], [1.0]];
    assert_eq!(redundant_views(&descriptors, 2), Ok(vec![0, 1]));
    assert_eq!(redundant_views(&[[1.0]; 4], 3), Ok(vec![0, 1, 2]));
}

#[test]
fn pruning_ends_with_the_last_view() {
    assert_eq!(redundant_views(&[[1.0], [2.0]], 9), Ok(vec![0, 1]));
    assert_eq!(redundant_views(&[[1.0], [2.0]], 0), Ok(vec![]));
    assert_eq!(redundant_views(&[] as &[Vec<f32>], 3), Ok(vec![]));
}

#[test]
fn incomparable_descriptors_are_rejected() {
    let unequal = [vec![1.0, 2.0], vec![1.0]];
    let error = redundant_views(&unequal, 1).unwrap_err();
    let (expected, found) = (2, 1);
    assert_eq!(error, Error::Dimension { expected, found });
    for wrong in [f32::NAN, f32::INFINITY, 2e6] {
        let error = redundant_views(&[[1.0], [wrong]], 1).unwrap_err();
        assert!(matches!(error, Error::Value { position: 0, .. }));
    }
}

/// Category of the nearest view, except the one at `but`.
fn nearest_category(views: &[(u64, Vec<f32>)], asked: &[f32], but: Option<usize>) -> u64 {
    let others = views.iter().enumerate().filter(|(i, _)| Some(*i) != but);
    let distance = |view: &[f32]| METRIC.distance(asked, view).unwrap();
    let nearest = others.min_by(|a, b| distance(&a.1.1).total_cmp(&distance(&b.1.1)));
    nearest.unwrap().1.0
}

/// Leave-one-out recognition is unchanged for 99 % of the views after pruning a tenth of
/// them.
#[test]
fn recognition_survives_the_pruning_of_a_tenth() {
    let mut all: Vec<(u64, Vec<f32>)> = Vec::new();
    let mut kept: Vec<(usize, u64, Vec<f32>)> = Vec::new();
    for category in 0..5 {
        let views = clustered(category, 6, 10);
        let gone = redundant_views(&views, views.len() / 10).unwrap();
        assert_eq!(gone.len(), 6);
        for (place, view) in views.into_iter().enumerate() {
            if !gone.contains(&place) {
                kept.push((all.len(), category, view.clone()));
            }
            all.push((category, view));
        }
    }
    let left: Vec<(u64, Vec<f32>)> = kept.iter().map(|(_, c, v)| (*c, v.clone())).collect();
    let agrees = |(i, (_, view)): &(usize, &(u64, Vec<f32>))| {
        let place = kept.iter().position(|(of_all, ..)| of_all == i);
        nearest_category(&all, view, Some(*i)) == nearest_category(&left, view, place)
    };
    let n_agreeing = all.iter().enumerate().filter(agrees).count();
    assert!(
        n_agreeing * 100 >= all.len() * 99,
        "{n_agreeing} of {}",
        all.len()
    );
}

/// Pruning keeps one view of each cluster as long as possible.
#[test]
fn pruning_keeps_one_view_of_each_cluster() {
    let views = clustered(1, 20, 10);
    let gone = redundant_views(&views, 180).unwrap();
    let mut kinds: Vec<usize> = (0..200)
        .filter(|i| !gone.contains(i))
        .map(|i| i / 10)
        .collect();
    kinds.dedup();
    assert_eq!(kinds, (0..20).collect::<Vec<_>>());
}

proptest! {
    #[test]
    fn pruning_matches_the_reference_implementation(
        // Few distinct values, so that duplicates and ties are frequent.
        descriptors in (1_usize..40).prop_flat_map(|dimension| {
            let value = prop_oneof![(0_u8..3).prop_map(f32::from), -2.0_f32..2.0];
            let descriptor = prop::collection::vec(value, dimension);
            prop::collection::vec(descriptor, 0..25)
        }),
        n_to_drop in 0_usize..30,
    ) {
        prop_assert_eq!(
            redundant_views(&descriptors, n_to_drop).unwrap(),
            reference(&descriptors, n_to_drop)
        );
    }
}
