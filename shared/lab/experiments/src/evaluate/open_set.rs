//! Text about the open-set metrics.

use evaluation::novelty_score::NoveltyScore;

/// Sentence about the open-set questions.
pub(super) fn sentence(score: &NoveltyScore) -> String {
    format!(
        "{} open-set questions: AUROC {:.3}, {:.1} % false alarms where 95 % are found; \
         the daemon answers {:.1} % with unknown, and {:.1} % of the others",
        score.n,
        score.auroc,
        100.0 * score.false_alarms_at_95,
        100.0 * score.rejected,
        100.0 * score.known_rejected
    )
}
