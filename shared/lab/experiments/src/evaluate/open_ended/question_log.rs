//! CSV log of all questions and answers, from which the metrics can be recomputed.

use crate::csv;
use crate::evaluate::view_table::ViewTable;
use evaluation::open_ended::{OpenEndedRun, Question};

/// Column headings of the question log.
const HEADS: [&str; 9] = [
    "run",
    "iteration",
    "categories",
    "view",
    "truth",
    "prediction",
    "distance",
    "open_set",
    "protocol_accuracy",
];

/// CSV lines, one for each question. A run is named by its seed; an empty prediction is "unknown";
/// numbers are written with full precision.
pub(super) fn csv(runs: &[OpenEndedRun], views: &ViewTable) -> String {
    let mut log = csv::line(&HEADS);
    for run in runs {
        let seed = run.seed.to_string();
        for question in &run.questions {
            log += &line(&seed, question, views);
        }
    }
    log
}

fn line(run: &str, question: &Question, views: &ViewTable) -> String {
    let name = |category: u32| views.categories[category as usize].as_str();
    let accuracy = question.accuracy.map(|accuracy| accuracy.to_string());
    csv::line(&[
        run,
        &question.iteration.to_string(),
        &question.n_categories.to_string(),
        &views.files[question.view],
        name(question.truth),
        question.answer.category.map_or("", name),
        &question.answer.distance.to_string(),
        if question.is_open_set { "1" } else { "0" },
        &accuracy.unwrap_or_default(),
    ])
}
