//! Report of the cross-validation.

use super::end_to_end_score::EndToEndScore;
use super::fold_data::FoldData;
use super::fold_result::FoldResult;
use crate::arguments::CrossValidationArguments;
use crate::evaluate::recognition::DescriptionSettings;
use crate::evaluate::report_parts::{OmissionSummary, ReportFiles, ReportHeader};
use crate::evaluate::view_table::ViewTable;
use control_protocol::QuestionKind;
use evaluation::answer_score::{AnswerScore, Question};
use evaluation::calibration_score::expected_calibration_error;
use evaluation::cross_validation::ConfusionMatrix;
use evaluation::new_side_score::{NamedAnswer, NewSideScore};
use evaluation::novelty_score::NoveltyScore;
use evaluation::recogniser::Answer;
use serde::Serialize;
use std::collections::BTreeMap;

/// Report of a cross-validation.
#[derive(Debug, Serialize)]
pub(super) struct CrossValidationReport {
    #[serde(flatten)]
    pub(super) header: ReportHeader,
    pub(super) accuracy_micro: f64,
    pub(super) accuracy_macro: f64,
    pub(super) f1_micro: f64,
    pub(super) f1_macro: f64,
    /// Share of the questions whose category is among the three best.
    pub(super) top3: f64,
    /// Expected calibration error of the probabilities, over all questions; null if the
    /// recogniser tells none.
    pub(super) calibration_error: Option<f64>,
    /// The three answers, with the prior of novelty learned from corrections; null if the
    /// recogniser tells no probabilities.
    pub(super) answers: Option<AnswerScore>,
    pub(super) folds: Vec<FoldFigures>,
    /// Accuracy of each category, by name.
    pub(super) categories: BTreeMap<String, CategoryFigures>,
    /// Open-set metrics over the views of withheld categories.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) open_set: Option<NoveltyScore>,
    /// Telling new objects from new sides; only with folds by side and withheld categories.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) new_sides: Option<NewSideScore>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) scenes: Option<EndToEndScore>,
    pub(super) settings: Settings,
    #[serde(flatten)]
    pub(super) omissions: OmissionSummary,
    pub(super) timing: Timing,
    #[serde(flatten)]
    pub(super) files: ReportFiles,
}

/// Answer counts and accuracy of one fold.
#[derive(Debug, Serialize)]
pub(super) struct FoldFigures {
    pub(super) n_taught: usize,
    pub(super) n_asked: usize,
    pub(super) accuracy: Option<f64>,
}

/// Answer counts of one category.
#[derive(Debug, Serialize)]
pub(super) struct CategoryFigures {
    pub(super) n_asked: u32,
    pub(super) n_right: u32,
    /// Number of objects that detection missed; only for scenes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) n_missed: Option<u32>,
    /// Number of false candidates that are parts of the category's object; only for scenes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) n_parts: Option<u32>,
    /// Most frequent wrong answer; null for "unknown" and if all answers were right.
    pub(super) taken_for: Option<String>,
}

/// Settings of the cross-validation.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    #[serde(flatten)]
    pub(super) description: DescriptionSettings,
    /// Name of the rule that assigned views to folds.
    pub(super) folds: &'static str,
    /// Number of views of different sides asked together.
    pub(super) n_sides: u32,
    /// Number of categories whose views are grouped by object.
    pub(super) n_grouped: usize,
    open_set_share: f64,
    seed: u64,
}

/// Durations on one thread; the only values that vary between repetitions.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Timing {
    /// Mean time to describe one view, milliseconds.
    pub(super) describe_ms: f64,
    /// Mean time to recognise one view, milliseconds.
    pub(super) ask_ms: f64,
    /// Total time of teaching over all folds, seconds.
    teach_s: f64,
    /// Total time of testing over all folds, seconds.
    pub(super) test_s: f64,
}

impl CrossValidationReport {
    /// Report of the fold results; `None` if no view of a taught category was asked.
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
            top3: top3(results, views),
            calibration_error: calibration_error(results, views),
            answers: answers(results, views, arguments.seed),
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
            new_sides: new_sides(data, results),
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

fn top3(results: &[FoldResult], views: &ViewTable) -> f64 {
    let answers = results.iter().flat_map(|fold| &fold.answers);
    let is_right =
        |(view, answer): &&(usize, Answer)| answer.is_among_best(views.labels[*view].category);
    answers.clone().filter(is_right).count() as f64 / answers.count().max(1) as f64
}

/// Expected calibration error of all answers; a withheld category makes any answer wrong.
fn calibration_error(results: &[FoldResult], views: &ViewTable) -> Option<f64> {
    let known = results.iter().flat_map(|fold| &fold.answers);
    let known = known.filter_map(|(view, answer)| {
        let is_right = answer.best[0] == Some(views.labels[*view].category);
        Some((answer.probability?, is_right))
    });
    let open = results.iter().flat_map(|fold| &fold.open);
    let open = open.filter_map(|(_, answer)| Some((answer.probability?, false)));
    expected_calibration_error(known.chain(open))
}

/// Score of the three answers; each fold is a run.
fn answers(results: &[FoldResult], views: &ViewTable, seed: u64) -> Option<AnswerScore> {
    let run = |fold: &FoldResult| {
        let known = fold.answers.iter().map(|(view, answer)| Question {
            answer: *answer,
            truth: Some(views.labels[*view].category),
        });
        let open = fold.open.iter().map(|(_, answer)| Question {
            answer: *answer,
            truth: None,
        });
        known.chain(open).collect()
    };
    let runs: Vec<Vec<Question>> = results.iter().map(run).collect();
    AnswerScore::of(&runs, pipeline::Config::KNOWN_PROBABILITY_MIN, seed)
}

/// Open-set metrics of the answers of all folds.
fn novelty(results: &[FoldResult]) -> Option<NoveltyScore> {
    let answers = |of_fold: fn(&FoldResult) -> &[(usize, Answer)]| -> Vec<Answer> {
        let questions = results.iter().flat_map(of_fold);
        questions.map(|(_, answer)| *answer).collect()
    };
    NoveltyScore::of(
        &answers(|fold| &fold.open),
        &answers(|fold| &fold.answers),
        pipeline::Config::KNOWN_PROBABILITY_MIN,
    )
}

/// Score of the question "new object or new side?" by the rule of the live system.
fn new_sides(data: &FoldData, results: &[FoldResult]) -> Option<NewSideScore> {
    if data.fold_assignment != "other-side" {
        return None;
    }
    let objects = results.iter().flat_map(|fold| &fold.open);
    let objects: Vec<Answer> = objects.map(|(_, answer)| *answer).collect();
    let sides = results.iter().flat_map(|fold| &fold.answers);
    let named = |(view, answer): &(usize, Answer)| {
        let category = data.views.labels[*view].category;
        (*answer, answer.best[0] == Some(category))
    };
    let sides: Vec<NamedAnswer> = sides.map(named).collect();
    let is_new_object = |probability: f32| {
        QuestionKind::of_unknown(f64::from(probability)) == QuestionKind::NewObject
    };
    let known_probability_min = pipeline::Config::KNOWN_PROBABILITY_MIN;
    NewSideScore::of(&objects, &sides, known_probability_min, is_new_object)
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
        // Ties go to the first category.
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
            folds: data.fold_assignment,
            n_sides: arguments.sides,
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
