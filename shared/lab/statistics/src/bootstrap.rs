//! Bootstrap confidence intervals (percentile method) of a statistic over runs.
//!
//! *Source*: Efron, "Bootstrap methods: another look at the jackknife", Annals of
//! Statistics 7, 1979; percentile intervals: Efron and Tibshirani, "An Introduction to
//! the Bootstrap", 1993, chapter 13.

use random::Random;
use serde::Serialize;

/// Number of the random stream for bootstrap resampling.
const RESAMPLING_STREAM: u64 = 7;
/// Number of bootstrap resamples.
pub const N_RESAMPLES: usize = 2000;
/// Probability mass outside the interval on each side: a 95 % interval.
const TAIL_SHARE: f64 = 0.025;

/// Point estimate with its 95 % bootstrap confidence interval.
///
/// The interval is somewhat too short for few runs: for means of a normal distribution it covers
/// the true value in 90 % of the cases with 10 runs, in 94 % with 40.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Value of the statistic for the original runs.
    pub value: f64,
    /// Lower bound of the 95 % interval.
    pub low: f64,
    /// Upper bound of the 95 % interval.
    pub high: f64,
}

impl Estimate {
    /// Percentile bootstrap estimate of any statistic.
    ///
    /// `figure` computes the statistic from indices of runs, `0..n_runs`; a resample repeats
    /// indices (drawing with replacement). The same seed and `n_runs` draw the same resamples, so
    /// estimates over the same runs, or over pairs of runs, are comparable.
    ///
    /// Resamples without a statistic are left out. `None` when the original runs have none.
    pub fn of(
        n_runs: usize,
        seed: u64,
        figure: impl Fn(&mut dyn Iterator<Item = usize>) -> Option<f64>,
    ) -> Option<Self> {
        let value = figure(&mut (0..n_runs))?;
        let mut random = Random::substream(seed, RESAMPLING_STREAM);
        let mut drawn = vec![0; n_runs];
        let mut resampled = Vec::with_capacity(N_RESAMPLES);
        for _ in 0..N_RESAMPLES {
            drawn.fill_with(|| random.below(n_runs));
            resampled.extend(figure(&mut drawn.iter().copied()));
        }
        resampled.sort_unstable_by(f64::total_cmp);
        let n_outside = (TAIL_SHARE * resampled.len() as f64) as usize;
        let low = resampled.get(n_outside).copied()?;
        let high = resampled.iter().rev().nth(n_outside).copied()?;
        Some(Self { value, low, high })
    }

    /// Mean of one value per run, missing values left out. `None` when all are missing.
    pub fn mean(values: &[Option<f64>], seed: u64) -> Option<Self> {
        Self::of(values.len(), seed, |runs| {
            let (sum, n) = runs
                .filter_map(|run| values[run])
                .fold((0.0, 0_u32), |(sum, n), value| (sum + value, n + 1));
            (n > 0).then(|| sum / f64::from(n))
        })
    }

    /// Mean difference of paired runs, second minus first. `None` without runs.
    pub fn paired_difference(first: &[f64], second: &[f64], seed: u64) -> Option<Self> {
        let differences = first.iter().zip(second);
        let differences: Vec<_> = differences.map(|(a, b)| Some(b - a)).collect();
        Self::mean(&differences, seed)
    }

    /// Ratio of sums over paired runs: second over first. Resamples whose first sum is 0 are left
    /// out. `None` when the sum of all first values is 0.
    pub fn paired_ratio(first: &[f64], second: &[f64], seed: u64) -> Option<Self> {
        Self::of(first.len().min(second.len()), seed, |runs| {
            let (below, above) = runs.fold((0.0, 0.0), |(below, above), run| {
                (below + first[run], above + second[run])
            });
            (below > 0.0).then(|| above / below)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use random::Random;

    /// Coverage: share of experiments whose interval over `n_runs` values contains their true
    /// mean of 3.
    fn coverage(n_runs: usize) -> f64 {
        let mut random = Random::substream(11, 99);
        let n_experiments = 600;
        let holds = (0..n_experiments).filter(|&experiment| {
            let values: Vec<_> = (0..n_runs).map(|_| Some(3.0 + random.normal())).collect();
            let Estimate { low, high, .. } = Estimate::mean(&values, experiment).unwrap();
            (low..=high).contains(&3.0)
        });
        holds.count() as f64 / n_experiments as f64
    }

    #[test]
    fn intervals_cover_the_true_mean_at_the_expected_rate() {
        // Expected from Student's t distribution: 90.4 % and 94.0 %. The standard deviation of a
        // share of 600 is 1.2 % and 1.0 %.
        for (n_runs, expected) in [(10, 0.904), (40, 0.940)] {
            let found = coverage(n_runs);
            assert!(
                (found - expected).abs() < 0.035,
                "{found} with {n_runs} runs"
            );
        }
    }

    #[test]
    fn paired_intervals_are_narrower_than_unpaired_ones() {
        let mut random = Random::substream(5, 99);
        let first: Vec<f64> = (0..10).map(|_| 20.0 + 5.0 * random.normal()).collect();
        let second: Vec<f64> = first
            .iter()
            .map(|value| value + 1.0 + 0.1 * random.normal())
            .collect();
        let width = |estimate: Option<Estimate>| estimate.map(|e| e.high - e.low).unwrap();
        let difference = Estimate::paired_difference(&first, &second, 1);
        let alone: Vec<_> = first.iter().copied().map(Some).collect();
        assert!((difference.unwrap().value - 1.0).abs() < 0.2);
        assert!(width(difference) < 0.1 * width(Estimate::mean(&alone, 1)));
        let ratio = Estimate::paired_ratio(&first, &second, 1).unwrap();
        assert!(ratio.low < ratio.value && ratio.value < ratio.high);
        assert!((1.02..1.10).contains(&ratio.value), "{ratio:?}");
    }

    #[test]
    fn the_same_seed_gives_the_same_interval() {
        let values: Vec<_> = (0..10).map(|i| Some(f64::from(i * i))).collect();
        assert_eq!(Estimate::mean(&values, 1), Estimate::mean(&values, 1));
        assert_ne!(Estimate::mean(&values, 1), Estimate::mean(&values, 2));
        assert_eq!(Estimate::mean(&values, 1).unwrap().value, 28.5);
    }

    #[test]
    fn constant_values_have_zero_width_and_missing_values_no_estimate() {
        let certain = Estimate {
            value: 2.0,
            low: 2.0,
            high: 2.0,
        };
        assert_eq!(
            Estimate::mean(&[Some(2.0), None, Some(2.0)], 1),
            Some(certain)
        );
        assert_eq!(Estimate::mean(&[None, None], 1), None);
        assert_eq!(Estimate::mean(&[], 1), None);
        assert_eq!(Estimate::paired_ratio(&[0.0, 0.0], &[1.0, 2.0], 1), None);
        let ratio = Estimate::paired_ratio(&[0.0, 1.0], &[0.0, 2.0], 1);
        assert_eq!(ratio, Some(certain));
    }
}
