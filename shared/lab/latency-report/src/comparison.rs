//! A/B comparison of two reports: Welch's t-test over batch percentiles.
//!
//! Consecutive frames are correlated, so single frames would make chance look like change. Each
//! run is cut into batches, each of which gives one percentile; the means over the batches are
//! compared by Welch's test (Welch, "The generalization of Student's problem when several
//! different population variances are involved", Biometrika 34, 1947). Variation between runs,
//! such as the placement of memory, is not visible in a single run: repeat the runs to measure
//! it.

use crate::batch_means::Batch;
use crate::report::LatencyReport;
use message::Stage;
use serde::Serialize;

/// Smallest relative difference that is decided. Chosen: from run to run the same program differs
/// as much.
const RELATIVE_DIFFERENCE_MIN: f64 = 0.03;

coded_enum::coded_enum! {
    /// Outcome of an A/B comparison.
    #[derive(Serialize)]
    #[serde(rename_all = "snake_case")]
    pub enum ComparisonVerdict {
        /// Faster: the new report has a significantly lower latency.
        Faster, "faster";
        /// Slower: the new report has a significantly higher latency.
        Slower, "slower";
        /// Undecided: the difference is not significant or below 3 %.
        Undecided, "undecided";
    }
}

/// Comparison of one percentile of one stage in both reports.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// `end_to_end` or the stage's name.
    pub what: String,
    /// Name of the percentile: `p50`, `p90` or `p99`.
    pub percentile: &'static str,
    /// Mean over the batches of the old report, milliseconds.
    pub before_ms: f64,
    /// Mean over the batches of the new report, milliseconds.
    pub now_ms: f64,
    /// Ratio of the new mean to the old mean.
    pub ratio: f64,
    /// 95 % confidence interval of the ratio.
    pub ratio_interval: [f64; 2],
    /// Outcome of the comparison.
    pub verdict: ComparisonVerdict,
}

/// Compares end-to-end latency and every stage that both reports contain.
pub fn compare(before: &LatencyReport, now: &LatencyReport) -> Vec<Comparison> {
    let whole = (
        "end_to_end",
        &before.end_to_end_batches,
        &now.end_to_end_batches,
    );
    let stages = Stage::ALL.iter().filter_map(|stage| {
        let (before, now) = (before.stage(*stage)?, now.stage(*stage)?);
        Some((stage.word(), &before.batches, &now.batches))
    });
    std::iter::once(whole)
        .chain(stages)
        .flat_map(|(what, before, now)| {
            Batch::NAMED.iter().filter_map(move |(name, get)| {
                let before: Vec<f64> = before.iter().map(get).collect();
                let now: Vec<f64> = now.iter().map(get).collect();
                welch_comparison(what, name, &before, &now)
            })
        })
        .collect()
}

/// Welch's t-test of one percentile; `None` for fewer than three batches or a mean of 0.
fn welch_comparison(
    what: &str,
    percentile: &'static str,
    before: &[f64],
    now: &[f64],
) -> Option<Comparison> {
    let (before, now) = (Mean::of(before)?, Mean::of(now)?);
    if before.value <= 0.0 {
        return None;
    }
    let half = confidence_half_width(&before, &now);
    let difference = now.value - before.value;
    let ratio = |difference: f64| 1.0 + difference / before.value;
    let interval = [ratio(difference - half), ratio(difference + half)];
    let is_small = (ratio(difference) - 1.0).abs() < RELATIVE_DIFFERENCE_MIN;
    let verdict = match interval {
        [_, high] if high < 1.0 && !is_small => ComparisonVerdict::Faster,
        [low, _] if low > 1.0 && !is_small => ComparisonVerdict::Slower,
        _ => ComparisonVerdict::Undecided,
    };
    Some(Comparison {
        what: what.to_owned(),
        percentile,
        before_ms: before.value,
        now_ms: now.value,
        ratio: ratio(difference),
        ratio_interval: interval,
        verdict,
    })
}

/// Sample mean with its variance (squared standard error).
struct Mean {
    value: f64,
    variance: f64,
    n: f64,
}

impl Mean {
    /// Mean of a sample; `None` for fewer than three values.
    fn of(values: &[f64]) -> Option<Self> {
        if values.len() < 3 {
            return None;
        }
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        Some(Self {
            value,
            variance: squares / (n - 1.0) / n,
            n,
        })
    }
}

/// Half-width of the 95 % confidence interval of the difference of two means.
fn confidence_half_width(a: &Mean, b: &Mean) -> f64 {
    let variance = a.variance + b.variance;
    if variance == 0.0 {
        return 0.0;
    }
    let freedom =
        variance.powi(2) / (a.variance.powi(2) / (a.n - 1.0) + b.variance.powi(2) / (b.n - 1.0));
    student_t_quantile(freedom) * variance.sqrt()
}

/// 97.5 % quantile of Student's t distribution: within 4 % from two degrees of freedom on, within
/// 0.3 % from five on.
///
/// *Source*: Abramowitz and Stegun, "Handbook of Mathematical Functions", 1964, 26.7.5.
fn student_t_quantile(freedom: f64) -> f64 {
    const Z: f64 = 1.959_963_985;
    let terms = [
        (Z.powi(3) + Z) / 4.0,
        (5.0 * Z.powi(5) + 16.0 * Z.powi(3) + 3.0 * Z) / 96.0,
        (3.0 * Z.powi(7) + 19.0 * Z.powi(5) + 17.0 * Z.powi(3) - 15.0 * Z) / 384.0,
    ];
    terms
        .iter()
        .zip(1..)
        .fold(Z, |sum, (term, power)| sum + term / freedom.powi(power))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Batch percentiles that scatter by 5 % around `mean`, deterministic.
    fn parts(mean: f64, turn: u32) -> Vec<f64> {
        let scatter = |i: u32| (f64::from(i * 7 + turn) * 2.399).sin() * 0.05;
        (0..20).map(|i| mean * (1.0 + scatter(i))).collect()
    }

    fn verdict(before: f64, now: f64) -> ComparisonVerdict {
        welch_comparison("detection", "p50", &parts(before, 1), &parts(now, 2))
            .unwrap()
            .verdict
    }

    #[test]
    fn differences_beyond_the_scatter_are_significant() {
        assert_eq!(verdict(10.0, 8.0), ComparisonVerdict::Faster);
        assert_eq!(verdict(10.0, 12.0), ComparisonVerdict::Slower);
        assert_eq!(verdict(10.0, 10.0), ComparisonVerdict::Undecided);
        assert_eq!(verdict(10.0, 10.2), ComparisonVerdict::Undecided);
    }

    #[test]
    fn confidence_interval_contains_the_ratio() {
        let found = welch_comparison("x", "p99", &parts(10.0, 1), &parts(9.0, 5)).unwrap();
        let [low, high] = found.ratio_interval;
        assert!(low < found.ratio && found.ratio < high);
        assert!((found.ratio - 0.9).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn too_few_batches_give_no_comparison() {
        assert_eq!(
            welch_comparison("x", "p50", &[1.0, 2.0], &parts(1.0, 1)),
            None
        );
        assert_eq!(
            welch_comparison("x", "p50", &[0.0; 5], &parts(1.0, 1)),
            None
        );
    }

    #[test]
    fn student_t_quantiles_agree_with_tables() {
        for (freedom, expected) in [(5.0, 2.571), (10.0, 2.228), (30.0, 2.042), (1e6, 1.960)] {
            let found = student_t_quantile(freedom);
            assert!(
                (found - expected).abs() < 0.003 * expected,
                "{freedom}: {found}"
            );
        }
    }

    #[test]
    fn a_report_compared_with_itself_is_undecided() {
        let part = |i: u32| Batch {
            p50: f64::from(i),
            p90: f64::from(i) * 1.5,
            p99: f64::from(i) * 2.0,
        };
        let report = LatencyReport {
            end_to_end_batches: (10..30).map(part).collect(),
            ..LatencyReport::default()
        };
        let found = compare(&report, &report);
        assert_eq!(found.len(), 3);
        assert!(
            found
                .iter()
                .all(|c| c.verdict == ComparisonVerdict::Undecided)
        );
    }
}
