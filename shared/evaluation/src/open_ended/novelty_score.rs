//! How well what was never taught is told from the rest.

use super::record::{Question, Run};

/// The figures of open-set questions beside the others.
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
    /// Of all questions of some runs; `None` when either kind lacks.
    pub fn of(runs: &[Run]) -> Option<Self> {
        let questions = || runs.iter().flat_map(|run| &run.questions);
        let novelties = |is_open_set: bool| {
            let of_kind = questions().filter(|question| question.is_open_set == is_open_set);
            let mut novelties: Vec<f32> = of_kind.map(|q| q.answer.novelty).collect();
            novelties.sort_unstable_by(f32::total_cmp);
            novelties
        };
        let (open, known) = (novelties(true), novelties(false));
        if open.is_empty() || known.is_empty() {
            return None;
        }
        let is_rejected = |q: &&Question| q.answer.category.is_none();
        let rejected = |is_open_set: bool, n: usize| {
            let of_kind = questions().filter(|q| q.is_open_set == is_open_set);
            of_kind.filter(is_rejected).count() as f64 / n as f64
        };
        // 95 of 100 are at least as great as this one.
        let threshold = open[open.len() - (0.95 * open.len() as f64).ceil() as usize];
        let n_alarms = known.len() - known.partition_point(|&novelty| novelty < threshold);
        Some(Self {
            n: open.len(),
            n_known: known.len(),
            auroc: auroc(&open, &known),
            false_alarms_at_95: n_alarms as f64 / known.len() as f64,
            rejected: rejected(true, open.len()),
            known_rejected: rejected(false, known.len()),
        })
    }
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
}
