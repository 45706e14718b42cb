//! Record of an open-ended run: questions, stages, metrics.

use crate::recogniser::Answer;
use serde::Serialize;

/// Question of an open-ended run with its answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// Number of the question in the run, from 1, including open-set questions.
    pub iteration: u32,
    /// Number of categories introduced before the question.
    pub n_categories: u32,
    /// Index of the view shown in the question.
    pub view: usize,
    /// True category of the view shown.
    pub truth: u32,
    /// `true` for an open-set question (category not introduced): "unknown" is right, and only
    /// novelty metrics count it.
    pub is_open_set: bool,
    /// Recogniser's answer to the question.
    pub answer: Answer,
    /// Protocol accuracy after the answer: micro F1 in the window of the stage.
    pub accuracy: Option<f64>,
}

impl Question {
    /// `true` if the answer is right.
    pub fn is_right(&self) -> bool {
        let right = (!self.is_open_set).then_some(self.truth);
        self.answer.category == right
    }
}

/// Reason for the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// All categories were learned successfully.
    AllLearned,
    /// Run stopped because the accuracy stayed below the threshold for too long.
    Stalled,
    /// Run stopped because a category has no unused view.
    LackOfData,
}

/// Cumulative figures at the end of a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageRecord {
    /// Number of categories introduced by the end of the stage.
    pub n_categories: u32,
    /// Number of questions since the start of the run.
    pub n_questions: u32,
    /// Share of right answers since the start of the run.
    pub accuracy: f64,
}

/// Metrics of an open-ended run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Metrics {
    /// Question/correction iterations (QCI): number of questions.
    pub qci: u32,
    /// Number of taught categories (TLC), including the one whose stage failed.
    pub tlc: u32,
    /// Average number of instances per category (AIC): taught views, including corrections, over
    /// categories.
    pub aic: f64,
    /// Global classification accuracy (GCA): right answers over questions. "Unknown" counts as
    /// wrong.
    pub gca: f64,
    /// Average protocol accuracy (APA): mean accuracy at the end of the stages, including a
    /// stalled one; `None` if no stage counts.
    pub apa: Option<f64>,
}

/// Complete record of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenEndedRun {
    /// Random seed of the run.
    pub seed: u64,
    /// Reason for the end of the run.
    pub stop: StopReason,
    /// All questions of the run in order.
    pub questions: Vec<Question>,
    /// All passed and failed stages in order.
    pub stages: Vec<StageRecord>,
    /// Protocol accuracies at the end of the stages, which enter the APA.
    pub stage_accuracies: Vec<f64>,
    /// Categories in the order of introduction, with the number of taught views.
    pub taught: Vec<(u32, u32)>,
    /// Number of views a category is introduced with.
    pub n_views_at_start: u32,
}

impl OpenEndedRun {
    /// Metrics of the run; GCA is 0 without questions.
    ///
    /// Invariant, with three views at the start: AIC = 3 + QCI (1 - GCA) / TLC.
    pub fn metrics(&self) -> Metrics {
        let counted = || {
            self.questions
                .iter()
                .filter(|question| !question.is_open_set)
        };
        let qci = counted().count() as u32;
        let n_right = counted().filter(|question| question.is_right()).count();
        let tlc = self.taught.len() as u32;
        let n_taught: u32 = self.taught.iter().map(|(_, n_views)| n_views).sum();
        let n_stages = self.stage_accuracies.len();
        let sum: f64 = self.stage_accuracies.iter().sum();
        Metrics {
            qci,
            tlc,
            aic: f64::from(n_taught) / f64::from(tlc.max(1)),
            gca: n_right as f64 / f64::from(qci.max(1)),
            apa: (n_stages > 0).then(|| sum / n_stages as f64),
        }
    }

    /// Answers to the open-set questions, or to the others.
    pub fn answers(&self, is_open_set: bool) -> impl Iterator<Item = Answer> {
        let of_kind = self.questions.iter();
        let of_kind = of_kind.filter(move |question| question.is_open_set == is_open_set);
        of_kind.map(|question| question.answer)
    }

    /// Number of corrections: one for each wrong answer.
    pub fn n_corrections(&self) -> u32 {
        let counted = self
            .questions
            .iter()
            .filter(|question| !question.is_open_set);
        counted.filter(|question| !question.is_right()).count() as u32
    }
}
