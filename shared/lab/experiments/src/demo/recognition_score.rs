//! Precision and recall of recognition over the last 15 results (Kasaei et al. 2018, Fig. 7).

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Number of results over which precision and recall are taken (paper).
const WINDOW: usize = 15;

/// Counts of one recognition result.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct ResultCounts {
    true_positive: u32,
    false_positive: u32,
    false_negative: u32,
}

/// Precision and recall after a recognition result; `None` where nothing was said, or was to be said.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct ScorePoint {
    pub(super) time_s: f64,
    pub(super) precision: Option<f64>,
    pub(super) recall: Option<f64>,
}

/// Score of the recognition results of a demonstration, in their order.
#[derive(Debug, Default)]
pub(super) struct RecognitionScore {
    taught: BTreeSet<String>,
    newest: Vec<ResultCounts>,
    total: ResultCounts,
    pub(super) points: Vec<ScorePoint>,
}

impl RecognitionScore {
    /// Notes a category that was taught.
    pub(super) fn teach(&mut self, category: &str) {
        self.taught.insert(category.to_owned());
    }

    /// Counts a result: the true category, and what the robot said. A category that nobody has taught
    /// is truly unknown.
    pub(super) fn count(&mut self, time_s: f64, truth: &str, said: Option<&str>) {
        let truth = Some(truth).filter(|truth| self.taught.contains(*truth));
        let counts = match (truth, said) {
            // Ignored (paper).
            (None, None) => return,
            (None, Some(_)) => ResultCounts {
                false_positive: 1,
                ..ResultCounts::default()
            },
            (Some(_), None) => ResultCounts {
                false_negative: 1,
                ..ResultCounts::default()
            },
            (Some(truth), Some(said)) if truth == said => ResultCounts {
                true_positive: 1,
                ..ResultCounts::default()
            },
            (Some(_), Some(_)) => ResultCounts {
                false_positive: 1,
                false_negative: 1,
                ..ResultCounts::default()
            },
        };
        self.newest.push(counts);
        self.total = sum(&[self.total, counts]);
        let window = &self.newest[self.newest.len().saturating_sub(WINDOW)..];
        let counts = sum(window);
        self.points.push(ScorePoint {
            time_s,
            precision: precision(&counts),
            recall: recall(&counts),
        });
    }

    /// Precision and recall over all results.
    pub(super) fn overall(&self) -> [Option<f64>; 2] {
        [precision(&self.total), recall(&self.total)]
    }
}

fn sum(counts: &[ResultCounts]) -> ResultCounts {
    let of = |count: fn(&ResultCounts) -> u32| counts.iter().map(count).sum();
    ResultCounts {
        true_positive: of(|one| one.true_positive),
        false_positive: of(|one| one.false_positive),
        false_negative: of(|one| one.false_negative),
    }
}

fn precision(counts: &ResultCounts) -> Option<f64> {
    share(counts.true_positive, counts.false_positive)
}

fn recall(counts: &ResultCounts) -> Option<f64> {
    share(counts.true_positive, counts.false_negative)
}

fn share(of: u32, others: u32) -> Option<f64> {
    let all = of + others;
    (all > 0).then(|| f64::from(of) / f64::from(all))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_count_as_in_the_paper() {
        let mut score = RecognitionScore::default();
        score.count(0.0, "vase", None);
        assert!(score.points.is_empty(), "nothing is known, nothing is said");
        score.count(1.0, "vase", Some("mug"));
        assert_eq!(score.overall(), [Some(0.0), None]);
        score.teach("vase");
        score.count(2.0, "vase", Some("vase"));
        score.count(3.0, "vase", None);
        score.count(4.0, "vase", Some("mug"));
        assert_eq!(score.overall(), [Some(1.0 / 3.0), Some(1.0 / 3.0)]);
        assert_eq!(score.points.len(), 4);
    }

    #[test]
    fn window_forgets_old_results() {
        let mut score = RecognitionScore::default();
        score.teach("vase");
        score.count(0.0, "vase", Some("mug"));
        for n in 0..WINDOW {
            score.count(n as f64, "vase", Some("vase"));
        }
        let newest = score.points.last().unwrap();
        assert_eq!((newest.precision, newest.recall), (Some(1.0), Some(1.0)));
    }
}
