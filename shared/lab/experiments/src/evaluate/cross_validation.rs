//! `tabula evaluate cross-validation`: each part of the views is asked of who was
//! taught the rest.

mod document;
mod fold_result;
mod log;
mod material;
mod report;
mod scene_figures;

use super::whole_file::{make_folder, write};
use super::{failed, parallel, scene_views};
use crate::arguments::CrossValidationArguments;
use command_line::{Output, progress_bar};
use document::Document;
use evaluation::cross_validation::{ConfusionMatrix, confusion_matrix_svg};
use fold_result::{FoldResult, play};
use material::Material;
use service::Failure;
use std::process::ExitCode;

/// Plays all folds, and scores and draws the answers.
pub(super) fn run(
    arguments: &CrossValidationArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    make_folder(&arguments.out)?;
    if arguments.scenes.is_some() {
        make_folder(&arguments.out.join(scene_views::PICTURES))?;
    }
    let material = Material::of(arguments, output)?;
    let bar = progress_bar(arguments.folds.into(), "folds", output);
    let results = parallel::map(
        material.folds.n_folds as usize,
        &bar,
        || (),
        |(), fold| play(&material, fold as u32, arguments),
    );
    bar.finish_and_clear();
    write_all(arguments, &material, &results?, output)?;
    Ok(ExitCode::SUCCESS)
}

fn write_all(
    arguments: &CrossValidationArguments,
    material: &Material,
    results: &[FoldResult],
    output: &Output,
) -> Result<(), Failure> {
    let (views, out) = (&material.views, &arguments.out);
    let mut confusion = ConfusionMatrix::new(views.categories.len());
    for (view, answer) in results.iter().flat_map(|result| &result.answers) {
        confusion.count(views.labels[*view].category, answer.category);
    }
    let svg = confusion_matrix_svg(&confusion, &views.categories).map_err(failed)?;
    write(&out.join("confusion.svg"), svg.as_bytes())?;
    if let Some(path) = &arguments.log {
        write(path, log::csv(results, material).as_bytes())?;
    }
    let document = Document::of(arguments, material, results, &confusion)
        .ok_or_else(|| failed("no view of a taught category was asked"))?;
    let json = serde_json::to_string_pretty(&document).map_err(failed)?;
    write(&out.join("cross-validation.json"), json.as_bytes())?;
    let page = report::page(&document, material);
    write(&out.join("index.html"), page.as_bytes())?;
    output.answer(&document, || report::text(&document));
    Ok(())
}

#[cfg(test)]
mod tests;
