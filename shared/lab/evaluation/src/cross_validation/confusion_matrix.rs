//! Confusion matrix and the classification scores derived from it.

/// Confusion matrix with a column for "unknown".
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfusionMatrix {
    n_categories: usize,
    /// *Shape*: `n_categories x (n_categories + 1)`, row-major: a row per true category, a column
    /// per answer, the last one for "unknown".
    counts: Vec<u32>,
}

/// Accuracy and F1 over all answers, micro and macro averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClassificationScores {
    /// Share of right answers (micro average).
    pub accuracy_micro: f64,
    /// Mean over the categories of their share of right answers (macro average).
    pub accuracy_macro: f64,
    /// Micro-averaged F1; "unknown" is a false negative, but no false positive.
    pub f1_micro: f64,
    /// Mean of the categories' F1 (macro average).
    pub f1_macro: f64,
}

impl ConfusionMatrix {
    /// Empty confusion matrix of `n_categories` categories.
    pub fn new(n_categories: usize) -> Self {
        Self {
            n_categories,
            counts: vec![0; n_categories * (n_categories + 1)],
        }
    }

    /// Counts one answer to a view of a true category; `None` is "unknown". `truth` and
    /// `answer` are category numbers.
    pub fn count(&mut self, truth: u32, answer: Option<u32>) {
        let column = answer.map_or(self.n_categories, |answer| answer as usize);
        self.counts[truth as usize * (self.n_categories + 1) + column] += 1;
    }

    /// Number of categories of the confusion matrix.
    pub fn n_categories(&self) -> usize {
        self.n_categories
    }

    /// Answer counts of a true category: one per category, the last one for "unknown".
    pub fn row(&self, truth: usize) -> &[u32] {
        let width = self.n_categories + 1;
        &self.counts[truth * width..][..width]
    }

    /// Scores over the categories that were tested. `None` without any answer.
    pub fn scores(&self) -> Option<ClassificationScores> {
        let asked = (0..self.n_categories).filter(|&truth| self.n_asked(truth) > 0);
        let asked: Vec<usize> = asked.collect();
        let mean = |value: &dyn Fn(usize) -> f64| {
            asked.iter().map(|&truth| value(truth)).sum::<f64>() / asked.len() as f64
        };
        let n: f64 = asked
            .iter()
            .map(|&truth| f64::from(self.n_asked(truth)))
            .sum();
        let n_right: f64 = asked
            .iter()
            .map(|&truth| f64::from(self.n_right(truth)))
            .sum();
        let n_unknown: u32 = asked.iter().map(|&t| self.row(t)[self.n_categories]).sum();
        (!asked.is_empty()).then(|| ClassificationScores {
            accuracy_micro: n_right / n,
            accuracy_macro: mean(&|t| f64::from(self.n_right(t)) / f64::from(self.n_asked(t))),
            // F1 = 2 TP / (answers given + answers wanted).
            f1_micro: 2.0 * n_right / (2.0 * n - f64::from(n_unknown)),
            f1_macro: mean(&|t| {
                let wanted_and_given = self.n_asked(t) + self.n_answered(t);
                2.0 * f64::from(self.n_right(t)) / f64::from(wanted_and_given)
            }),
        })
    }

    fn n_right(&self, category: usize) -> u32 {
        self.row(category)[category]
    }

    fn n_asked(&self, truth: usize) -> u32 {
        self.row(truth).iter().sum()
    }

    fn n_answered(&self, answer: usize) -> u32 {
        (0..self.n_categories)
            .map(|truth| self.row(truth)[answer])
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn confusion(answers: &[(u32, Option<u32>, u32)]) -> ConfusionMatrix {
        let mut confusion = ConfusionMatrix::new(3);
        for &(truth, answer, n) in answers {
            (0..n).for_each(|_| confusion.count(truth, answer));
        }
        confusion
    }

    #[test]
    fn scores_agree_with_a_hand_computed_case() {
        // Right answers: 8 of 10 in category 0, 2 of 2 in category 1, none in category 2.
        let confusion = confusion(&[
            (0, Some(0), 8),
            (0, Some(1), 1),
            (0, None, 1),
            (1, Some(1), 2),
            (2, Some(0), 4),
        ]);
        let scores = confusion.scores().unwrap();
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12);
        close(scores.accuracy_micro, 10.0 / 16.0);
        close(scores.accuracy_macro, (0.8 + 1.0 + 0.0) / 3.0);
        // TP = 10, FP = 5, FN = 6.
        close(scores.f1_micro, 20.0 / (20.0 + 5.0 + 6.0));
        close(scores.f1_macro, (16.0 / 22.0 + 4.0 / 5.0 + 0.0) / 3.0);
        assert_eq!(confusion.row(0), [8, 1, 0, 1]);
    }

    #[test]
    fn without_unknowns_micro_f1_is_accuracy() {
        let confusion = confusion(&[(0, Some(0), 3), (0, Some(2), 4), (1, Some(1), 5)]);
        let scores = confusion.scores().unwrap();
        assert_eq!(scores.f1_micro, scores.accuracy_micro);
        // Category 2 has no test views.
        assert!((scores.accuracy_macro - 5.0 / 7.0).abs() < 1e-12);
        assert_eq!(ConfusionMatrix::new(3).scores(), None);
    }
}
