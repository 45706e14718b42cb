//! `tabula-lab evaluate next-best-view`: objects thrown into a bin are seen from all sides; the
//! entropy of the views is compared with detection and with its prediction, and views are chosen
//! until the objects are found. The paper's statistic of the prediction is measured on a twin of
//! its scenes, or on a BOP scene.

mod bin_picking_twin;
mod bin_scene;
mod bop_capture;
mod bop_frame;
mod bop_statistic;
mod bop_world;
mod captured_view;
mod closed_loop;
mod entropy_prediction;
mod figures;
mod filled_depth;
mod findable_objects;
mod loop_method;
mod method_report;
mod noisy_truth;
mod object_recognition;
mod pose_accuracy;
mod prediction_source;
mod published_statistic;
mod report;
mod report_page;
mod scene_models;
mod scene_planner;
mod scene_result;
mod segment_matching;
mod simulated_bin;
mod statistic_report;
mod view_pictures;

use crate::arguments::NextBestViewArguments;
use crate::output_files::{create_folder, write, write_figure};
use crate::parallel;
use bin_picking_twin::TwinKind;
use command_line::Output;
use report::NextBestViewReport;
use service::Failure;
use simulated_world::ModelLibrary;
use statistic_report::{KindScenes, STATISTIC};
use std::process::ExitCode;
use view_planning::PlanSettings;

/// Runs all scenes and reports the figures.
pub(super) fn run(arguments: &NextBestViewArguments, output: &Output) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out)?;
    if let (Some(folder), Some(models)) = (&arguments.bop, &arguments.bop_models) {
        return bop_statistic::run(arguments, folder, models, output);
    }
    let library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
    let settings = PlanSettings {
        sigma_share: arguments.sigma_share,
        visited_share: arguments.visited_share,
        gain_weight: arguments.gain_weight,
        ..PlanSettings::default()
    };
    let scenes = parallel::try_map(arguments.scenes as usize, "scenes", output, |number| {
        scene_result::run(number, arguments, &settings, &library)
    })?;
    let twins = twins(arguments, output)?;
    let report = NextBestViewReport::of(arguments, &settings, &scenes, &twins);
    let mut figures = Vec::from(figures::all(&report, &scenes));
    if arguments.twin_scenes > 0 {
        figures.push((STATISTIC, statistic_report::figure(&twins)));
    }
    let mut pictures = Vec::new();
    for (name, svg) in figures {
        write_figure(&arguments.out, name, svg)?;
        pictures.push(name.to_owned());
    }
    for (name, png) in scenes.iter().flat_map(|scene| &scene.pictures) {
        write(&arguments.out.join(name), png)?;
        pictures.push(name.clone());
    }
    let page = report_page::page(&report, &pictures);
    page.publish(&arguments.out, "next-best-view.json", &report, output)
}

/// Published statistic on twins of the paper's scenes.
fn twins(arguments: &NextBestViewArguments, output: &Output) -> Result<Vec<KindScenes>, Failure> {
    let n_scenes = arguments.twin_scenes as usize;
    let jobs: Vec<(TwinKind, usize)> = TwinKind::ALL
        .into_iter()
        .flat_map(|kind| (0..n_scenes).map(move |number| (kind, number)))
        .collect();
    let results = parallel::try_map(jobs.len(), "twins", output, |job| {
        let (kind, number) = jobs[job];
        let seed = scene_result::scene_seed(arguments.seed, number);
        bin_picking_twin::run(kind, seed, arguments.twin_views)
    })?;
    let mut results = results.into_iter();
    let of_kind = |kind: TwinKind| KindScenes {
        kind: kind.word(),
        paper: Some(kind.paper()),
        scenes: results.by_ref().take(n_scenes).collect(),
    };
    let kinds = TwinKind::ALL.into_iter().filter(|_| n_scenes > 0);
    Ok(kinds.map(of_kind).collect())
}

#[cfg(test)]
mod tests;
