//! CSV log of all questions and answers, from which the metrics can be recomputed.

use super::fold_data::FoldData;
use super::fold_result::FoldResult;
use crate::csv;
use evaluation::recogniser::Answer;

/// Column headings of the question log.
const HEADS: [&str; 9] = [
    "fold",
    "view",
    "truth",
    "prediction",
    "distance",
    "novelty",
    "probability",
    "known_probability",
    "open_set",
];

/// CSV lines, one for each question. An empty prediction is "unknown"; a false candidate has an
/// empty view and truth.
pub(super) fn csv(results: &[FoldResult], data: &FoldData) -> String {
    let views = &data.views;
    let number = |value: Option<f32>| value.map_or_else(String::new, |value| value.to_string());
    let name = |category: u32| views.categories[category as usize].as_str();
    let line = |fold: usize, view: Option<usize>, answer: &Answer, open_set: &str| {
        csv::line(&[
            &fold.to_string(),
            view.map_or("", |view| &views.files[view]),
            view.map_or("", |view| name(views.labels[view].category)),
            answer.category.map_or("", name),
            &answer.distance.to_string(),
            &answer.novelty.to_string(),
            &number(answer.probability),
            &number(answer.known_probability),
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
