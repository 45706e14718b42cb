//! Dissimilarities of histograms.

use crate::Error;

/// Largest value of a descriptor; no sum of differences overflows below it.
pub(crate) const MAX_VALUE: f32 = 1e6;

/// Independent sums, for vector instructions. They are added up in the same way
/// always, so a distance does not depend on whether it was bounded.
const LANES: usize = 16;

/// Values after which the sum is compared with the bound.
const BLOCK: usize = 8 * LANES;

/// How dissimilar two descriptors are; 0 for equal ones, symmetric.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Metric {
    /// `sqrt(½ Σ (p - q)² / (p + q))`, bins empty in both left out; 0 to `sqrt(3)`
    /// for GOOD. The threshold of 0.75 in the paper fits this scale.
    #[default]
    HalfChiSquaredRoot,
    /// `Σ |p - q|`; 0 to 6 for GOOD.
    Manhattan,
}

impl Metric {
    /// The distance of two descriptors with values from 0 to 1e6.
    ///
    /// # Errors
    /// When they differ in length.
    pub fn distance(self, a: &[f32], b: &[f32]) -> Result<f32, Error> {
        if a.len() != b.len() {
            return Err(Error::Dimension {
                expected: b.len(),
                found: a.len(),
            });
        }
        Ok(self.distance_from_sum(self.sum(a, b, f32::INFINITY).unwrap_or(f32::INFINITY)))
    }

    /// The sum over all bins, which orders pairs as their distances do; `None` when
    /// it is larger than `bound`. Exact: terms are never negative and rounding never
    /// makes a sum smaller, so a partial sum above the bound decides.
    pub(crate) fn sum(self, a: &[f32], b: &[f32], bound: f32) -> Option<f32> {
        match self {
            Self::HalfChiSquaredRoot => bounded_sum(a, b, bound, chi_squared_term),
            Self::Manhattan => bounded_sum(a, b, bound, |p, q| (p - q).abs()),
        }
    }

    /// The distance that belongs to a sum.
    pub(crate) fn distance_from_sum(self, sum: f32) -> f32 {
        match self {
            Self::HalfChiSquaredRoot => (0.5 * sum).sqrt(),
            Self::Manhattan => sum,
        }
    }
}

/// One bin's term. A bin empty in both gives 0 divided by a positive number.
#[inline]
fn chi_squared_term(p: f32, q: f32) -> f32 {
    let difference = p - q;
    let both = p + q;
    difference * difference
        / if both > f32::MIN_POSITIVE {
            both
        } else {
            f32::MIN_POSITIVE
        }
}

#[inline]
fn bounded_sum(
    a: &[f32],
    b: &[f32],
    bound: f32,
    term: impl Fn(f32, f32) -> f32 + Copy,
) -> Option<f32> {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.chunks(BLOCK).zip(b.chunks(BLOCK)) {
        add_block(&mut lanes, a, b, term);
        if total(&lanes) > bound {
            return None;
        }
    }
    Some(total(&lanes))
}

#[inline]
fn add_block(lanes: &mut [f32; LANES], a: &[f32], b: &[f32], term: impl Fn(f32, f32) -> f32) {
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            lanes[i] += term(a[i], b[i]);
        }
    }
    for (lane, (&p, &q)) in lanes.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *lane += term(p, q);
    }
}

/// Sum of the lanes, halving their number at each step.
#[inline]
fn total(lanes: &[f32; LANES]) -> f32 {
    let mut lanes = *lanes;
    let mut n = LANES;
    while n > 1 {
        n /= 2;
        for i in 0..n {
            lanes[i] += lanes[i + n];
        }
    }
    lanes[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const METRICS: [Metric; 2] = [Metric::HalfChiSquaredRoot, Metric::Manhattan];

    /// The definition, in double precision.
    fn defined(metric: Metric, a: &[f32], b: &[f32]) -> f64 {
        let pairs = a.iter().zip(b).map(|(&p, &q)| (f64::from(p), f64::from(q)));
        match metric {
            Metric::Manhattan => pairs.map(|(p, q)| (p - q).abs()).sum(),
            Metric::HalfChiSquaredRoot => {
                let terms = pairs.filter(|(p, q)| p + q > 0.0);
                (0.5 * terms.map(|(p, q)| (p - q).powi(2) / (p + q)).sum::<f64>()).sqrt()
            }
        }
    }

    fn histogram(max: usize) -> impl Strategy<Value = Vec<f32>> {
        let value = prop_oneof![Just(0.0_f32), 0.0_f32..1.0, 0.0_f32..MAX_VALUE, Just(1e-40)];
        prop::collection::vec(value, max)
    }

    proptest! {
        #[test]
        fn distances_are_as_defined(
            (a, b) in (0_usize..300).prop_flat_map(|n| (histogram(n), histogram(n))),
        ) {
            for metric in METRICS {
                let (distance, expected) = (metric.distance(&a, &b).unwrap(), defined(metric, &a, &b));
                prop_assert!((f64::from(distance) - expected).abs() <= 1e-4 * expected + 1e-12);
                prop_assert_eq!(metric.distance(&b, &a).unwrap(), distance);
                prop_assert_eq!(metric.distance(&a, &a).unwrap(), 0.0);
            }
        }

        #[test]
        fn a_bound_changes_no_sum(a in histogram(400), b in histogram(400), share in 0.0_f32..2.0) {
            for metric in METRICS {
                let sum = metric.sum(&a, &b, f32::INFINITY).unwrap();
                let bound = share * sum;
                prop_assert_eq!(metric.sum(&a, &b, bound), (sum <= bound).then_some(sum));
                prop_assert_eq!(metric.sum(&a, &b, sum), Some(sum));
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
        assert_eq!(
            Metric::HalfChiSquaredRoot.distance(&a, &b),
            Ok(3_f32.sqrt())
        );
        assert_eq!(Metric::Manhattan.distance(&a, &b), Ok(6.0));
    }

    #[test]
    fn other_lengths_are_refused_by_a_sentence() {
        let error = Metric::Manhattan
            .distance(&[0.0; 75], &[0.0; 675])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("75 values") && error.contains("of 675"),
            "{error}"
        );
    }
}
