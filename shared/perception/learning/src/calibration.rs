//! How sure one may be that an object belongs to the nearest category.

/// From distances to probabilities.
///
/// The views of some categories are alike, those of others are not. What is far
/// for one is near for the other, so distances are compared with the spread of the
/// category: the mean distance from its views to their nearest neighbours within
/// it. A category with few views borrows from all others, and they from what is
/// usual.
#[derive(Debug, Clone, Copy)]
pub struct Calibration {
    /// All readings of a stored descriptor, itself among them: their least distance
    /// is that of two views.
    pub readings_of: fn(&[f32]) -> Vec<Vec<f32>>,
    /// Usual spread of a category.
    pub spread: f32,
    /// Usual distance to a category that an object does not belong to.
    pub far: f32,
    /// Novelty at which it is as likely as not that an object belongs to the nearest
    /// category.
    pub even_novelty: f32,
    /// How fast the odds fall: with which power of novelty.
    pub steepness: f32,
}

/// How many views of its own a category needs until they say as much as all others
/// about its spread.
const OWN_WEIGHT: f64 = 3.0;

/// The same for all categories and what is usual.
const ALL_WEIGHT: f64 = 10.0;

/// A sum of distances and their number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Distances {
    pub(crate) sum: f64,
    pub(crate) n: usize,
}

impl Distances {
    /// Exchanges one distance; none is none.
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

    /// Exchanges those of one category among those of all.
    pub(crate) fn exchange(&mut self, before: Self, after: Self) {
        self.sum += after.sum - before.sum;
        self.n = self.n + after.n - before.n;
    }

    fn mean_with(self, weight: f64, expected: f64) -> f64 {
        (self.sum + weight * expected) / (self.n as f64 + weight)
    }
}

impl Calibration {
    /// How new an object is: the distance of its nearest view as a multiple of the
    /// category's spread, times the same as a share of the distance to the runner-up.
    pub(crate) fn novelty(
        &self,
        distance: f32,
        runner_up: Option<f32>,
        own: Distances,
        all: Distances,
    ) -> f32 {
        let usual = all.mean_with(ALL_WEIGHT, f64::from(self.spread));
        let spread = own.mean_with(OWN_WEIGHT, usual).max(f64::MIN_POSITIVE);
        let runner_up = f64::from(runner_up.unwrap_or(self.far)).max(f64::from(distance));
        if runner_up <= 0.0 {
            return 0.0;
        }
        let distance = f64::from(distance);
        (distance / spread * (distance / runner_up)) as f32
    }

    /// The probability that an object of this novelty belongs to the nearest category,
    /// from 0 to 1: logistic in the logarithm of novelty.
    pub fn probability(&self, novelty: f32) -> f32 {
        1.0 / (1.0 + (novelty / self.even_novelty).powf(self.steepness))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALIBRATION: Calibration = Calibration {
        readings_of: |stored| vec![stored.to_vec()],
        spread: 0.6,
        far: 1.5,
        even_novelty: 0.9,
        steepness: 4.0,
    };

    const NONE: Distances = Distances { sum: 0.0, n: 0 };

    #[test]
    fn what_is_usual_stands_in_for_what_is_not_known() {
        let novelty = CALIBRATION.novelty(0.6, None, NONE, NONE);
        assert!((novelty - 0.4).abs() < 1e-6);
        let all = Distances {
            sum: 100.0,
            n: 1000,
        };
        assert!(CALIBRATION.novelty(0.6, None, NONE, all) > 3.0 * novelty);
    }

    #[test]
    fn a_wide_category_takes_what_a_narrow_one_does_not() {
        let (wide, narrow) = (
            Distances { sum: 20.0, n: 20 },
            Distances { sum: 2.0, n: 20 },
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
