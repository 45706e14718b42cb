//! Every question of every fold, so that anybody can compute the figures anew.

use super::fold_data::FoldData;
use super::fold_result::FoldResult;
use crate::csv;
use evaluation::recogniser::Answer;

/// Heads of the columns.
const HEADS: [&str; 7] = [
    "fold",
    "view",
    "truth",
    "prediction",
    "distance",
    "novelty",
    "open_set",
];

/// A line for each question; an empty prediction is "unknown", an empty view and truth
/// are those of a candidate that is no object.
pub(super) fn csv(results: &[FoldResult], data: &FoldData) -> String {
    let views = &data.views;
    let name = |category: u32| views.categories[category as usize].as_str();
    let line = |fold: usize, view: Option<usize>, answer: &Answer, open_set: &str| {
        csv::line(&[
            &fold.to_string(),
            view.map_or("", |view| &views.files[view]),
            view.map_or("", |view| name(views.labels[view].category)),
            answer.category.map_or("", name),
            &answer.distance.to_string(),
            &answer.novelty.to_string(),
            open_set,
        ])
    };
    let mut log = csv::line(&HEADS);
    for (fold, result) in results.iter().enumerate() {
        for (questions, open_set) in [(&result.answers, "0"), (&result.open, "1")] {
            for (view, answer) in questions {
                log += &line(fold, Some(*view), answer, open_set);
            }
        }
        for answer in &result.clutter {
            log += &line(fold, None, answer, "0");
        }
    }
    log
}
