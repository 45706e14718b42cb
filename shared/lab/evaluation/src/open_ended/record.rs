//! What happened in a run.

use crate::recogniser::Answer;

/// One question and its answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// From 1, over the whole run, open-set questions included.
    pub iteration: u32,
    /// How many categories were introduced.
    pub n_categories: u32,
    /// The view that was shown.
    pub view: usize,
    /// What it shows.
    pub truth: u32,
    /// Whether its category was not introduced: right is "unknown", and no figure
    /// but those of novelty counts the question.
    pub is_open_set: bool,
    /// What was answered.
    pub answer: Answer,
    /// Protocol accuracy after the answer: micro F1 in the window of the stage.
    pub accuracy: Option<f64>,
}

impl Question {
    /// Whether the answer is right.
    pub fn is_right(&self) -> bool {
        let right = (!self.is_open_set).then_some(self.truth);
        self.answer.category == right
    }
}

/// Why a run has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// All categories are learned.
    AllLearned,
    /// The accuracy stayed too low for too long.
    Stalled,
    /// A category has no fresh view.
    LackOfData,
}

/// How it stood when a stage ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// How many categories were introduced.
    pub n_categories: u32,
    /// Questions since the beginning of the run.
    pub n_questions: u32,
    /// Share of right answers since the beginning of the run.
    pub accuracy: f64,
}

/// The figures of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metrics {
    /// Question-correction iterations: how many questions were asked.
    pub qci: u32,
    /// Taught categories, the one included whose stage failed.
    pub tlc: u32,
    /// Average instances of a category: views that were taught, those of corrections
    /// included, over categories.
    pub aic: f64,
    /// Global classification accuracy: right answers over questions. "Unknown" is
    /// never right here.
    pub gca: f64,
    /// Average protocol accuracy: mean of the accuracies at which stages ended, that of
    /// the stalled one included; `None` when none counts.
    pub apa: Option<f64>,
}

/// A run from its first question to its last.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What it was drawn from.
    pub seed: u64,
    /// Why it has ended.
    pub stop: StopReason,
    /// All questions, in order.
    pub questions: Vec<Question>,
    /// All stages that were passed or have failed, in order.
    pub stages: Vec<Stage>,
    /// Accuracies that count for APA.
    pub stage_accuracies: Vec<f64>,
    /// Categories in the order of their introduction, and how many views of each were
    /// taught.
    pub taught: Vec<(u32, u32)>,
    /// Views that a category is introduced with.
    pub n_views_at_start: u32,
}

impl Run {
    /// The figures. Of a run without question GCA is 0.
    ///
    /// It holds that AIC is 3 + QCI (1 - GCA) / TLC, with three views at the start.
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

    /// The answers to its open-set questions, or to the others.
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
