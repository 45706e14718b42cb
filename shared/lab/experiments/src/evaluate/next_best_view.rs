//! `tabula-lab evaluate next-best-view`: objects thrown into a bin are seen from all sides; the
//! entropy of the views is compared with detection and with its prediction, and views are chosen
//! until the objects are found.

mod bin_scene;
mod captured_view;
mod closed_loop;
mod entropy_prediction;
mod figures;
mod loop_method;
mod method_report;
mod object_hypotheses;
mod report;
mod report_page;
mod scene_result;
mod segment_matching;
mod view_pictures;

use crate::arguments::NextBestViewArguments;
use crate::output_files::{create_folder, write};
use crate::parallel;
use command_line::{Output, progress_bar};
use next_best_view::Config;
use report::NextBestViewReport;
use scene_result::SceneResult;
use service::Failure;
use simulated_world::ModelLibrary;
use std::path::Path;
use std::process::ExitCode;

/// Runs all scenes and reports the figures.
pub(super) fn run(arguments: &NextBestViewArguments, output: &Output) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out)?;
    let library = ModelLibrary::open(&arguments.models()).map_err(Failure::usage)?;
    let config = planner_config(arguments);
    let bar = progress_bar(u64::from(arguments.scenes), "scenes", output);
    let scenes = parallel::map(
        arguments.scenes as usize,
        &bar,
        || (),
        |(), number| scene_result::run(number, arguments, &config, &library),
    );
    bar.finish_and_clear();
    let scenes = scenes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let report = NextBestViewReport::of(arguments, &config, &scenes);
    write_all(&report, &scenes, &arguments.out)?;
    output.answer(&report, || report_page::text(&report));
    Ok(ExitCode::SUCCESS)
}

/// Settings of the planner: the defaults, with those of the command line.
fn planner_config(arguments: &NextBestViewArguments) -> Config {
    Config {
        sigma_share: arguments.sigma_share,
        visited_share: arguments.visited_share,
        gain_weight: arguments.gain_weight,
        ..Config::default()
    }
}

fn write_all(
    report: &NextBestViewReport,
    scenes: &[SceneResult],
    out: &Path,
) -> Result<(), Failure> {
    let mut pictures = Vec::new();
    for (name, svg) in figures::all(report, scenes)? {
        write(&out.join(name), svg.as_bytes())?;
        pictures.push(name.to_owned());
    }
    for (name, png) in scenes.iter().flat_map(|scene| &scene.pictures) {
        write(&out.join(name), png)?;
        pictures.push(name.clone());
    }
    let json = serde_json::to_string_pretty(report).map_err(Failure::general)?;
    write(&out.join("next-best-view.json"), json.as_bytes())?;
    let page = report_page::page(report, &pictures);
    write(&out.join("index.html"), page.as_bytes())
}

#[cfg(test)]
mod tests;
