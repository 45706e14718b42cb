//! `tabula-lab evaluate cross-validation`: stratified k-fold cross-validation of recognition.

mod end_to_end_score;
mod fold_data;
mod fold_result;
mod question_log;
mod report;
mod report_page;

use super::scene_views;
use crate::arguments::CrossValidationArguments;
use crate::output_files::{create_folder, write, write_figure};
use crate::parallel;
use command_line::Output;
use evaluation::answer_score::risk_coverage_svg;
use evaluation::cross_validation::{ConfusionMatrix, confusion_matrix_svg};
use fold_data::FoldData;
use fold_result::{FoldResult, run_fold};
use report::CrossValidationReport;
use service::Failure;
use std::process::ExitCode;

/// Runs all folds; writes confusion matrix, log, page and JSON report.
pub(super) fn run(
    arguments: &CrossValidationArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out)?;
    if arguments.scenes.is_some() {
        create_folder(&arguments.out.join(scene_views::PICTURES))?;
    }
    let data = FoldData::of(arguments, output)?;
    let results = parallel::try_map(data.folds.n_folds as usize, "folds", output, |fold| {
        Ok(run_fold(&data, fold as u32, arguments))
    })?;
    write_all(arguments, &data, &results, output)
}

fn write_all(
    arguments: &CrossValidationArguments,
    data: &FoldData,
    results: &[FoldResult],
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (views, out) = (&data.views, &arguments.out);
    let mut confusion = ConfusionMatrix::new(views.categories.len());
    for (view, answer) in results.iter().flat_map(|result| &result.answers) {
        confusion.count(views.labels[*view].category, answer.category);
    }
    let svg = confusion_matrix_svg(&confusion, &views.categories);
    write_figure(out, "confusion.svg", svg)?;
    if let Some(path) = &arguments.log {
        write(path, question_log::csv(results, data).as_bytes())?;
    }
    let document = CrossValidationReport::of(arguments, data, results, &confusion)
        .ok_or_else(|| Failure::general("no view of a taught category was asked"))?;
    if let Some(answers) = &document.answers {
        write_figure(
            out,
            report_page::RISK_COVERAGE_FILE,
            risk_coverage_svg(answers),
        )?;
    }
    report_page::page(&document, data).publish(out, "cross-validation.json", &document, output)
}

#[cfg(test)]
mod tests;
