//! Dissimilarities of histograms.

mod name;
mod quotients;
mod sums;

use crate::Error;
pub use name::UnknownMetric;
use sums::bounded_sum;

/// Largest magnitude of a value; no sum of differences overflows below it.
pub(crate) const MAX_VALUE: f32 = 1e6;

/// How dissimilar two descriptors are: a finite number, at least 0, for all values
/// from 0 to 1e6, those of empty histograms included. Metrics of differences alone,
/// [`Manhattan`](Self::Manhattan), [`Euclidean`](Self::Euclidean) and
/// [`Gower`](Self::Gower), take negative values, too, from -1e6.
///
/// It is 0 for equal descriptors, but 0.5 for [`Motyka`](Self::Motyka), and
/// symmetric, but for [`Pearson`](Self::Pearson), [`Neyman`](Self::Neyman) and
/// [`KullbackLeibler`](Self::KullbackLeibler). In the formulas p is a value of the
/// first descriptor, the one that is asked for, and q that of the second, the taught
/// one. A range for GOOD is that of two descriptors whose three parts sum to 1.
///
/// *Source*: Cha, "Comprehensive survey on distance/similarity measures between
/// probability density functions", 2007, and the program of GOOD's authors, without
/// its defects; each is told where the formula stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Metric {
    /// `sqrt(½ Σ (p - q)² / (p + q))`, bins empty in both left out; 0 to `sqrt(3)`
    /// for GOOD. The threshold of 0.75 in the paper fits this scale.
    #[default]
    HalfChiSquaredRoot,
    /// `½ Σ (p - q)² / (p + q)`, bins empty in both left out; 0 to 3 for GOOD.
    ChiSquared,
    /// `Σ |p - q|`; 0 to 6 for GOOD.
    Manhattan,
    /// `sqrt(Σ (p - q)²)`; 0 to `sqrt(6)` for GOOD. The authors' program computes
    /// Manhattan when asked for it.
    Euclidean,
    /// `Σ |p - q| / D` for D values; 0 to 6 / D for GOOD.
    Gower,
    /// `Σ |p - q| / (p + q)`, bins empty in both left out; 0 to D for D values.
    Canberra,
    /// `2 Σ (p - q)² / (p + q)²`, bins empty in both left out; 0 to 2 D for D
    /// values. The authors' program divides by 0 at such bins.
    Divergence,
    /// `Σ (p - q)² / q`, bins with q below 1e-12 left out; from 0, and for GOOD to
    /// 3 `n_max`, where a bin holds at least 1 / `n_max`. Not symmetric.
    Pearson,
    /// `Σ (p - q)² / p`, bins with p below 1e-12 left out: Pearson's with the
    /// descriptors exchanged.
    Neyman,
    /// `sqrt(½ Σ (sqrt(p) - sqrt(q))²)`; 0 to `sqrt(3)` for GOOD.
    Hellinger,
    /// `Σ p ln(p / q) - p + q`, values below 1e-6 taken for 1e-6; 0 to 41.5 for
    /// GOOD. Not symmetric. For equal sums it is Kullback and Leibler's divergence,
    /// and it is never negative for others. The authors' program leaves out bins
    /// empty in either, so that histograms with nothing in common are equal, and
    /// takes the logarithm to base 10.
    KullbackLeibler,
    /// `½ Σ (p - q) ln(p / q)`, values below 1e-6 taken for 1e-6; 0 to 41.5 for
    /// GOOD. The mean of both directions; the authors' program as above.
    SymmetricKullbackLeibler,
    /// `Σ max(p, q) / Σ (p + q)`; 0.5 for equal descriptors, two empty ones
    /// included, to 1.
    Motyka,
    /// `Σ |p - q| / Σ (p + q)`, 0 if both are empty; 0 to 1.
    Sorensen,
    /// `Σ (p - q)² / (Σ p² + Σ q²)`, 0 if both are empty; 0 to 1.
    Dice,
    /// `1 - Σ p q / sqrt(Σ p² Σ q²)`; 0 to 1, which is also the distance to an empty
    /// one. The authors' program leaves out the norms, so that equal descriptors are
    /// not at 0.
    Cosine,
    /// `1 - Σ min(p, q) / max(Σ p, Σ q)`, 0 if both are empty; 0 to 1. The authors'
    /// program takes `Σ min(p, q)`, which is large for similar ones, for a distance.
    Intersection,
    /// `-ln(Σ sqrt(p q) / sqrt(Σ p Σ q))`, the argument at least 1e-9; 0 to 20.73,
    /// which is also the distance to an empty one. The authors' program leaves out
    /// the sums, so that equal descriptors of GOOD are at -1.1 and such with nothing
    /// in common are infinitely far.
    Bhattacharyya,
}

impl Metric {
    /// All metrics, in the order of the documentation.
    pub const ALL: [Self; 18] = [
        Self::HalfChiSquaredRoot,
        Self::ChiSquared,
        Self::Manhattan,
        Self::Euclidean,
        Self::Gower,
        Self::Canberra,
        Self::Divergence,
        Self::Pearson,
        Self::Neyman,
        Self::Hellinger,
        Self::KullbackLeibler,
        Self::SymmetricKullbackLeibler,
        Self::Motyka,
        Self::Sorensen,
        Self::Dice,
        Self::Cosine,
        Self::Intersection,
        Self::Bhattacharyya,
    ];

    /// The distance of two descriptors.
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
        let score = self.bounded_score(a, b, f32::INFINITY);
        Ok(self.distance_from_score(score.unwrap_or(f32::INFINITY), a.len()))
    }

    /// The values that a descriptor may have.
    pub(crate) fn values(self) -> std::ops::RangeInclusive<f32> {
        match self {
            Self::Manhattan | Self::Euclidean | Self::Gower => -MAX_VALUE..=MAX_VALUE,
            _ => 0.0..=MAX_VALUE,
        }
    }

    /// Whether a descriptor is one of `dimension` values that the metric takes.
    pub(crate) fn check(self, descriptor: &[f32], dimension: usize) -> Result<(), Error> {
        if descriptor.len() != dimension {
            return Err(Error::Dimension {
                expected: dimension,
                found: descriptor.len(),
            });
        }
        let values = self.values();
        let is_wrong = |value: &f32| !values.contains(value);
        match descriptor.iter().position(is_wrong) {
            Some(position) => Err(Error::Value {
                position,
                value: descriptor[position],
                metric: self,
            }),
            None => Ok(()),
        }
    }

    /// A number that orders pairs as their distances do and needs no root; `None`
    /// when it is larger than `bound`.
    ///
    /// *Complexity*: a sum ends where it exceeds the bound; a quotient of sums can
    /// shrink until its last bin, so it is computed to the end.
    pub(crate) fn bounded_score(self, a: &[f32], b: &[f32], bound: f32) -> Option<f32> {
        let quotient = |score: f32| (score <= bound).then_some(score);
        match self {
            Self::HalfChiSquaredRoot | Self::ChiSquared => {
                bounded_sum(a, b, bound, sums::chi_squared)
            }
            Self::Manhattan | Self::Gower => bounded_sum(a, b, bound, sums::absolute_difference),
            Self::Euclidean => bounded_sum(a, b, bound, sums::squared_difference),
            Self::Canberra => bounded_sum(a, b, bound, sums::relative_difference),
            Self::Divergence => bounded_sum(a, b, bound, sums::squared_relative_difference),
            Self::Pearson => bounded_sum(a, b, bound, sums::pearson),
            Self::Neyman => bounded_sum(a, b, bound, |p, q| sums::pearson(q, p)),
            Self::Hellinger => bounded_sum(a, b, bound, sums::squared_difference_of_roots),
            Self::KullbackLeibler => bounded_sum(a, b, bound, sums::kullback_leibler),
            Self::SymmetricKullbackLeibler => bounded_sum(a, b, bound, sums::jeffreys),
            Self::Motyka => quotient(quotients::motyka(a, b)),
            Self::Sorensen => quotient(quotients::sorensen(a, b)),
            Self::Dice => quotient(quotients::dice(a, b)),
            Self::Cosine => quotient(quotients::cosine(a, b)),
            Self::Intersection => quotient(quotients::intersection(a, b)),
            Self::Bhattacharyya => quotient(quotients::bhattacharyya(a, b)),
        }
    }

    /// The distance that belongs to a score of descriptors of `dimension` values.
    pub(crate) fn distance_from_score(self, score: f32, dimension: usize) -> f32 {
        match self {
            Self::HalfChiSquaredRoot | Self::Hellinger => (0.5 * score).sqrt(),
            Self::ChiSquared | Self::SymmetricKullbackLeibler => 0.5 * score,
            Self::Euclidean => score.sqrt(),
            Self::Gower => score / dimension.max(1) as f32,
            Self::Divergence => 2.0 * score,
            Self::Manhattan
            | Self::Canberra
            | Self::Pearson
            | Self::Neyman
            | Self::KullbackLeibler
            | Self::Motyka
            | Self::Sorensen
            | Self::Dice
            | Self::Cosine
            | Self::Intersection
            | Self::Bhattacharyya => score,
        }
    }
}

#[cfg(test)]
mod tests;
