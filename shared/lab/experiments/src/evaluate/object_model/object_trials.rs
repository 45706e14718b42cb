//! Trials of all objects: on simulated orbits, and of recorded sequences.

use super::orbit::{self, Orbit, OrbitView, Path};
use super::recognition_gain::DescribedObject;
use super::scored_model::Truth;
use super::trial::{self, PoseNoise, Trial};
use super::true_surface::TrueSurface;
use super::{recorded_views, view_export};
use crate::arguments::ModelArguments;
use crate::parallel;
use command_line::Output;
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3};
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary};

/// Noises of the camera poses that are tried by default: translation and rotation.
const TRANSLATIONS_MM: [f64; 4] = [5.0, 10.0, 20.0, 30.0];
const ROTATIONS_DEG: [f64; 4] = [1.0, 3.0, 5.0, 10.0];

/// All trials of one object.
pub(super) struct ObjectTrials {
    pub(super) name: String,
    /// Surface of the object; `None` when it is not known.
    pub(super) truth: Option<TriangleMesh>,
    pub(super) trials: Vec<(Path, PoseNoise, Trial)>,
    pub(super) described: Option<DescribedObject>,
}

/// Trials of models on the simulated turntable and on free orbits.
pub(super) fn simulated_trials(
    arguments: &ModelArguments,
    output: &Output,
) -> Result<Vec<ObjectTrials>, Failure> {
    let library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
    let models = library.choose(arguments.objects as usize, arguments.seed);
    parallel::try_map(models.len(), "objects", output, |object| {
        object_trials(&models[object], &library, object, arguments)
    })
}

/// Trials of the objects of a recorded sequence.
pub(super) fn recorded_trials(
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
        let trials = trials_of_orbit(orbit, Truth::Samples(&samples), object, arguments);
        let [x, y, z] = orbit.world_from_object.translation.vector.into();
        ObjectTrials {
            name: format!("{:02} at {x:.2} {y:.2} {z:.2}", object + 1),
            truth: None,
            trials,
            described: None,
        }
    };
    parallel::try_map(orbits.len(), "objects", output, |object| {
        Ok(trials(&orbits[object], object))
    })
}

fn trial_seed(seed: u64, object: usize, level: usize) -> u64 {
    seed ^ ((object as u64) << 32) ^ ((level as u64) << 16)
}

/// Noise levels that are tried.
pub(super) fn noises(arguments: &ModelArguments) -> Vec<PoseNoise> {
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
    let name = format!("{:02}-{}", object + 1, model.category());
    let truth = TrueSurface::new(&mesh, arguments.seed);
    let export = arguments.export.as_ref().map(|folder| folder.join(&name));
    if let Some(folder) = &export {
        view_export::write_surface(folder, &truth)?;
    }
    let mut trials = Vec::new();
    for orbit in &orbits {
        let visible = visible(&truth, orbit)?;
        let of_orbit = trials_of_orbit(orbit, Truth::Surface(&truth, &visible), object, arguments);
        if let Some(folder) = &export {
            let folder = folder.join(orbit.path.word().replace(' ', "-"));
            view_export::write_orbit(&folder, orbit, (&truth, &visible), &of_orbit)?;
        }
        trials.extend(of_orbit);
    }
    for path in Path::TURNED {
        let turned = orbits[0].turned_by_hand(path);
        let visible = visible(&truth, &turned)?;
        let truth = Truth::Surface(&truth, &visible);
        trials.extend(trials_of_orbit(&turned, truth, object, arguments));
    }
    let described = match (orbits.as_slice(), trials.first()) {
        ([turntable, free], Some((_, _, trial))) => {
            Some(DescribedObject::new(turntable, &trial.fused, free)?)
        }
        _ => None,
    };
    Ok(ObjectTrials {
        name,
        truth: Some(mesh),
        trials,
        described,
    })
}

/// Samples of the true surface that some camera of an orbit sees.
fn visible(truth: &TrueSurface, orbit: &Orbit) -> Result<Vec<bool>, Failure> {
    let object_from_world = orbit.world_from_object.inverse();
    let cameras = orbit
        .cameras
        .iter()
        .map(|camera| object_from_world * camera);
    truth.visible(&cameras.collect::<Vec<Isometry3<f64>>>())
}

/// Trials of an orbit at all noise levels.
fn trials_of_orbit(
    orbit: &Orbit,
    truth: Truth<'_>,
    object: usize,
    arguments: &ModelArguments,
) -> Vec<(Path, PoseNoise, Trial)> {
    let levels = noises(arguments).into_iter().enumerate();
    let trial = |(level, noise)| {
        let seed = trial_seed(arguments.seed, object, level);
        (orbit.path, noise, trial::run(orbit, truth, noise, seed))
    };
    levels.map(trial).collect()
}
