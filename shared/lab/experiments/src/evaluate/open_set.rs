//! The figures of questions about what was never taught.

use evaluation::novelty_score::NoveltyScore;
use serde::Serialize;

/// How well what was never taught is told from the rest.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct OpenSet {
    n: usize,
    n_known: usize,
    auroc: f64,
    false_alarms_at_95: f64,
    rejected: f64,
    known_rejected: f64,
}

impl OpenSet {
    pub(super) fn of(score: NoveltyScore) -> Self {
        let NoveltyScore {
            n,
            n_known,
            auroc,
            false_alarms_at_95,
            rejected,
            known_rejected,
        } = score;
        Self {
            n,
            n_known,
            auroc,
            false_alarms_at_95,
            rejected,
            known_rejected,
        }
    }

    /// For people.
    pub(super) fn sentence(&self) -> String {
        format!(
            "{} open-set questions: AUROC {:.3}, {:.1} % false alarms where 95 % are found; \
             {:.1} % answered with unknown, and {:.1} % of the others",
            self.n,
            self.auroc,
            100.0 * self.false_alarms_at_95,
            100.0 * self.rejected,
            100.0 * self.known_rejected
        )
    }
}
