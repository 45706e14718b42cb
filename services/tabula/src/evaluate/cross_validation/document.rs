//! The figures of `tabula evaluate cross-validation` as a document.

use super::super::object_views::ViewTable;
use super::super::variant::DescriptionSettings;
use super::FoldResult;
use crate::arguments::CrossValidationArguments;
use evaluation::cross_validation::{Confusion, Dealing, Folds};
use serde::Serialize;
use std::collections::BTreeMap;

/// All figures.
#[derive(Debug, Serialize)]
pub(super) struct Document {
    version: &'static str,
    dataset: String,
    pub(super) n_views: usize,
    pub(super) n_categories: usize,
    pub(super) accuracy_micro: f64,
    pub(super) accuracy_macro: f64,
    pub(super) f1_micro: f64,
    pub(super) f1_macro: f64,
    pub(super) folds: Vec<FoldFigures>,
    /// Share of right answers by category.
    pub(super) categories: BTreeMap<String, CategoryFigures>,
    pub(super) settings: Settings,
    n_left_out: usize,
    pub(super) left_out: Vec<String>,
    pub(super) timing: Timing,
    pub(super) page: String,
    pub(super) file: String,
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

impl Document {
    /// `None` when nothing was asked.
    pub(super) fn of(
        arguments: &CrossValidationArguments,
        dealing: Dealing,
        folds: &Folds,
        views: &ViewTable,
        results: &[FoldResult],
        confusion: &Confusion,
    ) -> Option<Self> {
        let scores = confusion.scores()?;
        let path = |name: &str| arguments.out.join(name).display().to_string();
        let names = views.categories.iter().enumerate();
        Some(Self {
            version: env!("CARGO_PKG_VERSION"),
            dataset: arguments.description.dataset.display().to_string(),
            n_views: views.labels.len(),
            n_categories: views.categories.len(),
            accuracy_micro: scores.accuracy_micro,
            accuracy_macro: scores.accuracy_macro,
            f1_micro: scores.f1_micro,
            f1_macro: scores.f1_macro,
            folds: results
                .iter()
                .map(|result| FoldFigures::of(result, views))
                .collect(),
            categories: names
                .map(|(index, name)| (name.clone(), CategoryFigures::of(index, views, confusion)))
                .collect(),
            settings: Settings::of(arguments, dealing, folds),
            n_left_out: views.left_out.n,
            left_out: views.left_out.sentences(),
            timing: Timing::of(views, results),
            page: path("index.html"),
            file: path("cross-validation.json"),
        })
    }
}

impl FoldFigures {
    fn of(result: &FoldResult, views: &ViewTable) -> Self {
        let is_right = |(view, answer): &&(usize, evaluation::recogniser::Answer)| {
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
    fn of(index: usize, views: &ViewTable, confusion: &Confusion) -> Self {
        let row = confusion.row(index);
        let wrong = row.iter().enumerate();
        let wrong = wrong.filter(|&(answer, &count)| answer != index && count > 0);
        // Of equally frequent ones the first.
        let most = wrong.rev().max_by_key(|(_, count)| **count);
        Self {
            n_asked: row.iter().sum(),
            n_right: row[index],
            taken_for: most.and_then(|(answer, _)| views.categories.get(answer).cloned()),
        }
    }
}

impl Settings {
    fn of(arguments: &CrossValidationArguments, dealing: Dealing, folds: &Folds) -> Self {
        Self {
            description: DescriptionSettings::of(&arguments.description),
            folds: match dealing {
                Dealing::ByView => "view",
                Dealing::ByInstance => "instance-disjoint",
                Dealing::Contiguous => "contiguous",
            },
            n_grouped: folds.n_grouped,
            seed: arguments.seed,
        }
    }
}

impl Timing {
    fn of(views: &ViewTable, results: &[FoldResult]) -> Self {
        let sum = |ms: fn(&FoldResult) -> f64| results.iter().map(ms).sum::<f64>();
        let ask_ms = sum(|result| result.ask_ms);
        Self {
            describe_ms: views.describe_ms,
            ask_ms: ask_ms / views.labels.len().max(1) as f64,
            teach_s: 1e-3 * sum(|result| result.teach_ms),
            test_s: 1e-3 * ask_ms,
        }
    }
}
