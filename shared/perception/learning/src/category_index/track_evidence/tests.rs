//! Recognition of tracks compared with exhaustive recognition.

use super::*;
use crate::category_index::test_views::{clustered, id, name};
use crate::test_noise::noise;
use crate::{Calibration, CategoryName, DescriptorSymmetries, MemoryTerm};
use proptest::prelude::*;

const DIMENSION: usize = 90;
const N_VIEWS: usize = 600;

const CALIBRATION: Calibration = Calibration {
    symmetries: DescriptorSymmetries::NONE,
    learned_metric: None,
    kernel_width: 2.0,
    ridge: 0.03,
    background_distance: 2.0,
    spread_prior: 2.0,
    score_weight: MemoryTerm::constant(8.0),
    unknown_bias: MemoryTerm::constant(4.0),
    unknown_slope: 2.5,
};

fn empty() -> CategoryIndex {
    CategoryIndex::new(DIMENSION, Metric::Euclidean).with_calibration(CALIBRATION)
}

fn index() -> CategoryIndex {
    let mut index = empty();
    for number in 0..N_VIEWS {
        let descriptor = clustered(number as u64, DIMENSION, 0.4);
        // Views of a cluster share a category.
        index
            .insert(id(number), &name((number % 7) as u8), &descriptor)
            .unwrap();
    }
    index
}

/// Description near a stored view, with noise of an amplitude.
fn seen(number: u64, disturbance: f32, seed: u64) -> [Vec<f32>; 1] {
    let values = clustered(number, DIMENSION, 0.4).into_iter();
    let noise = noise(9_000 + seed);
    [values
        .zip(noise)
        .map(|(v, n)| v + disturbance * n)
        .collect()]
}

fn look(
    index: &CategoryIndex,
    queries: &[Vec<f32>],
    view_use: ViewUse,
    track: &mut TrackEvidence,
) -> Recognition {
    index
        .recognise_track(queries, view_use, 1e9, track)
        .unwrap()
        .clone()
}

#[test]
fn an_object_at_rest_is_recognised_as_in_its_first_frame() {
    let (index, mut track) = (index(), TrackEvidence::default());
    let first = look(&index, &seen(77, 0.02, 0), ViewUse::KeyView, &mut track);
    assert_eq!(first, index.recognise_any(&seen(77, 0.02, 0), 1e9).unwrap());
    for seed in 1..50 {
        let again = look(&index, &seen(77, 0.02, seed), ViewUse::Whole, &mut track);
        assert_eq!(again, first);
    }
    assert_eq!(track.n_sides(), 1);
}

#[test]
fn answers_after_any_change_are_those_of_an_exhaustive_search() {
    let (mut index, mut track) = (index(), TrackEvidence::default());
    let queries = seen(77, 0.02, 0);
    look(&index, &queries, ViewUse::KeyView, &mut track);
    for step in 0..400_usize {
        match step % 5 {
            // Near views, far views, moved and removed ones, the nearest among them.
            0 => {
                let near = seen(77, 0.3, step as u64);
                index.insert(id(9_000 + step), &name(11), &near[0]).unwrap();
            }
            1 => {
                let far = clustered(step as u64 + 3, DIMENSION, 0.4);
                index.insert(id(9_000 + step), &name(12), &far).unwrap();
            }
            2 => {
                let same = clustered(step as u64, DIMENSION, 0.4);
                index.insert(id(step), &name(13), &same).unwrap();
            }
            3 => drop(index.remove_view(id(7 * step % N_VIEWS))),
            _ => {
                let nearest = index.recognise_any(&queries, 1e9).unwrap().nearest;
                index.remove_view(nearest[0].as_ref().unwrap().view);
            }
        }
        let found = look(&index, &queries, ViewUse::Whole, &mut track);
        assert_eq!(found, index.recognise_any(&queries, 1e9).unwrap(), "{step}");
    }
}

#[test]
fn another_index_is_searched_anew() {
    let (index, mut track) = (index(), TrackEvidence::default());
    let queries = seen(77, 0.02, 0);
    look(&index, &queries, ViewUse::KeyView, &mut track);
    let mut other = empty();
    other.insert(id(1), &name(20), &queries[0]).unwrap();
    let found = look(&other, &queries, ViewUse::Whole, &mut track);
    assert_eq!(found, other.recognise_any(&queries, 1e9).unwrap());
    let nothing = look(&empty(), &queries, ViewUse::Whole, &mut track);
    assert_eq!((nothing.label, nothing.probability), (None, Some(0.0)));
}

#[test]
fn different_sides_count_and_equal_ones_do_not() {
    let (index, mut track) = (index(), TrackEvidence::default());
    for seed in 0..3 {
        look(&index, &seen(77, 0.02, seed), ViewUse::KeyView, &mut track);
    }
    assert_eq!(track.n_sides(), 1);
    let sides = [77, 85].map(|number| seen(number, 0.02, 0));
    let both = look(&index, &sides[1], ViewUse::KeyView, &mut track);
    assert_eq!(both.n_sides, 2);
    assert_eq!(both, index.recognise_sides(&sides, 1e9).unwrap());
    for number in 0..40 {
        look(&index, &seen(number, 0.0, 0), ViewUse::KeyView, &mut track);
    }
    assert_eq!(track.n_sides(), N_SIDES_MAX);
}

#[test]
fn sides_seen_before_the_first_lesson_count_after_it() {
    let (mut index, mut track) = (empty(), TrackEvidence::default());
    let sides = [77, 85].map(|number| seen(number, 0.0, 0));
    for side in &sides {
        look(&index, side, ViewUse::KeyView, &mut track);
    }
    index.insert(id(1), &name(1), &sides[0][0]).unwrap();
    index.reread_track(UnknownRule::FartherThan(1e9), &mut track);
    assert_eq!(track.recognition().n_sides, 2);
    let both = index.recognise_sides(&sides, 1e9).unwrap();
    assert_eq!(track.recognition(), &both);
}

#[test]
fn a_partial_view_keeps_the_answer() {
    let (index, mut track) = (index(), TrackEvidence::default());
    let whole = look(&index, &seen(77, 0.02, 0), ViewUse::KeyView, &mut track);
    for seed in 0..60 {
        let partial = look(&index, &seen(78, 0.3, seed), ViewUse::Partial, &mut track);
        assert_eq!(partial, whole);
    }
    // Without any other view, a partial one counts, and the newest of them.
    let mut new = TrackEvidence::default();
    let mut partial = None;
    for number in [78, 79, 79, 79, 79, 79] {
        let queries = seen(number, 0.0, 0);
        partial = Some(look(&index, &queries, ViewUse::Partial, &mut new));
    }
    let newest = index.recognise_any(&seen(79, 0.0, 0), 1e9).unwrap();
    assert_eq!(partial, Some(newest));
    // The first view of the whole object replaces it at once.
    let whole = look(&index, &seen(85, 0.0, 0), ViewUse::Whole, &mut new);
    assert_eq!(whole, index.recognise_any(&seen(85, 0.0, 0), 1e9).unwrap());
}

#[test]
fn an_exchanged_object_loses_its_label_within_a_second() {
    let (index, mut track) = (index(), TrackEvidence::default());
    for number in [70, 77, 84, 91] {
        look(&index, &seen(number, 0.05, 0), ViewUse::KeyView, &mut track);
    }
    let label = |answer: Recognition| answer.label.as_ref().map(CategoryName::to_string);
    let before = label(look(&index, &seen(91, 0.05, 0), ViewUse::Whole, &mut track));
    assert_eq!(before.as_deref(), Some("category 0"));
    // Thirty frames of an object of another category on its place.
    let labels = (0..30).map(|seed| {
        label(look(
            &index,
            &seen(73, 0.05, seed),
            ViewUse::Whole,
            &mut track,
        ))
    });
    let labels: Vec<_> = labels.collect();
    assert_eq!(labels.last().unwrap().as_deref(), Some("category 3"));
    assert_eq!(track.n_sides(), 1);
}

#[test]
fn a_description_that_keeps_changing_is_searched_in_every_fifth_frame() {
    let (index, mut track) = (index(), TrackEvidence::default());
    let mut n_answers = 0;
    let mut last = None;
    for number in 0..50 {
        let answer = look(&index, &seen(number, 0.0, 0), ViewUse::Whole, &mut track);
        n_answers += u32::from(last.as_ref() != Some(&answer));
        last = Some(answer);
    }
    assert!((9..=11).contains(&n_answers), "{n_answers}");
}

#[test]
fn side_that_comes_and_goes_counts_until_it_was_not_seen_for_half_a_second() {
    let (index, mut track) = (index(), TrackEvidence::default());
    look(&index, &seen(77, 0.02, 0), ViewUse::KeyView, &mut track);
    let mut n_sides = |numbers: &dyn Fn(u64) -> u64, n_frames: u64| -> Vec<usize> {
        let mut looked = |frame| {
            let view = seen(numbers(frame), 0.02, frame);
            look(&index, &view, ViewUse::Whole, &mut track);
            track.n_sides()
        };
        (0..n_frames).map(&mut looked).collect()
    };
    let at_times = |frame| if frame % 7 == 5 { 85 } else { 77 };
    assert_eq!(n_sides(&at_times, 60), [1; 60], "one frame is none");
    assert_eq!(n_sides(&|_| 85, 5), [1, 1, 1, 1, 2]);
    assert_eq!(n_sides(&at_times, 60), [2; 60]);
    let n_held = (0..60).take_while(|&frame| {
        look(&index, &seen(77, 0.02, frame), ViewUse::Whole, &mut track);
        track.n_sides() == 2
    });
    assert_eq!(n_held.count(), 9, "five frames had passed already");
}

/// Step of a random lesson.
#[derive(Debug, Clone)]
enum LessonStep {
    /// A view of a track is seen.
    Look {
        track: usize,
        number: u64,
        view_use: ViewUse,
    },
    /// Stored views get a category, new or known.
    Teach {
        first: usize,
        n_views: usize,
        category: u8,
    },
    /// Stored views are forgotten.
    Forget { first: usize, n_views: usize },
    /// The memory is another store.
    Clear,
}

const RULE: UnknownRule = UnknownRule::LessProbableThan {
    probability: 0.75,
    novelty_prior: 0.25,
};
const N_TRACKS: usize = 4;

fn step() -> impl Strategy<Value = LessonStep> {
    let view_use = prop_oneof![
        3 => Just(ViewUse::KeyView),
        1 => Just(ViewUse::Whole),
        1 => Just(ViewUse::Partial),
    ];
    // One change in twelve is longer than the change log.
    let n_views = prop_oneof![11 => 1..20_usize, 1 => Just(1100_usize)];
    prop_oneof![
        8 => (0..N_TRACKS, 0..200_u64, view_use)
            .prop_map(|(track, number, view_use)| LessonStep::Look { track, number, view_use }),
        6 => (0..300_usize, n_views, 0..9_u8)
            .prop_map(|(first, n_views, category)| LessonStep::Teach { first, n_views, category }),
        3 => (0..300_usize, 1..30_usize)
            .prop_map(|(first, n_views)| LessonStep::Forget { first, n_views }),
        1 => Just(LessonStep::Clear),
    ]
}

fn apply(step: &LessonStep, index: &mut CategoryIndex, tracks: &mut [TrackEvidence]) {
    match *step {
        LessonStep::Look {
            track,
            number,
            view_use,
        } => {
            let queries = seen(number, 0.02, 0);
            index
                .recognise_track(&queries, view_use, RULE, &mut tracks[track])
                .unwrap();
        }
        LessonStep::Teach {
            first,
            n_views,
            category,
        } => {
            let mut batch = index.batch();
            for number in first..first + n_views {
                let descriptor = clustered(number as u64, DIMENSION, 0.4);
                batch
                    .insert(id(number), &name(category), &descriptor)
                    .unwrap();
            }
        }
        LessonStep::Forget { first, n_views } => {
            let mut batch = index.batch();
            for number in first..first + n_views {
                batch.remove_view(id(number));
            }
        }
        LessonStep::Clear => index.clear(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The label of every track, not only of those that a lesson is about, is that of a fresh
    /// recognition of all sides that were seen, against the memory as it is now.
    #[test]
    fn label_read_anew_is_that_of_a_fresh_recognition_of_all_sides(
        steps in prop::collection::vec(step(), 1..60),
    ) {
        let mut index = index();
        let mut tracks = vec![TrackEvidence::default(); N_TRACKS];
        for step in &steps {
            let n_sides: Vec<usize> = tracks.iter().map(TrackEvidence::n_sides).collect();
            apply(step, &mut index, &mut tracks);
            for track in &mut tracks {
                index.reread_track(RULE, track);
                prop_assert!(index.is_current(track, RULE));
                let sides: Vec<Vec<Vec<f32>>> = track.descriptions().map(<[_]>::to_vec).collect();
                let fresh = index.recognise_sides(&sides, RULE).unwrap();
                prop_assert_eq!(track.recognition(), &fresh);
            }
            if !matches!(step, LessonStep::Look { .. }) {
                let after: Vec<usize> = tracks.iter().map(TrackEvidence::n_sides).collect();
                prop_assert_eq!(n_sides, after, "a lesson changes no evidence");
            }
        }
    }
}
