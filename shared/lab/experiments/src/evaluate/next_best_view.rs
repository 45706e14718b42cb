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
use crate::output_files::{create_folder, write};
use crate::parallel;
use bin_picking_twin::TwinKind;
use command_line::{Output, progress_bar};
use report::NextBestViewReport;
use scene_result::SceneResult;
use service::Failure;
use simulated_world::ModelLibrary;
use statistic_report::KindScenes;
use std::path::Path;
use std::process::ExitCode;
use view_planning::PlanSettings;

/// Runs all scenes and reports the figures.
pub(super) fn run(arguments: &NextBestViewArguments, output: &Output) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out)?;
    if let (Some(folder), Some(models)) = (&arguments.bop, &arguments.bop_models) {
        return bop_statistic::run(arguments, folder, models, output);
    }
    let library = ModelLibrary::open(&arguments.models()).map_err(Failure::usage)?;
    let settings = PlanSettings {
        sigma_share: arguments.sigma_share,
        visited_share: arguments.visited_share,
        gain_weight: arguments.gain_weight,
        ..PlanSettings::default()
    };
    let bar = progress_bar(u64::from(arguments.scenes), "scenes", output);
    let scenes = parallel::map(
        arguments.scenes as usize,
        &bar,
        || (),
        |(), number| scene_result::run(number, arguments, &settings, &library),
    );
    bar.finish_and_clear();
    let scenes = scenes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let twins = twins(arguments, output)?;
    let report = NextBestViewReport::of(arguments, &settings, &scenes, &twins);
    let mut figures = figures::all(&report, &scenes)?;
    if arguments.twin_scenes > 0 {
        let svg = statistic_report::figure(&twins).map_err(Failure::general)?;
        figures.push((statistic_report::STATISTIC, svg));
    }
    write_all(&report, figures, &scenes, &arguments.out)?;
    output.answer(&report, || report_page::page(&report, &[]).text());
    Ok(ExitCode::SUCCESS)
}

/// Published statistic on twins of the paper's scenes.
fn twins(arguments: &NextBestViewArguments, output: &Output) -> Result<Vec<KindScenes>, Failure> {
    let n_scenes = arguments.twin_scenes as usize;
    let jobs: Vec<(TwinKind, usize)> = TwinKind::ALL
        .into_iter()
        .flat_map(|kind| (0..n_scenes).map(move |number| (kind, number)))
        .collect();
    let bar = progress_bar(jobs.len() as u64, "twins", output);
    let results = parallel::map(
        jobs.len(),
        &bar,
        || (),
        |(), job| {
            let (kind, number) = jobs[job];
            let seed = scene_result::scene_seed(arguments.seed, number);
            bin_picking_twin::run(kind, seed, arguments.twin_views)
        },
    );
    bar.finish_and_clear();
    let mut results = results.into_iter();
    let of_kind = |kind: TwinKind| {
        let scenes = results.by_ref().take(n_scenes);
        Ok(KindScenes {
            kind: kind.word(),
            paper: Some(kind.paper()),
            scenes: scenes.collect::<Result<_, Failure>>()?,
        })
    };
    let kinds = TwinKind::ALL.into_iter().filter(|_| n_scenes > 0);
    kinds.map(of_kind).collect()
}

fn write_all(
    report: &NextBestViewReport,
    figures: Vec<(&'static str, String)>,
    scenes: &[SceneResult],
    out: &Path,
) -> Result<(), Failure> {
    let mut pictures = Vec::new();
    for (name, svg) in figures {
        write(&out.join(name), svg.as_bytes())?;
        pictures.push(name.to_owned());
    }
    for (name, png) in scenes.iter().flat_map(|scene| &scene.pictures) {
        write(&out.join(name), png)?;
        pictures.push(name.clone());
    }
    report_page::page(report, &pictures).write(out, "next-best-view.json", report)
}

#[cfg(test)]
mod tests;
