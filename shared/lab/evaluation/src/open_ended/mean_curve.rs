//! Mean curve of several runs with its band of one standard deviation.

use super::record::{OpenEndedRun, StageRecord};
use statistics::spread::MeanAndStd;
use std::collections::BTreeMap;

/// Mean of a value over the runs at each number of learned categories, and its band.
#[derive(Default)]
pub(super) struct MeanCurve {
    /// Learned categories with the mean of the runs that learned so many.
    pub(super) mean: Vec<(f64, f64)>,
    /// The mean less a sample standard deviation; empty for a single run.
    pub(super) low: Vec<(f64, f64)>,
    /// The mean and a sample standard deviation.
    pub(super) high: Vec<(f64, f64)>,
}

impl MeanCurve {
    /// Mean curve of a value of the stages.
    pub(super) fn of(runs: &[OpenEndedRun], value: impl Fn(&StageRecord) -> f64) -> Self {
        let mut values: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        for stage in runs.iter().flat_map(|run| &run.stages) {
            values
                .entry(stage.n_categories)
                .or_default()
                .push(value(stage));
        }
        let mut curve = Self::default();
        for (n_categories, values) in values {
            let x = f64::from(n_categories);
            let Some(MeanAndStd { mean, std }) = MeanAndStd::of(&values) else {
                continue;
            };
            curve.mean.push((x, mean));
            if let Some(deviation) = std {
                curve.low.push((x, mean - deviation));
                curve.high.push((x, mean + deviation));
            }
        }
        curve
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::StopReason;
    use super::*;

    fn run(accuracies: &[f64]) -> OpenEndedRun {
        let stage = |(n_categories, accuracy): (u32, &f64)| StageRecord {
            n_categories,
            n_questions: 10,
            accuracy: *accuracy,
        };
        OpenEndedRun {
            seed: 1,
            stop: StopReason::Stalled,
            questions: Vec::new(),
            stages: (2..).zip(accuracies).map(stage).collect(),
            stage_accuracies: Vec::new(),
            taught: Vec::new(),
            n_views_at_start: 3,
        }
    }

    #[test]
    fn mean_curve_is_that_of_the_runs_that_came_so_far() {
        let runs = [run(&[0.8, 0.6]), run(&[0.6])];
        let curve = MeanCurve::of(&runs, |stage| stage.accuracy);
        assert_eq!(curve.mean.len(), 2);
        assert!((curve.mean[0].1 - 0.7).abs() < 1e-12);
        assert_eq!(curve.mean[1], (3.0, 0.6));
        // Sample standard deviation of 0.6 and 0.8: 0.1 times the root of 2.
        assert_eq!(curve.low.len(), 1);
        assert!((curve.high[0].1 - 0.7 - 0.1 * 2f64.sqrt()).abs() < 1e-12);
    }
}
