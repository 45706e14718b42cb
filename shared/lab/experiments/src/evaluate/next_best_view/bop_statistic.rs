//! Published statistic on a BOP scene of the user.

use super::bop_capture;
use super::published_statistic::SceneStatistic;
use super::statistic_report::{self, KindReport, KindScenes, STATISTIC};
use crate::arguments::NextBestViewArguments;
use crate::evaluate::tabular_report::{TabularReport, figure};
use crate::output_files::write_figure;
use command_line::Output;
use serde::Serialize;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;

/// Report of a BOP scene.
#[derive(Debug, Serialize)]
struct BopReport {
    version: &'static str,
    seed: u64,
    bop: String,
    bop_models: String,
    published_statistic: Vec<KindReport>,
}

/// Runs the statistic on a scene with its folder of models, and reports it.
pub(super) fn run(
    arguments: &NextBestViewArguments,
    folder: &Path,
    models: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let views = bop_capture::read(folder, models, arguments.seed)?;
    let kind = KindScenes {
        kind: "bop",
        paper: None,
        scenes: vec![SceneStatistic::of(&views)],
    };
    let report = BopReport {
        version: env!("CARGO_PKG_VERSION"),
        seed: arguments.seed,
        bop: folder.display().to_string(),
        bop_models: models.display().to_string(),
        published_statistic: vec![KindReport::of(&kind)],
    };
    write_figure(&arguments.out, STATISTIC, statistic_report::figure(&[kind]))?;
    let page = TabularReport {
        title: "Next best view of a BOP scene",
        tables: vec![statistic_report::table(&report.published_statistic)],
        notes: notes(&report),
        figures: vec![figure(STATISTIC, statistic_report::CAPTION)],
        ..TabularReport::default()
    };
    page.publish(&arguments.out, "next-best-view.json", &report, output)
}

fn notes(report: &BopReport) -> Vec<String> {
    let mut notes = vec![format!(
        "scene {} with the models {}; seed {}",
        report.bop, report.bop_models, report.seed
    )];
    notes.extend(statistic_report::notes(&report.published_statistic));
    notes
}

#[cfg(test)]
mod scene_writer;
#[cfg(test)]
mod tests;
