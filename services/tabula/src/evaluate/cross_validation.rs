//! `tabula evaluate cross-validation`: each part of the views is asked of who was
//! taught the rest.

mod document;
mod report;

use super::object_views::ViewTable;
use super::variant::{Learner, described};
use super::whole_file::{make_folder, write};
use super::{csv, failed, parallel};
use crate::arguments::{CrossValidationArguments, ViewProtocol};
use crate::output::Output;
use crate::simulate::progress;
use document::Document;
use evaluation::cross_validation::{Confusion, Dealing, Folds, confusion_svg};
use evaluation::recogniser::Answer;
use service::{Failure, exit_code};
use std::process::ExitCode;
use std::time::Instant;

/// Heads of the columns of the log.
const HEADS: [&str; 5] = ["fold", "view", "truth", "prediction", "distance"];

/// What came out of one fold.
struct FoldResult {
    n_taught: usize,
    /// Views that were asked, and the answers.
    answers: Vec<(usize, Answer)>,
    teach_ms: f64,
    ask_ms: f64,
}

/// Plays all folds, and scores and draws the answers.
pub(super) fn run(
    arguments: &CrossValidationArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (views, learner) = described(&arguments.description, output)?;
    let dealing = dealing(arguments, &views);
    let folds = Folds::deal(&views.labels, arguments.folds, dealing, arguments.seed)
        .map_err(|error| Failure::new(exit_code::USAGE, error))?;
    make_folder(&arguments.out)?;
    let bar = progress::bar(arguments.folds.into(), "folds", output);
    let results = parallel::map(
        folds.n_folds as usize,
        &bar,
        || (),
        |(), fold| play(learner.as_ref(), &views, &folds, fold as u32),
    );
    bar.finish_and_clear();
    let results = results?;
    let mut confusion = Confusion::new(views.categories.len());
    for (view, answer) in results.iter().flat_map(|result| &result.answers) {
        confusion.count(views.labels[*view].category, answer.category);
    }
    let svg = confusion_svg(&confusion, &views.categories).map_err(failed)?;
    write(&arguments.out.join("confusion.svg"), svg.as_bytes())?;
    if let Some(path) = &arguments.log {
        write(path, log(&results, &views).as_bytes())?;
    }
    let document = Document::of(arguments, dealing, &folds, &views, &results, &confusion)
        .ok_or_else(|| failed("no view was asked"))?;
    let json = serde_json::to_string_pretty(&document).map_err(failed)?;
    write(
        &arguments.out.join("cross-validation.json"),
        json.as_bytes(),
    )?;
    let page = report::page(&document);
    write(&arguments.out.join("index.html"), page.as_bytes())?;
    output.answer(&document, || report::text(&document));
    Ok(ExitCode::SUCCESS)
}

/// Object by object where objects are known, unless something else is wished.
fn dealing(arguments: &CrossValidationArguments, views: &ViewTable) -> Dealing {
    let is_known = views.labels.iter().any(|view| view.instance.is_some());
    match arguments.protocol {
        _ if arguments.contiguous => Dealing::Contiguous,
        Some(ViewProtocol::InstanceDisjoint) => Dealing::ByInstance,
        None if is_known => Dealing::ByInstance,
        Some(ViewProtocol::View) | None => Dealing::ByView,
    }
}

fn play(learner: &dyn Learner, views: &ViewTable, folds: &Folds, fold: u32) -> FoldResult {
    let mut recogniser = learner.recogniser();
    let begin = Instant::now();
    let mut asked = Vec::new();
    for (view, (label, &of_view)) in views.labels.iter().zip(&folds.of_view).enumerate() {
        if of_view == fold {
            asked.push(view);
        } else {
            recogniser.teach(label.category, view);
        }
    }
    let teach_ms = begin.elapsed().as_secs_f64() * 1e3;
    let n_taught = views.labels.len() - asked.len();
    let begin = Instant::now();
    let answers = asked.into_iter().map(|view| (view, recogniser.ask(view)));
    FoldResult {
        n_taught,
        answers: answers.collect(),
        teach_ms,
        ask_ms: begin.elapsed().as_secs_f64() * 1e3,
    }
}

/// A line for each question; an empty prediction is "unknown".
fn log(results: &[FoldResult], views: &ViewTable) -> String {
    let name = |category: u32| views.categories[category as usize].as_str();
    let mut log = csv::line(&HEADS);
    for (fold, result) in results.iter().enumerate() {
        for (view, answer) in &result.answers {
            log += &csv::line(&[
                &fold.to_string(),
                &views.files[*view],
                name(views.labels[*view].category),
                answer.category.map_or("", name),
                &answer.distance.to_string(),
            ]);
        }
    }
    log
}

#[cfg(test)]
mod tests;
