//! Objects that are seen again and again.

use super::exactness::{clustered, id, name};
use super::*;
use crate::noise::noise;

const DIMENSION: usize = 90;
/// More than are searched at once.
const N_VIEWS: usize = 2_000;
/// Calls after which all views had their turn.
const N_ROUND: usize = N_VIEWS.div_ceil(128);

fn index() -> CategoryIndex {
    let mut index = CategoryIndex::new(DIMENSION, Metric::Euclidean);
    for number in 0..N_VIEWS {
        let descriptor = clustered(number as u64, DIMENSION, 0.4);
        let category = name((number % 37) as u8);
        index.insert(id(number), &category, &descriptor).unwrap();
    }
    index
}

/// Readings near to a stored view, disturbed by so much.
fn readings(number: u64, disturbance: f32, seed: u64) -> Vec<Vec<f32>> {
    let reading = |own: u64| -> Vec<f32> {
        let values = clustered(number + own, DIMENSION, 0.4).into_iter();
        let noise = noise(9_000 + 7 * seed + own);
        values
            .zip(noise)
            .map(|(v, n)| v + disturbance * n)
            .collect()
    };
    (0..4).map(reading).collect()
}

fn exactly(index: &CategoryIndex, readings: &[Vec<f32>]) -> Recognition {
    index.recognise_any(readings, 1.0).unwrap()
}

fn again(index: &CategoryIndex, readings: &[Vec<f32>], vicinity: &mut Vicinity) -> Recognition {
    index.recognise_again(readings, 1.0, vicinity).unwrap()
}

#[test]
fn what_does_not_change_is_recognised_exactly_each_time() {
    let (index, mut vicinity) = (index(), Vicinity::default());
    let readings = readings(77, 0.2, 0);
    let expected = exactly(&index, &readings);
    for _ in 0..3 * N_ROUND {
        assert_eq!(again(&index, &readings, &mut vicinity), expected);
    }
}

#[test]
fn what_changes_a_little_has_its_exact_answer_after_a_round() {
    let (index, mut vicinity) = (index(), Vicinity::default());
    again(&index, &readings(77, 0.1, 0), &mut vicinity);
    for seed in 1..20 {
        let readings = readings(77, 0.1, seed);
        let expected = exactly(&index, &readings);
        let mut found = None;
        for _ in 0..=N_ROUND {
            let answer = again(&index, &readings, &mut vicinity);
            assert!(answer.distance >= expected.distance);
            found = Some(answer);
        }
        assert_eq!(found, Some(expected));
    }
}

#[test]
fn another_object_and_another_memory_are_compared_with_all_views_at_once() {
    let (mut index, mut vicinity) = (index(), Vicinity::default());
    for number in (0..1_000).step_by(83) {
        let readings = readings(number, 0.05, number);
        let expected = exactly(&index, &readings);
        assert_eq!(again(&index, &readings, &mut vicinity), expected);
        // The new view would be the last in turn; a clone goes on with the old ones.
        let before = index.clone();
        let new = id(10_000 + number as usize);
        index.insert(new, &name(99), &readings[2]).unwrap();
        let taught = again(&index, &readings, &mut vicinity);
        assert_eq!(taught, exactly(&index, &readings));
        assert_eq!(taught.nearest[0].as_ref().map(|n| n.view), Some(new));
        assert_eq!(again(&before, &readings, &mut vicinity), expected);
        index.remove_view(new);
        assert_eq!(again(&index, &readings, &mut vicinity), expected);
    }
}

#[test]
fn what_is_kept_in_mind_is_bounded() {
    let (index, mut vicinity) = (index(), Vicinity::default());
    for seed in 0..400 {
        let readings = readings(seed % 5, 0.1, seed);
        let answer = again(&index, &readings, &mut vicinity);
        assert!(answer.nearest.iter().all(Option::is_some));
        assert!(vicinity.n_kept() <= 32);
    }
}

#[test]
fn what_is_described_in_two_ways_by_turns_is_compared_with_all_views_twice() {
    let (index, mut vicinity) = (index(), Vicinity::default());
    let ways = [readings(77, 0.1, 0), readings(400, 0.1, 1)];
    for way in &ways {
        again(&index, way, &mut vicinity);
    }
    let n_settled = vicinity.n_settled();
    for way in ways.iter().cycle().take(20) {
        assert_eq!(
            again(&index, way, &mut vicinity),
            exactly(&index, way),
            "what was near in the other way is kept"
        );
    }
    assert_eq!((n_settled, vicinity.n_settled()), (2, 2));
}
