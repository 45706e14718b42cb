//! `tabula-lab evaluate grasping`: single objects at rest in random poses, grasped at the first
//! attempt by what one view shows of them.

mod box_rival;
mod judges_agreement;
mod mujoco_judge;
mod report;
mod trial;
mod trial_scene;

use crate::arguments::{GraspJudge, GraspingArguments, ModelHalf};
use crate::output_files::{create_folder, write};
use crate::parallel;
use command_line::Output;
use mujoco_judge::MujocoJudge;
use report::{GraspingReport, page};
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary};
use std::path::Path;
use std::process::ExitCode;
use trial::run_trial;

/// Folder of the pictures, inside the output folder.
const PICTURES: &str = "pictures";

/// Runs all trials, and writes the report.
pub(super) fn run(arguments: &GraspingArguments, output: &Output) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out.join(PICTURES))?;
    let library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
    let models = chosen_models(&library, arguments);
    if models.is_empty() {
        let sentence = "no model is left; give another folder by --models, or --half all";
        return Err(Failure::usage(sentence));
    }
    let mujoco = (arguments.judge == GraspJudge::Mujoco).then(MujocoJudge::default);
    let n_seeds = arguments.seeds as usize;
    let trials = parallel::try_map(models.len() * n_seeds, "trials", output, |number| {
        let model = &models[number / n_seeds];
        let seed = arguments.seed + (number % n_seeds) as u64;
        let (mut trial, picture) = run_trial(model, seed, library.clone(), mujoco.as_ref())?;
        trial.picture = format!("{PICTURES}/{}-{seed}.png", trial.object);
        write(&arguments.out.join(&trial.picture), &picture)?;
        Ok(trial)
    })?;
    let document = GraspingReport::of(trials, arguments);
    page(&document).publish(&arguments.out, "grasping.json", &document, output)
}

/// Models of a half, thinned evenly to the number of objects.
fn chosen_models(library: &ModelLibrary, arguments: &GraspingArguments) -> Vec<ModelChoice> {
    let mut models = library.all(1, arguments.seed);
    models.retain(|model| is_in_half(model, arguments.half));
    let n = arguments.objects.map_or(models.len(), |n| n as usize);
    if n >= models.len() {
        return models;
    }
    (0..n)
        .map(|k| models[k * models.len() / n].clone())
        .collect()
}

/// True for a model of a half. Generated objects, and files without a number, are in both.
fn is_in_half(model: &ModelChoice, half: ModelHalf) -> bool {
    let number = match model {
        ModelChoice::Generated { .. } => None,
        ModelChoice::File(path) => file_number(path),
    };
    match (half, number) {
        (ModelHalf::All, _) | (_, None) => true,
        (ModelHalf::Odd, Some(number)) => number % 2 == 1,
        (ModelHalf::Even, Some(number)) => number % 2 == 0,
    }
}

/// Number at the beginning of a file's name.
fn file_number(path: &Path) -> Option<u64> {
    let name = path.file_name()?.to_str()?;
    let end = name.find(|c: char| !c.is_ascii_digit())?;
    name[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_taken_by_the_number_of_the_file() {
        let file = |name: &str| ModelChoice::File(Path::new("models").join(name));
        let (odd, even) = (file("065-a_cups.ply"), file("024_bowl.ply"));
        let unnumbered = file("cup.ply");
        for (half, expected) in [
            (ModelHalf::Odd, [true, false, true]),
            (ModelHalf::Even, [false, true, true]),
            (ModelHalf::All, [true, true, true]),
        ] {
            let found = [&odd, &even, &unnumbered].map(|model| is_in_half(model, half));
            assert_eq!(found, expected, "{half:?}");
        }
    }
}
