//! Quality of a trained classifier on a data set: AUROC, logistic loss and share of wrong
//! decisions.

use super::TrainingSet;
use command_line::format_table;
use serde::Serialize;

/// Classification of the examples of one data set.
#[derive(Debug, Serialize)]
pub(super) struct SetReport {
    dataset: String,
    n_scenes: usize,
    n_examples: usize,
    n_positive: usize,
    /// Area under the receiver operating characteristic.
    auroc: Option<f64>,
    /// Mean logistic loss.
    log_loss: f64,
    /// Share of wrong decisions at even odds.
    error_rate: f64,
}

impl SetReport {
    /// Report on the examples of a data set, whose rows of `n_features` a model gives `log_odds`.
    pub(super) fn of(
        set: &TrainingSet,
        n_features: usize,
        log_odds: impl Fn(&[f32]) -> f64,
    ) -> Self {
        let rows = set.rows.features.chunks_exact(n_features).map(log_odds);
        let mut rated: Vec<(f64, bool)> = rows.zip(set.rows.labels.iter().copied()).collect();
        rated.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = rated.len().max(1) as f64;
        let loss = |&(odds, is_positive): &(f64, bool)| {
            let margin = if is_positive { -odds } else { odds };
            margin.max(0.0) + (-margin.abs()).exp().ln_1p()
        };
        let is_wrong = |&&(odds, is_positive): &&(f64, bool)| (odds > 0.0) != is_positive;
        Self {
            dataset: set.dataset.clone(),
            n_scenes: set.n_scenes,
            n_examples: rated.len(),
            n_positive: rated.iter().filter(|(_, is_positive)| *is_positive).count(),
            auroc: auroc(&rated),
            log_loss: rated.iter().map(loss).sum::<f64>() / n,
            error_rate: rated.iter().filter(is_wrong).count() as f64 / n,
        }
    }
}

/// Area under the receiver operating characteristic of scores in ascending order; `None`
/// with one class only.
fn auroc(rated: &[(f64, bool)]) -> Option<f64> {
    let (mut n_false, mut n_true, mut n_ordered) = (0_u64, 0_u64, 0_u64);
    for (_, is_positive) in rated {
        if *is_positive {
            n_true += 1;
            n_ordered += n_false;
        } else {
            n_false += 1;
        }
    }
    let n_both = n_false * n_true;
    (n_both > 0).then(|| n_ordered as f64 / n_both as f64)
}

/// Table of the reports on the sets of the training and on those left out.
pub(super) fn set_table(train: &[SetReport], test: &[SetReport]) -> String {
    let heading = [
        "", "scenes", "examples", "positive", "AUROC", "log loss", "wrong %",
    ];
    let row = |part: &str, set: &SetReport| {
        vec![
            format!("{part} {}", set.dataset),
            set.n_scenes.to_string(),
            set.n_examples.to_string(),
            set.n_positive.to_string(),
            set.auroc
                .map_or_else(|| "-".into(), |auroc| format!("{auroc:.4}")),
            format!("{:.4}", set.log_loss),
            format!("{:.1}", 100.0 * set.error_rate),
        ]
    };
    let train = train.iter().map(|set| row("trained on", set));
    let test = test.iter().map(|set| row("held out:", set));
    let rows: Vec<Vec<String>> = train.chain(test).collect();
    format_table(&heading, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auroc_is_the_share_of_ordered_pairs() {
        let rated = [(-2.0, false), (-1.0, true), (0.5, false), (3.0, true)];
        assert_eq!(auroc(&rated), Some(0.75));
        assert_eq!(auroc(&rated[..1]), None);
    }
}
