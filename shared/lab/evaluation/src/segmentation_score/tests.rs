use super::*;
use proptest::prelude::*;

/// Label images of runs `(n_pixels, hypothesis, label)`.
fn image(runs: &[(usize, u16, u16)]) -> (Vec<u16>, Vec<u16>) {
    let pixels = runs
        .iter()
        .flat_map(|&(n, hypothesis, label)| std::iter::repeat_n((hypothesis, label), n));
    pixels.unzip()
}

fn scored(runs: &[(usize, u16, u16)]) -> Option<SegmentationScore> {
    let (hypotheses, labels) = image(runs);
    score(&Overlaps::count(&hypotheses, &labels))
}

#[track_caller]
fn assert_near(found: &SegmentationScore, expected: [f64; 11]) {
    for ((name, found), expected) in MEASURE_NAMES.iter().zip(found.values()).zip(expected) {
        assert!(
            (found - expected).abs() < 1e-12,
            "{name}: {found}, not {expected}"
        );
    }
}

#[test]
fn a_scene_computed_by_hand() {
    // Object 20 has 400 pixels: 300 in hypothesis 1, 100 in 2. Object 31 has 200 pixels, all in
    // hypothesis 3, which also has 200 of the table. Hypothesis 4 is on the table only; pixels
    // without a label are ignored.
    let score = scored(&[
        (300, 1, 20),
        (100, 2, 20),
        (200, 3, 31),
        (200, 3, 1),
        (150, 4, 9),
        (500, 0, 1),
        (700, 3, 0),
    ])
    .unwrap();
    assert_eq!((score.n_objects, score.n_hypotheses), (2, 4));
    let (o_p, o_r) = (500.0 / 950.0, 500.0 / 600.0);
    assert_near(
        &score,
        [
            (400.0 * 0.75 + 200.0 * 0.5) / 600.0,
            0.625,
            100.0 / 600.0,
            200.0 / 600.0,
            // An overlap of exactly one half is no match.
            1.0 / 4.0,
            1.0 / 2.0,
            2.0 / 6.0,
            o_p,
            o_r,
            2.0 * o_p * o_r / (o_p + o_r),
            1.0 / 2.0,
        ],
    );
}

#[test]
fn one_hypothesis_over_two_objects_is_matched_once() {
    let score = scored(&[(300, 7, 20), (100, 7, 30)]).unwrap();
    // Both objects have it as largest hypothesis, with 100 and 300 pixels outside.
    assert_near(
        &score,
        [
            (300.0 * 0.75 + 100.0 * 0.25) / 400.0,
            0.5,
            0.0,
            1.0,
            1.0,
            0.5,
            2.0 / 3.0,
            0.75,
            0.75,
            0.75,
            0.5,
        ],
    );
}

#[test]
fn a_hypothesis_counts_from_a_hundred_valid_pixels_on() {
    let small = scored(&[(99, 1, 20), (1, 0, 20), (50, 1, 0)]).unwrap();
    assert_eq!(small.n_hypotheses, 0);
    assert_near(
        &small,
        [0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    );
    let enough = scored(&[(100, 1, 20)]).unwrap();
    assert_eq!((enough.n_hypotheses, enough.f50), (1, 1.0));
}

#[test]
fn labels_below_ten_are_background() {
    assert_eq!(scored(&[(500, 1, 9), (500, 1, 0)]), None);
    assert_eq!(scored(&[(1, 0, 10)]).unwrap().n_objects, 1);
}

#[test]
fn means_weigh_scenes_equally_and_counts_add_up() {
    let scores = [
        scored(&[(200, 1, 20)]).unwrap(),
        scored(&[(10, 0, 20), (10, 0, 30)]).unwrap(),
    ];
    let mean = SegmentationScore::mean(&scores).unwrap();
    assert_eq!((mean.n_objects, mean.n_hypotheses), (3, 1));
    assert_eq!((mean.wov, mean.p50, mean.fos), (0.5, 1.0, 0.5));
    assert_eq!(SegmentationScore::mean(&[]), None);
}

#[test]
#[should_panic(expected = "the same image")]
fn images_of_different_size_are_refused() {
    Overlaps::count(&[0, 1], &[0]);
}

/// Brute-force reference: greatest sum of F-measures of the objects from `object` on.
fn brute_force_best_sum(overlaps: &Overlaps, object: usize, used: u32) -> f64 {
    if object == overlaps.labels().len() {
        return 0.0;
    }
    let free = (0..overlaps.numbers().len()).filter(|h| used & (1 << h) == 0);
    let with = free.map(|h| {
        overlaps.f_measure(object, h) + brute_force_best_sum(overlaps, object + 1, used | 1 << h)
    });
    with.fold(brute_force_best_sum(overlaps, object + 1, used), f64::max)
}

/// Few labels and hypotheses, in runs long enough to be scored.
fn runs() -> impl Strategy<Value = Vec<(usize, u16, u16)>> {
    let label = prop::sample::select(vec![0_u16, 1, 20, 30, 31, 40, 50]);
    prop::collection::vec((1..300_usize, 0..6_u16, label), 1..25)
}

/// One-to-one renumbering of labels that keeps 0.
fn renamed(values: &[u16]) -> Vec<u16> {
    values
        .iter()
        .map(|&value| if value == 0 { 0 } else { 1000 - 7 * value })
        .collect()
}

proptest! {
    #[test]
    fn matching_maximises_the_sum_of_f_measures(runs in runs()) {
        let (hypotheses, labels) = image(&runs);
        let overlaps = Overlaps::count(&hypotheses, &labels);
        let matches = overlaps.matches();
        let mut used: Vec<usize> = matches.iter().flatten().copied().collect();
        let n_used = used.len();
        used.sort_unstable();
        used.dedup();
        prop_assert_eq!(used.len(), n_used);
        let pairs = matches.iter().enumerate().filter_map(|(object, h)| Some((object, (*h)?)));
        let sum: f64 = pairs.map(|(object, h)| overlaps.f_measure(object, h)).sum();
        prop_assert!((sum - brute_force_best_sum(&overlaps, 0, 0)).abs() < 1e-9);
    }

    #[test]
    fn score_is_invariant_to_renumbering(runs in runs(), turn in 0..1000_usize) {
        let (mut hypotheses, mut labels) = image(&runs);
        let before = score(&Overlaps::count(&hypotheses, &labels));
        // The order of pixels does not matter either.
        let turn = turn % labels.len();
        hypotheses.rotate_left(turn);
        labels.rotate_left(turn);
        // Objects of the same size may be matched differently but equally well.
        let after = score(&Overlaps::count(&renamed(&hypotheses), &labels));
        prop_assert_eq!(before.is_some(), after.is_some());
        if let (Some(before), Some(after)) = (before, after) {
            for (name, (a, b)) in MEASURE_NAMES.iter().zip(before.values().into_iter().zip(after.values())).take(3) {
                prop_assert!((a - b).abs() < 1e-9, "{}: {} and {}", name, a, b);
            }
            prop_assert_eq!((before.p50, before.r50, before.f50), (after.p50, after.r50, after.f50));
        }
    }

    #[test]
    fn ground_truth_has_a_perfect_score(sizes in prop::collection::vec(100..400_usize, 1..8)) {
        let mut runs: Vec<_> = (2..).zip(&sizes).map(|(k, &n)| (n, 900 - k, 10 * k)).collect();
        runs.push((321, 0, 1));
        let found = scored(&runs).unwrap();
        assert_near(&found, [1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn every_measure_but_fus_lies_from_zero_to_one(runs in runs()) {
        if let Some(found) = scored(&runs) {
            for (name, value) in MEASURE_NAMES.iter().zip(found.values()) {
                prop_assert!(value >= 0.0 && (value <= 1.0 + 1e-12 || *name == "fus"), "{} is {}", name, value);
            }
        }
    }
}
