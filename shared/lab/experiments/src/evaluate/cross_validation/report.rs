//! The figures of `tabula evaluate cross-validation` as a document.

use super::end_to_end_score::EndToEndScore;
use super::fold_data::FoldData;
use super::fold_result::FoldResult;
use crate::arguments::CrossValidationArguments;
use crate::evaluate::recognition::DescriptionSettings;
use crate::evaluate::report_parts::{OmissionSummary, ReportFiles, ReportHeader};
use crate::evaluate::view_table::ViewTable;
use evaluation::cross_validation::ConfusionMatrix;
use evaluation::novelty_score::NoveltyScore;
use evaluation::recogniser::Answer;
use serde::Serialize;
use std::collections::BTreeMap;

/// All figures.
#[derive(Debug, Serialize)]
pub(super) struct CrossValidationReport {
    #[serde(flatten)]
    pub(super) header: ReportHeader,
    pub(super) accuracy_micro: f64,
    pub(super) accuracy_macro: f64,
    pub(super) f1_micro: f64,
    pub(super) f1_macro: f64,
    pub(super) folds: Vec<FoldFigures>,
    /// Share of right answers by category.
    pub(super) categories: BTreeMap<String, CategoryFigures>,
    /// Of the views of categories that were not taught in their fold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) open_set: Option<NoveltyScore>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) scenes: Option<EndToEndScore>,
    pub(super) settings: Settings,
    #[serde(flatten)]
    pub(super) omissions: OmissionSummary,
    pub(super) timing: Timing,
    #[serde(flatten)]
    pub(super) files: ReportFiles,
}

/// One fold.
#[derive(Debug, Serialize)]
pub(super) struct FoldFigures {
    pub(super) n_taught: usize,
    pub(super) n_asked: usize,
    pub(super) accuracy: Option<f64>,
}

/// One category.
#[derive(Debug, Serialize)]
pub(super) struct CategoryFigures {
    pub(super) n_asked: u32,
    pub(super) n_right: u32,
    /// Objects in scenes that detection did not find.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) n_missed: Option<u32>,
    /// False candidates in scenes that are parts of its object.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) n_parts: Option<u32>,
    /// What it was most often taken for when it was not recognised; null for "unknown"
    /// and when all answers were right.
    pub(super) taken_for: Option<String>,
}

/// How the figures were made.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    #[serde(flatten)]
    pub(super) description: DescriptionSettings,
    /// How the views were dealt out.
    pub(super) folds: &'static str,
    /// Categories of which the views of an object stay together.
    pub(super) n_grouped: usize,
    open_set_share: f64,
    seed: u64,
}

/// Durations on one thread; the only figures that differ from time to time.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Timing {
    /// Mean of a view.
    pub(super) describe_ms: f64,
    /// Mean of a view.
    pub(super) ask_ms: f64,
    /// Sum over all folds.
    teach_s: f64,
    /// Sum over all folds.
    pub(super) test_s: f64,
}

impl CrossValidationReport {
    /// `None` when nothing was asked.
    pub(super) fn of(
        arguments: &CrossValidationArguments,
        data: &FoldData,
        results: &[FoldResult],
        confusion: &ConfusionMatrix,
    ) -> Option<Self> {
        let views = &data.views;
        let scores = confusion.scores()?;
        let names = views.categories.iter().enumerate();
        Some(Self {
            header: ReportHeader::new(data.source.clone(), views),
            accuracy_micro: scores.accuracy_micro,
            accuracy_macro: scores.accuracy_macro,
            f1_micro: scores.f1_micro,
            f1_macro: scores.f1_macro,
            folds: results
                .iter()
                .map(|result| FoldFigures::of(result, views))
                .collect(),
            categories: names
                .map(|(index, name)| {
                    let figures = CategoryFigures::of(index, data, confusion);
                    (name.clone(), figures)
                })
                .collect(),
            open_set: novelty(results),
            scenes: data
                .scenes
                .as_ref()
                .map(|scenes| EndToEndScore::of(scenes, results, confusion)),
            settings: Settings::of(arguments, data),
            omissions: views.into(),
            timing: Timing::of(views, results),
            files: ReportFiles::in_folder(&arguments.out, "cross-validation.json"),
        })
    }
}

/// Of the answers of all folds.
fn novelty(results: &[FoldResult]) -> Option<NoveltyScore> {
    let answers = |of_fold: fn(&FoldResult) -> &[(usize, Answer)]| -> Vec<Answer> {
        let questions = results.iter().flat_map(of_fold);
        questions.map(|(_, answer)| *answer).collect()
    };
    NoveltyScore::of(&answers(|fold| &fold.open), &answers(|fold| &fold.answers))
}

impl FoldFigures {
    fn of(result: &FoldResult, views: &ViewTable) -> Self {
        let is_right = |(view, answer): &&(usize, Answer)| {
            answer.category == Some(views.labels[*view].category)
        };
        let n_asked = result.answers.len();
        let n_right = result.answers.iter().filter(is_right).count();
        Self {
            n_taught: result.n_taught,
            n_asked,
            accuracy: (n_asked > 0).then(|| n_right as f64 / n_asked as f64),
        }
    }
}

impl CategoryFigures {
    fn of(index: usize, data: &FoldData, confusion: &ConfusionMatrix) -> Self {
        let categories = &data.views.categories;
        let row = confusion.row(index);
        let wrong = row.iter().enumerate();
        let wrong = wrong.filter(|&(answer, &count)| answer != index && count > 0);
        // Of equally frequent ones the first.
        let most = wrong.rev().max_by_key(|(_, count)| **count);
        let n_asked = row.iter().sum();
        let scenes = data.scenes.as_ref();
        Self {
            n_asked,
            n_right: row[index],
            n_missed: scenes.map(|scenes| scenes.n_visible[index].saturating_sub(n_asked)),
            n_parts: scenes.map(|scenes| scenes.n_parts[index]),
            taken_for: most.and_then(|(answer, _)| categories.get(answer).cloned()),
        }
    }
}

impl Settings {
    fn of(arguments: &CrossValidationArguments, data: &FoldData) -> Self {
        Self {
            description: DescriptionSettings::of(&arguments.description),
            folds: data.dealing,
            n_grouped: data.folds.n_grouped,
            open_set_share: arguments.open_set_share,
            seed: arguments.seed,
        }
    }
}

impl Timing {
    fn of(views: &ViewTable, results: &[FoldResult]) -> Self {
        let sum = |ms: fn(&FoldResult) -> f64| results.iter().map(ms).sum::<f64>();
        let ask_ms = sum(|result| result.ask_ms);
        let n_asked =
            |result: &FoldResult| result.answers.len() + result.open.len() + result.clutter.len();
        let n_asked: usize = results.iter().map(n_asked).sum();
        Self {
            describe_ms: views.describe_ms,
            ask_ms: ask_ms / n_asked.max(1) as f64,
            teach_s: 1e-3 * sum(|result| result.teach_ms),
            test_s: 1e-3 * ask_ms,
        }
    }
}
