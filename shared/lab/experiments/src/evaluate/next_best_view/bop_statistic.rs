//! Published statistic on a BOP scene of the user.

use super::bop_capture::BopCapture;
use super::planner_config;
use super::published_statistic::SceneStatistic;
use super::statistic_report::{self, KindReport, KindScenes, STATISTIC, STATISTIC_HEADS};
use crate::arguments::NextBestViewArguments;
use crate::output_files::write;
use command_line::{Output, format_table};
use plot::figure_page::{PageFigure, PageTable, html};
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
    let BopCapture { scene, views } = BopCapture::read(folder, models)?;
    let config = planner_config(arguments);
    let kind = KindScenes {
        kind: "bop",
        paper: None,
        scenes: vec![SceneStatistic::of(&scene, &views, &config, arguments.seed)?],
    };
    let report = BopReport {
        version: env!("CARGO_PKG_VERSION"),
        seed: arguments.seed,
        bop: folder.display().to_string(),
        bop_models: models.display().to_string(),
        published_statistic: vec![KindReport::of(&kind)],
    };
    let (rows, notes) = (
        statistic_report::rows(&report.published_statistic),
        notes(&report),
    );
    let figure = statistic_report::figure(&[kind]).map_err(Failure::general)?;
    write(&arguments.out.join(STATISTIC), figure.as_bytes())?;
    let json = serde_json::to_string_pretty(&report).map_err(Failure::general)?;
    write(&arguments.out.join("next-best-view.json"), json.as_bytes())?;
    let table = PageTable::new("Published statistic", &STATISTIC_HEADS, rows.clone());
    let figure = PageFigure {
        caption: statistic_report::CAPTION.to_owned(),
        picture: STATISTIC.to_owned(),
    };
    let page = html("Next best view of a BOP scene", &notes, &[table], &[figure]);
    write(&arguments.out.join("index.html"), page.as_bytes())?;
    output.answer(&report, || {
        let table = format_table(&STATISTIC_HEADS, &rows);
        format!("{table}\n\n{}", notes.join("\n"))
    });
    Ok(ExitCode::SUCCESS)
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
