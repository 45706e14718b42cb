//! Probability calibration of category scores, with a reject class.

/// Multinomial logistic calibration from category scores to probabilities. The reject
/// class "unknown" competes with the categories; its logit grows with the distance to the
/// best category.
///
/// Categories differ in variability: a distance that is large in one is small in
/// another. Distances are therefore divided by the spread of the category, the mean
/// distance from its views to their nearest neighbours within it. The spread of a
/// category with few views is shrunk towards the mean over all categories, and that mean
/// towards a prior.
#[derive(Debug, Clone, Copy)]
pub struct Calibration {
    /// Symmetries over which views are compared, in the space of the learned metric.
    pub symmetries: DescriptorSymmetries,
    /// Map into the space of the learned metric; `None` to compare descriptors as they are.
    pub learned_metric: Option<DescriptorMap>,
    /// Distance at which the kernel of the local ridge regression falls to 1/e.
    pub kernel_width: f32,
    /// Ridge of the local ridge regression.
    pub ridge: f32,
    /// Distance of unrelated objects: that of the imaginary views of a background class, which
    /// stand for all that was not taught.
    pub background_distance: f32,
    /// Prior of the spread of a category.
    pub spread_prior: f32,
    /// Logit of a category for a score of one.
    pub score_weight: MemoryTerm,
    /// Logit of "unknown" at a distance of one spread, with the initial prior of novelty.
    pub unknown_bias: MemoryTerm,
    /// Growth of that logit with the logarithm of the distance.
    pub unknown_slope: f32,
}

/// Parameter that depends on how much is stored: a small score means more in a memory with few
/// views.
#[derive(Debug, Clone, Copy)]
pub struct MemoryTerm {
    /// Value for a memory of one view.
    pub of_one_view: f32,
    /// Growth with the logarithm of the number of views of the best category.
    pub per_log_view: f32,
    /// Growth with the logarithm of the number of categories.
    pub per_log_category: f32,
}

/// Numbers of views of the best category and of categories in a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MemorySize {
    pub(crate) n_views: usize,
    pub(crate) n_categories: usize,
}

/// Size of a memory above which parameters stay as they are. Chosen: the largest of the fit.
const LARGEST: MemorySize = MemorySize {
    n_views: 256,
    n_categories: 64,
};

impl MemoryTerm {
    /// Parameter that does not depend on what is stored.
    pub const fn constant(value: f32) -> Self {
        Self {
            of_one_view: value,
            per_log_view: 0.0,
            per_log_category: 0.0,
        }
    }

    fn at(self, size: MemorySize) -> f32 {
        let log = |n: usize, most: usize| (n.clamp(1, most) as f32).ln();
        self.of_one_view
            + self.per_log_view * log(size.n_views, LARGEST.n_views)
            + self.per_log_category * log(size.n_categories, LARGEST.n_categories)
    }
}

/// Map of descriptors into the space in which their distances are taken.
#[derive(Debug, Clone, Copy)]
pub struct DescriptorMap {
    /// Number of mapped values.
    pub dimension: usize,
    /// Writes the mapped values of a descriptor, as many as that, replacing the content.
    pub map: fn(&[f32], &mut Vec<f32>),
}

/// Symmetries of a descriptor: turns of an object that its description may have to be compared
/// in, and its mirror image. A half turn and the mirror image change signs of values only.
#[derive(Debug, Clone, Copy)]
pub struct DescriptorSymmetries {
    /// Axis hypotheses of a stored descriptor, itself the first, without those that a half turn
    /// makes of them.
    pub turns_of: fn(&[f32]) -> Vec<Vec<f32>>,
    /// Values that change their sign by a half turn. True for such a value; values beyond the end
    /// change nothing.
    pub half_turn_odd_values: fn() -> &'static [bool],
    /// Values that change their sign when the object is mirrored, likewise.
    pub mirror_odd_values: fn() -> &'static [bool],
}

impl DescriptorSymmetries {
    /// Symmetries of a descriptor that has none.
    pub const NONE: Self = Self {
        turns_of: |stored| vec![stored.to_vec()],
        half_turn_odd_values: || &[],
        mirror_odd_values: || &[],
    };

    /// All axis hypotheses of a stored descriptor.
    pub(crate) fn axis_hypotheses_of(&self, stored: &[f32]) -> Vec<Vec<f32>> {
        let is_odd = (self.half_turn_odd_values)();
        let mut hypotheses = (self.turns_of)(stored);
        if is_odd.contains(&true) {
            for turn in 0..hypotheses.len() {
                let mut turned = hypotheses[turn].clone();
                for (value, _) in turned.iter_mut().zip(is_odd).filter(|(_, odd)| **odd) {
                    *value = -*value;
                }
                hypotheses.push(turned);
            }
        }
        hypotheses
    }
}

/// Least distance in spreads, so that its logarithm is finite.
const LEAST_RELATIVE_DISTANCE: f32 = 1e-4;

/// Pseudo-count of the mean over all categories when the spread of one category is
/// estimated. Chosen.
const GLOBAL_SPREAD_WEIGHT: f64 = 3.0;

/// Pseudo-count of the prior when the mean spread over all categories is estimated.
/// Chosen.
const PRIOR_SPREAD_WEIGHT: f64 = 10.0;

/// Sum and count of nearest-neighbour distances.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DistanceSum {
    pub(crate) sum: f64,
    pub(crate) n: usize,
}

impl DistanceSum {
    /// Replaces the distances of one category within the total of all categories.
    pub(crate) fn exchange(&mut self, before: Self, after: Self) {
        self.sum += after.sum - before.sum;
        self.n = self.n + after.n - before.n;
    }

    /// Mean shrunk towards an expected value, which counts as `weight` observations.
    fn shrunken_mean(self, weight: f64, expected: f64) -> f64 {
        (self.sum + weight * expected) / (self.n as f64 + weight)
    }
}

impl Calibration {
    /// Spread of a category from its own nearest-neighbour distances and those of all
    /// categories.
    pub(crate) fn spread(&self, own: DistanceSum, all: DistanceSum) -> f32 {
        let usual = all.shrunken_mean(PRIOR_SPREAD_WEIGHT, f64::from(self.spread_prior));
        let spread = own.shrunken_mean(GLOBAL_SPREAD_WEIGHT, usual);
        spread.max(f64::from(f32::MIN_POSITIVE)) as f32
    }

    /// Probabilities of categories with `scores`, and of "unknown" given the distance to
    /// the best of them in spreads and the size of the memory, with the initial prior of novelty.
    /// They sum to one.
    pub(crate) fn probabilities<const N: usize>(
        &self,
        scores: [f32; N],
        distance_in_spreads: f32,
        size: MemorySize,
    ) -> ([f32; N], f32) {
        let relative = distance_in_spreads.max(LEAST_RELATIVE_DISTANCE);
        let bias = self.unknown_bias.at(size);
        let unknown = bias + self.unknown_slope * relative.ln();
        let score_weight = self.score_weight.at(size);
        let logits = scores.map(|score| score_weight * score);
        let largest = logits.into_iter().fold(unknown, f32::max);
        let odds = logits.map(|logit| (logit - largest).exp());
        let unknown = (unknown - largest).exp();
        let sum = unknown + odds.iter().sum::<f32>();
        (odds.map(|odds| odds / sum), unknown / sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALIBRATION: Calibration = Calibration {
        symmetries: DescriptorSymmetries::NONE,
        learned_metric: None,
        kernel_width: 2.5,
        ridge: 0.03,
        background_distance: 2.2,
        spread_prior: 0.6,
        score_weight: MemoryTerm::constant(8.0),
        unknown_bias: MemoryTerm::constant(4.0),
        unknown_slope: 2.5,
    };

    const SIZE: MemorySize = MemorySize {
        n_views: 1,
        n_categories: 1,
    };

    const NONE: DistanceSum = DistanceSum { sum: 0.0, n: 0 };

    #[test]
    fn priors_replace_missing_distances() {
        assert!((CALIBRATION.spread(NONE, NONE) - 0.6).abs() < 1e-6);
        let all = DistanceSum {
            sum: 100.0,
            n: 1000,
        };
        assert!(CALIBRATION.spread(NONE, all) < 0.2);
        let own = DistanceSum { sum: 40.0, n: 20 };
        assert!(CALIBRATION.spread(own, all) > 1.5);
    }

    #[test]
    fn probabilities_sum_to_one_and_follow_the_scores() {
        let ([first, second, none], unknown) =
            CALIBRATION.probabilities([0.8, 0.3, f32::NEG_INFINITY], 1.0, SIZE);
        assert!((first + second + unknown - 1.0).abs() < 1e-6);
        assert!(
            first > 0.8 && second < 0.1 && none == 0.0,
            "{first} {second}"
        );
    }

    #[test]
    fn a_far_object_is_unknown_and_a_taught_view_is_known() {
        let unknown = |score, distance| CALIBRATION.probabilities([score], distance, SIZE).1;
        assert!(unknown(0.2, 5.0) > 0.99);
        assert!(unknown(1.0, 0.0) < 1e-6);
        assert!(unknown(0.6, 1.0) < unknown(0.6, 1.5));
    }

    #[test]
    fn parameters_grow_with_the_logarithms_of_views_and_categories() {
        let term = MemoryTerm {
            of_one_view: 2.0,
            per_log_view: -0.5,
            per_log_category: 0.25,
        };
        let at = |n_views, n_categories| {
            term.at(MemorySize {
                n_views,
                n_categories,
            })
        };
        assert_eq!((at(0, 0), at(1, 1)), (2.0, 2.0));
        let expected = 2.0 - 0.5 * 10.0_f32.ln() + 0.25 * 3.0_f32.ln();
        assert!((at(10, 3) - expected).abs() < 1e-6);
        assert_eq!(at(256, 64), at(100_000, 1000));
    }
}
