//! How well what was never taught is told from the rest.

use crate::recogniser::Answer;

/// The figures of open-set questions, whose category was never taught, beside the
/// others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoveltyScore {
    /// Open-set questions.
    pub n: usize,
    /// The others.
    pub n_known: usize,
    /// Area under the receiver operating characteristic: how probable it is that an
    /// open-set view has a greater novelty than a view of a taught category, ties
    /// counting half.
    pub auroc: f64,
    /// Share of the views of taught categories that have at least the novelty which 95
    /// of 100 open-set views have.
    pub false_alarms_at_95: f64,
    /// Share of the open-set questions that were answered with "unknown".
    pub rejected: f64,
    /// The same of the other questions.
    pub known_rejected: f64,
}

impl NoveltyScore {
    /// Of the answers to open-set questions and to the others; `None` when either kind
    /// lacks.
    pub fn of(open: &[Answer], known: &[Answer]) -> Option<Self> {
        if open.is_empty() || known.is_empty() {
            return None;
        }
        let (open_novelties, known_novelties) = (sorted_novelties(open), sorted_novelties(known));
        // 95 of 100 are at least as great as this one.
        let n_not_found = open.len() - (0.95 * open.len() as f64).ceil() as usize;
        let threshold = open_novelties[n_not_found];
        let n_quiet = known_novelties.partition_point(|&novelty| novelty < threshold);
        Some(Self {
            n: open.len(),
            n_known: known.len(),
            auroc: auroc(&open_novelties, &known_novelties),
            false_alarms_at_95: (known.len() - n_quiet) as f64 / known.len() as f64,
            rejected: rejected(open),
            known_rejected: rejected(known),
        })
    }
}

fn sorted_novelties(answers: &[Answer]) -> Vec<f32> {
    let mut novelties: Vec<f32> = answers.iter().map(|answer| answer.novelty).collect();
    novelties.sort_unstable_by(f32::total_cmp);
    novelties
}

fn rejected(answers: &[Answer]) -> f64 {
    let rejected = answers.iter().filter(|answer| answer.category.is_none());
    rejected.count() as f64 / answers.len() as f64
}

/// Share of the pairs in which the first is greater; the second is sorted.
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
    fn the_area_is_the_share_of_pairs_in_order() {
        assert_eq!(auroc(&[3.0, 4.0], &[1.0, 2.0]), 1.0);
        assert_eq!(auroc(&[1.0], &[1.0]), 0.5);
        assert_eq!(auroc(&[1.0, 5.0], &[2.0, 3.0, 4.0]), 0.5);
        assert_eq!(auroc(&[2.0, 5.0], &[2.0, 2.0, 4.0]), (1.0 + 3.0) / 6.0);
    }

    #[test]
    fn false_alarms_are_known_views_beyond_the_threshold_that_finds_95_percent() {
        let answers = |novelties: &mut dyn Iterator<Item = f32>, category| {
            let answer = |novelty| Answer {
                category,
                distance: novelty,
                novelty,
            };
            novelties.map(answer).collect::<Vec<_>>()
        };
        let open = answers(&mut (0..100).map(|i| 10.0 + i as f32), None);
        // 15 and more are beyond: 95 of the open ones, and 5 of the known ones.
        let known = answers(&mut (0..20).map(|i| i as f32), Some(1));
        let score = NoveltyScore::of(&open, &known).unwrap();
        assert_eq!(score.false_alarms_at_95, 0.25);
        assert_eq!((score.rejected, score.known_rejected), (1.0, 0.0));
        assert_eq!(NoveltyScore::of(&open, &[]), None);
    }
}
