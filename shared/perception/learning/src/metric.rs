//! Dissimilarity measures of histograms and descriptors.

mod name;
mod quotients;
mod sums;

use crate::Error;
pub use name::UnknownMetric;
use sums::bounded_sum;

/// Largest magnitude of a descriptor value; below it no sum of differences overflows.
pub(crate) const MAX_VALUE: f32 = 1e6;

coded_enum::coded_enum! {
    /// Dissimilarity measure of two descriptors: finite and at least 0 for all values from 0
    /// to 1e6, including empty histograms. [`Manhattan`](Self::Manhattan),
    /// [`Euclidean`](Self::Euclidean) and [`Gower`](Self::Gower), which use differences
    /// only, also accept negative values, down to -1e6.
    ///
    /// Equal descriptors have dissimilarity 0, except 0.5 for [`Motyka`](Self::Motyka). All
    /// measures are symmetric, except [`Pearson`](Self::Pearson), [`Neyman`](Self::Neyman)
    /// and [`KullbackLeibler`](Self::KullbackLeibler). In the formulas p is a value of the
    /// query and q one of the stored descriptor. The range given for GOOD is that of two
    /// descriptors whose three parts sum to 1.
    ///
    /// *Source*: Cha, "Comprehensive survey on distance/similarity measures between
    /// probability density functions", 2007, and the program of GOOD's authors. Deviations
    /// from that program, which correct its defects, are stated at the formulas.
    #[derive(Hash, Default)]
    pub enum Metric {
        /// Square root of half the chi-squared distance, `sqrt(½ Σ (p - q)² / (p + q))`,
        /// without bins empty in both; 0 to `sqrt(3)` for GOOD. The threshold of 0.75 in the
        /// paper fits this scale.
        #[default]
        HalfChiSquaredRoot, "half-chi-squared-root";
        /// Half the chi-squared distance, `½ Σ (p - q)² / (p + q)`, without bins empty in
        /// both; 0 to 3 for GOOD.
        ChiSquared, "chi-squared";
        /// Manhattan distance, `Σ |p - q|`; 0 to 6 for GOOD.
        Manhattan, "manhattan";
        /// Euclidean distance, `sqrt(Σ (p - q)²)`; 0 to `sqrt(6)` for GOOD. The authors'
        /// program computes Manhattan instead.
        Euclidean, "euclidean";
        /// Gower distance, `Σ |p - q| / D` for D values; 0 to 6 / D for GOOD.
        Gower, "gower";
        /// Canberra distance, `Σ |p - q| / (p + q)`, without bins empty in both; 0 to D for
        /// D values.
        Canberra, "canberra";
        /// Divergence distance, `2 Σ (p - q)² / (p + q)²`, without bins empty in both; 0 to
        /// 2 D for D values. The authors' program divides by 0 at such bins.
        Divergence, "divergence";
        /// Pearson chi-squared divergence, `Σ (p - q)² / q`, without bins with q below
        /// 1e-12; 0 to 3 `n_max` for GOOD, if a bin holds at least 1 / `n_max`. Not
        /// symmetric.
        Pearson, "pearson";
        /// Neyman chi-squared divergence, `Σ (p - q)² / p`, without bins with p below 1e-12:
        /// Pearson's with the descriptors exchanged. Not symmetric.
        Neyman, "neyman";
        /// Hellinger distance, `sqrt(½ Σ (sqrt(p) - sqrt(q))²)`; 0 to `sqrt(3)` for GOOD.
        Hellinger, "hellinger";
        /// Kullback-Leibler divergence, `Σ p ln(p / q) - p + q`, with values clamped to at
        /// least 1e-6; 0 to 41.5 for GOOD. Not symmetric. The added terms vanish for equal
        /// sums and keep it non-negative for others. The authors' program skips bins empty
        /// in either, so that disjoint histograms are equal, and uses the logarithm to base
        /// 10.
        KullbackLeibler, "kl";
        /// Symmetric Kullback-Leibler divergence, `½ Σ (p - q) ln(p / q)`, the mean of both
        /// directions, with values clamped to at least 1e-6; 0 to 41.5 for GOOD. The
        /// authors' program deviates as for [`KullbackLeibler`](Self::KullbackLeibler).
        SymmetricKullbackLeibler, "symmetric-kl";
        /// Motyka distance, `Σ max(p, q) / Σ (p + q)`; 0.5 for equal descriptors, including
        /// two empty ones, to 1.
        Motyka, "motyka";
        /// Sørensen distance, `Σ |p - q| / Σ (p + q)`, 0 if both are empty; 0 to 1.
        Sorensen, "sorensen";
        /// Dice distance, `Σ (p - q)² / (Σ p² + Σ q²)`, 0 if both are empty; 0 to 1.
        Dice, "dice";
        /// Cosine distance, `1 - Σ p q / sqrt(Σ p² Σ q²)`; 0 to 1, and 1 to an empty
        /// descriptor. The authors' program omits the norms, so that equal descriptors are
        /// not at 0.
        Cosine, "cosine";
        /// Histogram intersection distance, `1 - Σ min(p, q) / max(Σ p, Σ q)`, 0 if both are
        /// empty; 0 to 1. The authors' program uses the similarity `Σ min(p, q)` as a
        /// distance.
        Intersection, "intersection";
        /// Bhattacharyya distance, `-ln(Σ sqrt(p q) / sqrt(Σ p Σ q))`, with the argument
        /// clamped to at least 1e-9; 0 to 20.73, which is also the distance to an empty
        /// descriptor. The authors' program omits the sums, so that equal descriptors of
        /// GOOD are at -1.1 and disjoint ones at infinity.
        Bhattacharyya, "bhattacharyya";
    }
}

impl Metric {
    /// Dissimilarity of a query `a` and a stored descriptor `b`.
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

    /// Domain (valid range) of descriptor values under the metric.
    pub(crate) fn values(self) -> std::ops::RangeInclusive<f32> {
        match self {
            Self::Manhattan | Self::Euclidean | Self::Gower => -MAX_VALUE..=MAX_VALUE,
            _ => 0.0..=MAX_VALUE,
        }
    }

    /// Checks the length of a descriptor and the domain of its values.
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

    /// Score ordered like the distance but without its final root or factor; `None` when
    /// it exceeds `bound`.
    ///
    /// *Complexity*: a sum terminates when it exceeds the bound; a quotient of sums may
    /// shrink until its last bin, so it is computed completely.
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

    /// Distance of a score for descriptors of `dimension` values.
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
