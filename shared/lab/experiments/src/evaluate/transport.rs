//! `tabula-lab evaluate transport`: objects of simulated scenes are carried to a place, by what one
//! view shows, and the simulation judges.

mod report;
mod trial;
mod trial_run;

use crate::arguments::TransportArguments;
use crate::output_files::{create_folder, write};
use crate::parallel;
use command_line::Output;
use report::{TransportReport, page};
use service::Failure;
use simulated_world::{ArmMount, ModelLibrary, Scene, SceneKind, World};
use std::process::ExitCode;
use trial::{TransportTrial, run_trials};

/// Folder of the pictures, inside the output folder.
const PICTURES: &str = "pictures";

/// Runs all trials, and writes the report.
pub(super) fn run(arguments: &TransportArguments, output: &Output) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out.join(PICTURES))?;
    let library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
    let n_seeds = arguments.seeds as usize;
    let n_scenes = arguments.kinds.len() * n_seeds;
    let scenes = parallel::try_map(n_scenes, "scenes", output, |number| {
        let kind = arguments.kinds[number / n_seeds];
        let seed = arguments.seed + (number % n_seeds) as u64;
        let world = world((kind, seed), library.clone(), arguments.arm_opposite)?;
        let mut trials = run_trials(&world, arguments)?;
        for (trial, picture) in &mut trials {
            trial.kind = kind.word();
            trial.seed = seed;
            trial.picture = format!("{PICTURES}/{}-{seed}-{}.png", kind.word(), trial.object);
            write(&arguments.out.join(&trial.picture), picture)?;
        }
        Ok(trials.into_iter().map(|(trial, _)| trial).collect())
    })?;
    let trials: Vec<Vec<TransportTrial>> = scenes;
    let document = TransportReport::of(trials.into_iter().flatten().collect(), arguments);
    page(&document).publish(&arguments.out, "transport.json", &document, output)
}

/// World of a scene with an arm. Where not all objects find room there are fewer.
fn world(
    (kind, seed): (SceneKind, u64),
    mut library: ModelLibrary,
    is_opposite: bool,
) -> Result<World, Failure> {
    let mut n_objects = kind.default_n_objects();
    let scene = loop {
        match Scene::generate(kind, n_objects, seed, &mut library) {
            Ok(scene) => break scene,
            Err(_) if n_objects > 1 => n_objects -= 1,
            Err(error) => return Err(Failure::general(error)),
        }
    };
    let mut mount = ArmMount::default();
    if is_opposite {
        let [x, y, z] = mount.position_m;
        mount.position_m = [-x, -y, z];
        mount.yaw_deg += 180.0;
    }
    let scene = Scene {
        arm: Some(mount),
        ..scene
    };
    World::new(scene, library).map_err(Failure::general)
}
