//! Open-set metrics of novelty detection: AUROC, false-positive rate at 95 % recall, rejection
//! rates.

use crate::recogniser::Answer;
use serde::Serialize;

/// Open-set metrics: questions about categories that were never taught against known ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoveltyScore {
    /// Number of open-set questions (categories not taught).
    pub n: usize,
    /// Number of questions about taught categories.
    pub n_known: usize,
    /// Area under the ROC curve: probability that an open-set view has a greater novelty than a
    /// view of a taught category, ties counting half.
    pub auroc: f64,
    /// False-positive rate at 95 % recall: share of known views with at least the novelty that 95
    /// % of the open-set views reach.
    pub false_alarms_at_95: f64,
    /// Share of open-set questions answered with "unknown" (right rejections).
    pub rejected: f64,
    /// Share of known questions answered with "unknown" (wrong rejections).
    pub known_rejected: f64,
}

impl NoveltyScore {
    /// Metrics of the answers to open-set and to known questions; `None` if either is empty.
    /// "Unknown" is an answer without a category, or one whose best category is less probable than
    /// `known_probability_min`.
    pub fn of(open: &[Answer], known: &[Answer], known_probability_min: f32) -> Option<Self> {
        if open.is_empty() || known.is_empty() {
            return None;
        }
        let novelty = |answer: &Answer| answer.novelty;
        let open_novelties = sorted(open.iter().map(novelty));
        let known_novelties = sorted(known.iter().map(novelty));
        // Novelty that 95 % of the open-set views reach.
        let n_not_found = open.len() - (0.95 * open.len() as f64).ceil() as usize;
        let threshold = open_novelties[n_not_found];
        let n_quiet = known_novelties.partition_point(|&novelty| novelty < threshold);
        Some(Self {
            n: open.len(),
            n_known: known.len(),
            auroc: auroc(&open_novelties, &known_novelties),
            false_alarms_at_95: (known.len() - n_quiet) as f64 / known.len() as f64,
            rejected: rejection_rate(open, known_probability_min),
            known_rejected: rejection_rate(known, known_probability_min),
        })
    }
}

/// Area under the ROC curve: probability that a value of the first group is greater than one of
/// the second, ties counting half.
pub(crate) fn area_under_roc(
    greater: impl Iterator<Item = f32>,
    smaller: impl Iterator<Item = f32>,
) -> f64 {
    auroc(&greater.collect::<Vec<_>>(), &sorted(smaller))
}

fn sorted(values: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_unstable_by(f32::total_cmp);
    values
}

fn rejection_rate(answers: &[Answer], known_probability_min: f32) -> f64 {
    let is_unknown = |answer: &&Answer| answer.is_unknown(known_probability_min);
    let rejected = answers.iter().filter(is_unknown);
    rejected.count() as f64 / answers.len() as f64
}

/// Mann-Whitney estimate of the AUROC; `known` is in ascending order.
fn auroc(open: &[f32], known: &[f32]) -> f64 {
    let n_pairs_won = |&novelty: &f32| {
        let n_below = known.partition_point(|&other| other < novelty);
        let n_not_above = known.partition_point(|&other| other <= novelty);
        0.5 * (n_below + n_not_above) as f64
    };
    open.iter().map(n_pairs_won).sum::<f64>() / (open.len() * known.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auroc_is_the_share_of_ordered_pairs() {
        assert_eq!(auroc(&[3.0, 4.0], &[1.0, 2.0]), 1.0);
        assert_eq!(auroc(&[1.0], &[1.0]), 0.5);
        assert_eq!(auroc(&[1.0, 5.0], &[2.0, 3.0, 4.0]), 0.5);
        assert_eq!(auroc(&[2.0, 5.0], &[2.0, 2.0, 4.0]), (1.0 + 3.0) / 6.0);
    }

    #[test]
    fn false_alarm_rate_is_measured_at_95_percent_recall() {
        let answers = |novelties: &mut dyn Iterator<Item = f32>, category| {
            let answer = |novelty| Answer {
                category,
                distance: novelty,
                novelty,
                probability: None,
                known_probability: None,
                best: [None; 3],
            };
            novelties.map(answer).collect::<Vec<_>>()
        };
        let open = answers(&mut (0..100).map(|i| 10.0 + i as f32), None);
        // Novelty 15 and more is above the threshold: 95 of the open-set views, 5 of the known
        // ones.
        let known = answers(&mut (0..20).map(|i| i as f32), Some(1));
        let score = NoveltyScore::of(&open, &known, 0.75).unwrap();
        assert_eq!(score.false_alarms_at_95, 0.25);
        assert_eq!((score.rejected, score.known_rejected), (1.0, 0.0));
        assert_eq!(NoveltyScore::of(&open, &[], 0.75), None);
    }
}
