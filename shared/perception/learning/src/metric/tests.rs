use super::quotients::BHATTACHARYYA_COEFFICIENT_MIN;
use super::sums::{DENOMINATOR_MIN, LOGARITHM_ARGUMENT_MIN};
use super::*;
use proptest::prelude::*;

const DIRECTED: [Metric; 3] = [Metric::Pearson, Metric::Neyman, Metric::KullbackLeibler];

/// Distance between two equal descriptors.
fn minimum(metric: Metric) -> f32 {
    if metric == Metric::Motyka { 0.5 } else { 0.0 }
}

/// Upper end of the documented range for two descriptors of 675 values, with parts that
/// sum to 1 and at least 1 / `n_max` in each bin that is not empty.
fn maximum_for_good(metric: Metric, n_max: f32) -> f32 {
    match metric {
        Metric::HalfChiSquaredRoot | Metric::Hellinger => 3_f32.sqrt(),
        Metric::ChiSquared => 3.0,
        Metric::Manhattan => 6.0,
        Metric::Euclidean => 6_f32.sqrt(),
        Metric::Gower => 6.0 / 675.0,
        Metric::Canberra => 675.0,
        Metric::Divergence => 2.0 * 675.0,
        Metric::Pearson | Metric::Neyman => 3.0 * n_max,
        Metric::KullbackLeibler | Metric::SymmetricKullbackLeibler => 41.5,
        Metric::Bhattacharyya => 20.73,
        Metric::Motyka
        | Metric::Sorensen
        | Metric::Dice
        | Metric::Cosine
        | Metric::Intersection => 1.0,
    }
}

fn reference_sum(a: &[f32], b: &[f32], term: impl Fn(f64, f64) -> f64) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(&p, &q)| term(p.into(), q.into())).sum()
}

/// Reference implementation in double precision.
fn reference(metric: Metric, a: &[f32], b: &[f32]) -> f64 {
    let relative = |p: f64, q: f64| (p - q).abs() / (p + q).max(f32::MIN_POSITIVE.into());
    let chi_squared = |p: f64, q: f64| (p - q).abs() * relative(p, q);
    let pearson = |p: f64, q: f64| {
        if q < DENOMINATOR_MIN.into() {
            0.0
        } else {
            (p - q).powi(2) / q
        }
    };
    let at_least = |value: f64| value.max(LOGARITHM_ARGUMENT_MIN.into());
    let kullback_leibler = |p: f64, q: f64| {
        let (p, q) = (at_least(p), at_least(q));
        p * (p / q).ln() - p + q
    };
    let sum = |term: &dyn Fn(f64, f64) -> f64| reference_sum(a, b, term);
    let manhattan = sum(&|p, q| (p - q).abs());
    match metric {
        Metric::HalfChiSquaredRoot => (0.5 * sum(&chi_squared)).sqrt(),
        Metric::ChiSquared => 0.5 * sum(&chi_squared),
        Metric::Manhattan => manhattan,
        Metric::Euclidean => sum(&|p, q| (p - q).powi(2)).sqrt(),
        Metric::Gower => manhattan / (a.len().max(1) as f64),
        Metric::Canberra => sum(&relative),
        Metric::Divergence => 2.0 * sum(&|p, q| relative(p, q).powi(2)),
        Metric::Pearson => sum(&pearson),
        Metric::Neyman => sum(&|p, q| pearson(q, p)),
        Metric::Hellinger => (0.5 * sum(&|p, q| (p.sqrt() - q.sqrt()).powi(2))).sqrt(),
        Metric::KullbackLeibler => sum(&kullback_leibler),
        Metric::SymmetricKullbackLeibler => {
            0.5 * sum(&|p, q| kullback_leibler(p, q) + kullback_leibler(q, p))
        }
        _ => reference_quotient(metric, a, b),
    }
}

/// Reference implementation of quotients in double precision; squares that underflow in
/// single precision are 0.
fn reference_quotient(metric: Metric, a: &[f32], b: &[f32]) -> f64 {
    let over = |numerator: f64, denominator: f64, if_empty: f64| {
        if denominator > 0.0 {
            numerator / denominator
        } else {
            if_empty
        }
    };
    let product = |p: f64, q: f64| f64::from((p * q) as f32);
    let sum = |term: &dyn Fn(f64, f64) -> f64| reference_sum(a, b, term);
    let squares = (sum(&|p, _| product(p, p)), sum(&|_, q| product(q, q)));
    let masses = (sum(&|p, _| p), sum(&|_, q| q));
    let both = masses.0 + masses.1;
    match metric {
        Metric::Motyka => over(sum(&f64::max), both, 0.5),
        Metric::Sorensen => over(sum(&|p, q| (p - q).abs()), both, 0.0),
        Metric::Dice => {
            let difference = sum(&|p, q| product(p - q, p - q));
            over(difference, squares.0 + squares.1, 0.0)
        }
        Metric::Cosine if squares == (0.0, 0.0) => 0.0,
        Metric::Cosine => 1.0 - over(sum(&product), (squares.0 * squares.1).sqrt(), 0.0),
        Metric::Intersection => 1.0 - over(sum(&f64::min), masses.0.max(masses.1), 1.0),
        Metric::Bhattacharyya if both == 0.0 => 0.0,
        Metric::Bhattacharyya => {
            let common = sum(&|p, q| (p * q).sqrt());
            let coefficient = over(common, (masses.0 * masses.1).sqrt(), 0.0);
            -coefficient.clamp(BHATTACHARYYA_COEFFICIENT_MIN, 1.0).ln()
        }
        _ => f64::NAN,
    }
}

/// Rounding tolerance: relative to the distance, and for differences of large numbers
/// relative to these.
fn tolerance(metric: Metric, a: &[f32], b: &[f32], expected: f64) -> f64 {
    let absolute = match metric {
        Metric::Cosine | Metric::Intersection | Metric::Bhattacharyya => 1e-5,
        Metric::KullbackLeibler => 1e-5 * a.iter().chain(b).map(|&v| f64::from(v)).sum::<f64>(),
        _ => 1e-12,
    };
    1e-4 * expected + absolute
}

fn histogram(n: usize) -> impl Strategy<Value = Vec<f32>> {
    let value = prop_oneof![
        Just(0.0_f32),
        0.0_f32..1.0,
        0.0_f32..MAX_VALUE,
        Just(1e-40),
        Just(MAX_VALUE)
    ];
    let values = prop::collection::vec(value, n);
    prop_oneof![8 => values, 1 => Just(vec![0.0; n])]
}

/// Three parts of 225 bins, each with some points.
fn good() -> impl Strategy<Value = Vec<f32>> {
    let part = prop::collection::vec(0_usize..225, N_POINTS);
    prop::array::uniform3(part).prop_map(|parts| {
        let mut values = vec![0.0; 675];
        for (i, bins) in parts.iter().enumerate() {
            for bin in bins {
                values[225 * i + bin] += 1.0 / N_POINTS as f32;
            }
        }
        values
    })
}

const N_POINTS: usize = 64;

proptest! {
    #[test]
    fn distances_match_the_reference_implementation(
        (a, b) in (0_usize..300).prop_flat_map(|n| (histogram(n), histogram(n))),
    ) {
        for metric in Metric::ALL {
            let (distance, expected) = (metric.distance(&a, &b).unwrap(), reference(metric, &a, &b));
            let difference = (f64::from(distance) - expected).abs();
            prop_assert!(
                difference <= tolerance(metric, &a, &b, expected),
                "{} {} {}", metric, distance, expected,
            );
        }
    }

    #[test]
    fn distances_are_finite_symmetric_and_least_for_equal_ones(
        (a, b) in (0_usize..300).prop_flat_map(|n| (histogram(n), histogram(n))),
    ) {
        for metric in Metric::ALL {
            let distance = metric.distance(&a, &b).unwrap();
            prop_assert!(distance.is_finite() && distance >= minimum(metric), "{} {}", metric, distance);
            prop_assert_eq!(metric.distance(&a, &a).unwrap(), minimum(metric), "{}", metric);
            if !DIRECTED.contains(&metric) {
                prop_assert_eq!(metric.distance(&b, &a).unwrap(), distance, "{}", metric);
            }
        }
        let (pearson, neyman) = (Metric::Pearson.distance(&a, &b), Metric::Neyman.distance(&b, &a));
        prop_assert_eq!(pearson.unwrap(), neyman.unwrap());
    }

    #[test]
    fn descriptors_are_within_the_documented_ranges(a in good(), b in good()) {
        for metric in Metric::ALL {
            let distance = metric.distance(&a, &b).unwrap();
            let most = maximum_for_good(metric, N_POINTS as f32) * (1.0 + 1e-5);
            prop_assert!((minimum(metric)..=most).contains(&distance), "{} {}", metric, distance);
        }
    }

    #[test]
    fn early_termination_changes_no_score(a in histogram(400), b in histogram(400), share in 0.0_f32..2.0) {
        for metric in Metric::ALL {
            let score = metric.bounded_score(&a, &b, f32::INFINITY).unwrap();
            let bound = share * score;
            let expected = (score <= bound).then_some(score);
            prop_assert_eq!(metric.bounded_score(&a, &b, bound), expected, "{}", metric);
            prop_assert_eq!(metric.bounded_score(&a, &b, score), Some(score), "{}", metric);
        }
    }
}

#[test]
fn disjoint_descriptors_have_the_largest_distance() {
    // Three parts, each with a sum of one, without a common bin.
    let (mut a, mut b) = (vec![0.0; 675], vec![0.0; 675]);
    for part in 0..3 {
        a[225 * part] = 1.0;
        b[225 * part + 224] = 1.0;
    }
    for metric in Metric::ALL {
        let expected = match metric {
            // These count bins: three of each descriptor.
            Metric::Canberra => 6.0,
            Metric::Divergence => 12.0,
            // Each ignores the bins of one descriptor.
            Metric::Pearson | Metric::Neyman => 3.0,
            _ => maximum_for_good(metric, 1.0),
        };
        let distance = metric.distance(&a, &b).unwrap();
        // The limits of the logarithms are documented with three digits.
        let digits = if expected > 20.0 { 3e-3 } else { 1e-6 };
        assert!(
            (distance - expected).abs() <= digits * expected,
            "{metric} {distance}"
        );
    }
}

#[test]
fn an_empty_histogram_is_equal_only_to_itself() {
    let (empty, full) = ([0.0; 8], [0.125; 8]);
    for metric in Metric::ALL {
        let to_itself = metric.distance(&empty, &empty).unwrap();
        assert_eq!(to_itself, minimum(metric), "{metric}");
        let ways = [(&empty, &full), (&full, &empty)];
        let distances = ways.map(|(a, b)| metric.distance(a, b).unwrap());
        // Pearson's ignores bins empty in the second, Neyman's those empty in the first.
        let expected_zero = match metric {
            Metric::Neyman => [true, false],
            Metric::Pearson => [false, true],
            _ => [false; 2],
        };
        assert_eq!(
            distances.map(|d| d <= minimum(metric)),
            expected_zero,
            "{metric}"
        );
    }
}

#[test]
fn different_lengths_are_rejected() {
    for metric in Metric::ALL {
        let error = metric.distance(&[0.0; 75], &[0.0; 675]).unwrap_err();
        let sentence = error.to_string();
        assert!(
            sentence.contains("75 values") && sentence.contains("of 675"),
            "{sentence}"
        );
    }
}
