//! `tabula-lab evaluate model`: models of objects from views with noisy camera poses, against the
//! true surface.

mod model_picture;
mod object_trials;
mod orbit;
mod recognition_gain;
mod recorded_views;
mod report;
mod report_page;
mod scored_model;
mod trial;
mod true_surface;
mod view_export;

use crate::arguments::ModelArguments;
use crate::output_files::{create_folder, write, write_figure};
use command_line::Output;
use mesh::TriangleMesh;
use object_trials::{ObjectTrials, noises, recorded_trials, simulated_trials};
use orbit::Path;
use recognition_gain::{DescribedObject, RecognitionGain};
use report::{LevelReport, ModelReport};
use report_page::{FIGURE, MODELS};
use service::Failure;
use std::collections::BTreeSet;
use std::process::ExitCode;
use trial::{PoseNoise, Trial};

/// Builds models of all objects at all noise levels and reports the figures.
pub(super) fn run(arguments: &ModelArguments, output: &Output) -> Result<ExitCode, Failure> {
    let mut objects = match &arguments.sequence {
        Some(folder) => recorded_trials(folder, arguments, output)?,
        None => simulated_trials(arguments, output)?,
    };
    if let Some(out) = &arguments.out {
        create_folder(out)?;
        write(&out.join(MODELS), &picture(&objects)?)?;
    }
    let described: Vec<DescribedObject> = objects
        .iter_mut()
        .filter_map(|object| object.described.take())
        .collect();
    let recognition = match described.len() {
        0 | 1 => None,
        _ => Some(RecognitionGain::of(&described)?),
    };
    let report = ModelReport {
        recognition,
        seed: arguments.seed,
        n_objects: objects.len(),
        n_views: arguments.sequence.is_none().then_some(arguments.views),
        levels: levels(&mut objects, arguments),
    };
    let page = report_page::page(&report);
    if let Some(out) = &arguments.out {
        write_figure(out, FIGURE, report_page::figure(&report))?;
        page.write(out, "models.json", &report)?;
    }
    output.answer(&report, || page.text());
    Ok(ExitCode::SUCCESS)
}

/// Reports of all levels, path by path.
fn levels(objects: &mut [ObjectTrials], arguments: &ModelArguments) -> Vec<LevelReport> {
    let mut levels = Vec::new();
    for path in paths(objects) {
        for noise in noises(arguments) {
            let mut trials = Vec::new();
            for object in objects.iter_mut() {
                let is_level = |(p, n, _): &(Path, PoseNoise, Trial)| *p == path && *n == noise;
                if let Some(place) = object.trials.iter().position(is_level) {
                    trials.push((object.name.clone(), object.trials.swap_remove(place).2));
                }
            }
            levels.push(LevelReport::of(path, noise, &trials));
        }
    }
    levels
}

/// Paths of all trials, in their order.
fn paths(objects: &[ObjectTrials]) -> BTreeSet<Path> {
    let trials = objects.iter().flat_map(|object| &object.trials);
    trials.map(|trial| trial.0).collect()
}

/// Picture with a row for each object: the truth, and the models of the first and the last noise
/// on each path.
fn picture(objects: &[ObjectTrials]) -> Result<Vec<u8>, Failure> {
    let row = |object: &'_ ObjectTrials| -> Vec<TriangleMesh> {
        let mut row: Vec<TriangleMesh> = object.truth.iter().cloned().collect();
        for path in paths(std::slice::from_ref(object)) {
            let of_path: Vec<&Trial> = object
                .trials
                .iter()
                .filter(|t| t.0 == path)
                .map(|t| &t.2)
                .collect();
            row.extend(of_path.first().map(|trial| trial.mesh.clone()));
            row.extend(of_path.last().map(|trial| trial.mesh.clone()));
        }
        row
    };
    let rows: Vec<Vec<TriangleMesh>> = objects.iter().map(row).collect();
    let rows: Vec<Vec<&TriangleMesh>> = rows.iter().map(|row| row.iter().collect()).collect();
    model_picture::draw(&rows)
}

#[cfg(test)]
mod tests;
