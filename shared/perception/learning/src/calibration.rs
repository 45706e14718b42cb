//! Probability calibration of nearest-neighbour distances.

/// Logistic calibration from nearest-neighbour distances to probabilities.
///
/// Categories differ in variability: a distance that is large in one is small in
/// another. Distances are therefore divided by the spread of the category, the mean
/// distance from its views to their nearest neighbours within it. The spread of a
/// category with few views is shrunk towards the mean over all categories, and that mean
/// towards a prior.
#[derive(Debug, Clone, Copy)]
pub struct Calibration {
    /// All axis hypotheses of a stored descriptor, itself included; the distance of two
    /// views is the least over them.
    pub axis_hypotheses_of: fn(&[f32]) -> Vec<Vec<f32>>,
    /// Prior of the spread of a category.
    pub spread_prior: f32,
    /// Prior of the distance to the nearest unrelated category.
    pub unrelated_distance_prior: f32,
    /// Novelty at which the probability is one half.
    pub even_odds_novelty: f32,
    /// Slope of the logistic from log novelty to log odds.
    pub steepness: f32,
}

/// Pseudo-count of the mean over all categories when the spread of one category is
/// estimated. Chosen; sensitivity: see `tabula-lab sweep`.
const GLOBAL_SPREAD_WEIGHT: f64 = 3.0;

/// Pseudo-count of the prior when the mean spread over all categories is estimated.
/// Chosen; sensitivity: see `tabula-lab sweep`.
const PRIOR_SPREAD_WEIGHT: f64 = 10.0;

/// Running sum and count of nearest-neighbour distances.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DistanceSum {
    pub(crate) sum: f64,
    pub(crate) n: usize,
}

impl DistanceSum {
    /// Replaces one distance by another; `None` stands for no distance.
    pub(crate) fn replace(&mut self, before: Option<f32>, after: Option<f32>) {
        if let Some(distance) = before {
            self.sum -= f64::from(distance);
            self.n -= 1;
        }
        if let Some(distance) = after {
            self.sum += f64::from(distance);
            self.n += 1;
        }
    }

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
    /// Novelty of an object: the nearest distance in units of the category's spread,
    /// times its ratio to the distance of the runner-up category.
    pub(crate) fn novelty(
        &self,
        distance: f32,
        runner_up: Option<f32>,
        own: DistanceSum,
        all: DistanceSum,
    ) -> f32 {
        let usual = all.shrunken_mean(PRIOR_SPREAD_WEIGHT, f64::from(self.spread_prior));
        let spread = own
            .shrunken_mean(GLOBAL_SPREAD_WEIGHT, usual)
            .max(f64::MIN_POSITIVE);
        let runner_up =
            f64::from(runner_up.unwrap_or(self.unrelated_distance_prior)).max(f64::from(distance));
        if runner_up <= 0.0 {
            return 0.0;
        }
        let distance = f64::from(distance);
        (distance / spread * (distance / runner_up)) as f32
    }

    /// Probability that an object of this novelty belongs to the nearest category, 0 to
    /// 1; logistic in the logarithm of novelty.
    pub fn probability(&self, novelty: f32) -> f32 {
        1.0 / (1.0 + (novelty / self.even_odds_novelty).powf(self.steepness))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALIBRATION: Calibration = Calibration {
        axis_hypotheses_of: |stored| vec![stored.to_vec()],
        spread_prior: 0.6,
        unrelated_distance_prior: 1.5,
        even_odds_novelty: 0.9,
        steepness: 4.0,
    };

    const NONE: DistanceSum = DistanceSum { sum: 0.0, n: 0 };

    #[test]
    fn priors_replace_missing_distances() {
        let novelty = CALIBRATION.novelty(0.6, None, NONE, NONE);
        assert!((novelty - 0.4).abs() < 1e-6);
        let all = DistanceSum {
            sum: 100.0,
            n: 1000,
        };
        assert!(CALIBRATION.novelty(0.6, None, NONE, all) > 3.0 * novelty);
    }

    #[test]
    fn a_distance_is_judged_by_the_spread_of_its_category() {
        let (wide, narrow) = (
            DistanceSum { sum: 20.0, n: 20 },
            DistanceSum { sum: 2.0, n: 20 },
        );
        let novelty = |own| CALIBRATION.novelty(0.7, Some(1.0), own, NONE);
        assert!(CALIBRATION.probability(novelty(wide)) > 0.7);
        assert!(CALIBRATION.probability(novelty(narrow)) < 0.1);
    }

    #[test]
    fn probability_falls_with_distance_and_with_a_near_runner_up() {
        let at = |distance, runner_up| {
            CALIBRATION.probability(CALIBRATION.novelty(distance, Some(runner_up), NONE, NONE))
        };
        assert!(at(0.3, 1.2) > at(0.6, 1.2) && at(0.6, 1.2) > at(0.6, 0.61));
        assert_eq!(at(0.0, 0.0), 1.0);
        assert!(at(1e9, 1e9) < 1e-6);
    }
}
