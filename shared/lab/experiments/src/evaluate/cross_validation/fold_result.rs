//! One cross-validation fold: training on the other folds, test on this one.

use super::fold_data::FoldData;
use crate::arguments::CrossValidationArguments;
use evaluation::cross_validation::{view_groups, withheld_categories};
use evaluation::recogniser::Answer;
use std::time::Instant;

/// Answers and timings of one fold.
pub(super) struct FoldResult {
    pub(super) n_taught: usize,
    /// Questions about taught categories, by their first view, with the answers.
    pub(super) answers: Vec<(usize, Answer)>,
    /// Questions about withheld categories, by their first view, with the answers.
    pub(super) open: Vec<(usize, Answer)>,
    /// Answers to false candidates (clutter).
    pub(super) clutter: Vec<Answer>,
    pub(super) teach_ms: f64,
    pub(super) ask_ms: f64,
}

/// Trains on all views outside the fold and the withheld categories, and tests the views of the
/// fold.
pub(super) fn run_fold(
    data: &FoldData,
    fold: u32,
    arguments: &CrossValidationArguments,
) -> FoldResult {
    let (views, folds) = (&data.views, &data.folds);
    let mut recogniser = data.recogniser_factory.recogniser();
    let n_categories = views.categories.len();
    let is_withheld =
        withheld_categories(n_categories, arguments.open_set_share, fold, arguments.seed);
    let begin = Instant::now();
    let (mut known, mut unknown, mut n_taught) = (Vec::new(), Vec::new(), 0);
    for (view, (label, &of_view)) in views.labels.iter().zip(&folds.of_view).enumerate() {
        match (of_view == fold, is_withheld[label.category as usize]) {
            (true, false) => known.push(view),
            (true, true) => unknown.push(view),
            (false, false) => {
                recogniser.teach(label.category, view);
                n_taught += 1;
            }
            (false, true) => {}
        }
    }
    let teach_ms = begin.elapsed().as_secs_f64() * 1e3;
    let begin = Instant::now();
    let mut asked = |sides: Vec<usize>| (sides[0], recogniser.ask_sides(&sides));
    let groups = |asked: &[usize]| view_groups(&views.labels, asked, arguments.sides as usize);
    FoldResult {
        n_taught,
        answers: groups(&known).into_iter().map(&mut asked).collect(),
        open: groups(&unknown).into_iter().map(&mut asked).collect(),
        clutter: clutter(data, fold)
            .map(|view| asked(vec![view]).1)
            .collect(),
        teach_ms,
        ask_ms: begin.elapsed().as_secs_f64() * 1e3,
    }
}

/// Indices of the fold's false candidates, which follow the views.
fn clutter(data: &FoldData, fold: u32) -> impl Iterator<Item = usize> {
    let n_views = data.views.labels.len();
    let scenes = data.scenes.iter();
    let folds = scenes.flat_map(|scenes| &scenes.folds_of_clutter);
    let of_fold = folds
        .enumerate()
        .filter(move |(_, of_view)| **of_view == fold);
    of_fold.map(move |(index, _)| n_views + index)
}
