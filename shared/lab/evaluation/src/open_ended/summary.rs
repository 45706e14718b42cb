//! Mean and standard deviation of metrics over several runs.

use super::record::Metrics;
use statistics::spread::MeanAndStd;

/// Metrics over runs; each is `None` without runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MetricsSummary {
    /// Question/correction iterations (QCI) over the runs.
    pub qci: Option<MeanAndStd>,
    /// Number of taught categories (TLC) over the runs.
    pub tlc: Option<MeanAndStd>,
    /// Average instances per category (AIC) over the runs.
    pub aic: Option<MeanAndStd>,
    /// Global classification accuracy (GCA) over the runs.
    pub gca: Option<MeanAndStd>,
    /// Average protocol accuracy, over the runs that have one.
    pub apa: Option<MeanAndStd>,
}

impl MetricsSummary {
    /// Summary of the metrics of several runs.
    pub fn of(runs: &[Metrics]) -> Self {
        let spread = |value: fn(&Metrics) -> f64| {
            MeanAndStd::of(&runs.iter().map(value).collect::<Vec<_>>())
        };
        let apa: Vec<f64> = runs.iter().filter_map(|run| run.apa).collect();
        Self {
            qci: spread(|run| run.qci.into()),
            tlc: spread(|run| run.tlc.into()),
            aic: spread(|run| run.aic),
            gca: spread(|run| run.gca),
            apa: MeanAndStd::of(&apa),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_deviation_agree_with_the_published_table() {
        // Table 2 of Kasaei et al. 2018: QCI and TLC of ten experiments.
        let qci = [1669, 2014, 1759, 1952, 1592, 1366, 1547, 2087, 1066, 1540];
        let spread = MeanAndStd::of(&qci.map(f64::from)).unwrap();
        assert!((spread.mean - 1659.0).abs() < 0.5);
        assert!((spread.std.unwrap() - 311.6).abs() < 0.05);
        let tlc = [37, 40, 43, 43, 37, 37, 35, 41, 34, 45].map(f64::from);
        let spread = MeanAndStd::of(&tlc).unwrap();
        assert!((spread.mean - 39.2).abs() < 1e-9);
        assert!((spread.std.unwrap() - 3.73).abs() < 0.01);
    }

    #[test]
    fn single_value_has_no_deviation() {
        let one = MeanAndStd::of(&[0.5]);
        assert_eq!(
            one,
            Some(MeanAndStd {
                mean: 0.5,
                std: None
            })
        );
        assert_eq!(MeanAndStd::of(&[]), None);
    }
}
