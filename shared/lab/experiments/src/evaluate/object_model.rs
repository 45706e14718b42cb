//! `tabula-lab evaluate model`: models of objects from views with noisy camera poses, against the
//! true surface.

mod model_picture;
mod orbit;
mod recognition_gain;
mod recorded_views;
mod report;
mod report_page;
mod trial;
mod true_surface;

use crate::arguments::ModelArguments;
use crate::output_files::{create_folder, write};
use crate::parallel;
use command_line::{Output, progress_bar};
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3};
use orbit::{Orbit, OrbitView, Path};
use recognition_gain::{DescribedObject, RecognitionGain};
use report::{LevelReport, ModelReport};
use report_page::{FIGURE, MODELS};
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary};
use std::collections::BTreeSet;
use std::process::ExitCode;
use trial::{PoseNoise, Trial, Truth};
use true_surface::TrueSurface;

/// Noises of the camera poses that are tried by default: translation and rotation.
const TRANSLATIONS_MM: [f64; 4] = [5.0, 10.0, 20.0, 30.0];
const ROTATIONS_DEG: [f64; 4] = [1.0, 3.0, 5.0, 10.0];

/// All trials of one object.
struct ObjectTrials {
    name: String,
    /// Surface of the object; `None` when it is not known.
    truth: Option<TriangleMesh>,
    trials: Vec<(Path, PoseNoise, Trial)>,
    described: Option<DescribedObject>,
}

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
    if let Some(out) = &arguments.out {
        let svg = report_page::figure(&report).map_err(Failure::general)?;
        write(&out.join(FIGURE), svg.as_bytes())?;
        let json = serde_json::to_string_pretty(&report).map_err(Failure::general)?;
        write(&out.join("models.json"), json.as_bytes())?;
        write(
            &out.join("index.html"),
            report_page::page(&report).as_bytes(),
        )?;
    }
    output.answer(&report, || report_page::text(&report));
    Ok(ExitCode::SUCCESS)
}

/// Trials of models on the simulated turntable and on free orbits.
fn simulated_trials(
    arguments: &ModelArguments,
    output: &Output,
) -> Result<Vec<ObjectTrials>, Failure> {
    let library = ModelLibrary::open(&arguments.models()).map_err(Failure::usage)?;
    let models = library.choose(arguments.objects as usize, arguments.seed);
    let bar = progress_bar(models.len() as u64, "objects", output);
    let objects = parallel::map(
        models.len(),
        &bar,
        || (),
        |(), object| object_trials(&models[object], &library, object, arguments),
    );
    bar.finish_and_clear();
    objects.into_iter().collect()
}

/// Trials of the objects of a recorded sequence.
fn recorded_trials(
    folder: &std::path::Path,
    arguments: &ModelArguments,
    output: &Output,
) -> Result<Vec<ObjectTrials>, Failure> {
    let orbits = recorded_views::read(folder, arguments.objects as usize, output)?;
    if orbits.is_empty() {
        let sentence = "no object of the sequence is seen often and from different sides; record \
                        one with a camera that moves around the table";
        return Err(Failure::general(sentence));
    }
    let bar = progress_bar(orbits.len() as u64, "objects", output);
    let trials = |orbit: &Orbit, object: usize| {
        let object_from_world = orbit.world_from_object.inverse();
        let in_object = |view: &OrbitView| -> Vec<Point3<f64>> {
            let pose = object_from_world * view.world_from_camera;
            view.points
                .iter()
                .map(|point| pose * point.position())
                .collect()
        };
        let samples = orbit.views.first().map(in_object).unwrap_or_default();
        let trials = noises(arguments)
            .into_iter()
            .enumerate()
            .map(|(level, noise)| {
                let seed = trial_seed(arguments.seed, object, level);
                (
                    orbit.path,
                    noise,
                    trial::run(orbit, Truth::Samples(&samples), noise, seed),
                )
            });
        let [x, y, z] = orbit.world_from_object.translation.vector.into();
        ObjectTrials {
            name: format!("{:02} at {x:.2} {y:.2} {z:.2}", object + 1),
            truth: None,
            trials: trials.collect(),
            described: None,
        }
    };
    let trials = parallel::map(
        orbits.len(),
        &bar,
        || (),
        |(), object| trials(&orbits[object], object),
    );
    bar.finish_and_clear();
    Ok(trials)
}

fn trial_seed(seed: u64, object: usize, level: usize) -> u64 {
    seed ^ ((object as u64) << 32) ^ ((level as u64) << 16)
}

fn noises(arguments: &ModelArguments) -> Vec<PoseNoise> {
    let noise = |translation_mm, rotation_deg| PoseNoise {
        translation_mm,
        rotation_deg,
    };
    if arguments.noise.is_empty() {
        let grid = TRANSLATIONS_MM.into_iter();
        return grid
            .flat_map(|mm| ROTATIONS_DEG.map(|deg| noise(mm, deg)))
            .collect();
    }
    arguments
        .noise
        .iter()
        .map(|&(mm, deg)| noise(mm, deg))
        .collect()
}

fn object_trials(
    model: &ModelChoice,
    library: &ModelLibrary,
    object: usize,
    arguments: &ModelArguments,
) -> Result<ObjectTrials, Failure> {
    let (turntable, orbits) = orbit::simulate(model, library, object, arguments)?;
    let mesh = turntable
        .object()
        .map(|object| object.model.mesh.clone())
        .unwrap_or_default();
    let truth = TrueSurface::new(&mesh, arguments.seed);
    let mut trials = Vec::new();
    for orbit in &orbits {
        let object_from_world = orbit.world_from_object.inverse();
        let cameras: Vec<Isometry3<f64>> = orbit
            .cameras
            .iter()
            .map(|camera| object_from_world * camera)
            .collect();
        let visible = truth.visible(&cameras)?;
        for (level, noise) in noises(arguments).into_iter().enumerate() {
            let seed = trial_seed(arguments.seed, object, level);
            let trial = trial::run(orbit, Truth::Surface(&truth, &visible), noise, seed);
            trials.push((orbit.path, noise, trial));
        }
    }
    let described = match (orbits.as_slice(), trials.first()) {
        ([turntable, free], Some((_, _, trial))) => {
            Some(DescribedObject::new(turntable, &trial.fused_ns, free)?)
        }
        _ => None,
    };
    Ok(ObjectTrials {
        name: format!("{:02}-{}", object + 1, model.category()),
        truth: Some(mesh),
        trials,
        described,
    })
}

/// Reports of all levels, path by path.
fn levels(objects: &mut [ObjectTrials], arguments: &ModelArguments) -> Vec<LevelReport> {
    let mut levels = Vec::new();
    let paths = objects
        .iter()
        .flat_map(|object| object.trials.iter().map(|trial| trial.0));
    let paths: BTreeSet<Path> = paths.collect();
    for path in paths {
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

/// Picture with a row for each object: the truth, and the models of the first and the last noise
/// on each path.
fn picture(objects: &[ObjectTrials]) -> Result<Vec<u8>, Failure> {
    let row = |object: &'_ ObjectTrials| -> Vec<TriangleMesh> {
        let mut row: Vec<TriangleMesh> = object.truth.iter().cloned().collect();
        for path in [Path::Turntable, Path::Free, Path::Recorded] {
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
