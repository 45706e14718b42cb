//! Configuration section `[simulator]`: parsing and validation.

use crate::arguments::SimulatorArguments;
use arm_kinematics::GripperModel;
use capture::FramePace;
use serde::Deserialize;
use service::{Configuration, Failure, KeyReference};
use simulated_world::{ArmMount, EVERYDAY_OBJECTS, ModelLibrary, ModelSource, Scene, SceneKind};
use std::path::{Path, PathBuf};

/// Name of the section.
const SECTION: &str = "simulator";
const GRIPPER_SECTION: &str = "gripper";

/// Section `[simulator]` as written in TOML.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    scene: Option<String>,
    objects: Option<usize>,
    seed: Option<u64>,
    models: Option<PathBuf>,
    rate_hz: Option<f64>,
    lockstep: bool,
    real_time: Option<bool>,
}

/// Scene of the simulation: generated or from a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum SceneChoice {
    /// A few objects, an arm, and a person who acts now and then.
    Everyday,
    /// A generated scene.
    Generated(SceneKind),
    /// Scene described by a TOML file.
    File(PathBuf),
}

/// Validated configuration of the simulator.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Config {
    pub(crate) plan: SceneChoice,
    n_objects: Option<usize>,
    seed: Option<u64>,
    models: ModelSource,
    pub(crate) rate_hz: f64,
    pub(crate) pace: FramePace,
    /// True if the arm's loop is to have real-time priority.
    pub(crate) real_time: bool,
    gripper: GripperModel,
}

impl Config {
    /// Reads the section of the configuration, overridden by the arguments.
    ///
    /// # Errors
    /// A usage failure that names the value and its rule.
    pub(crate) fn new(
        arguments: &SimulatorArguments,
        found: &Configuration,
    ) -> Result<Self, Failure> {
        let raw: RawConfig = found.section(SECTION)?;
        let given = &arguments.scene;
        let scene = given.scene.clone().or(raw.scene);
        // The sentences name options; a value of the file is named with its place.
        let refused = |key: &str, is_given: bool, sentence: String| {
            if is_given || found.setting(SECTION, key).is_none() {
                return Failure::usage(sentence);
            }
            found.wrong(SECTION, &[key], sentence).into()
        };
        let config = Self {
            plan: plan(scene.as_deref())
                .map_err(|sentence| refused("scene", given.scene.is_some(), sentence))?,
            n_objects: given.objects.or(raw.objects),
            seed: given.seed.or(raw.seed),
            models: raw
                .models
                .map_or(ModelSource::Generated, ModelSource::Folder),
            rate_hz: given.rate.or(raw.rate_hz).unwrap_or(30.0),
            pace: FramePace::new(given.lockstep || raw.lockstep, &given.lockstep_with),
            real_time: raw.real_time.unwrap_or(true),
            gripper: found.section(GRIPPER_SECTION)?,
        };
        config
            .check_objects()
            .map_err(|sentence| refused("objects", given.objects.is_some(), sentence))?;
        if let Some(rate) = given.rate {
            KeyReference::check_option(SECTION, "rate_hz", "--rate", rate)?;
        }
        if let Some(n) = given.objects {
            KeyReference::check_option(SECTION, "objects", "--objects", n as f64)?;
        }
        if arguments.process.check_config {
            config
                .scene()
                .map_err(|error| Failure::usage(error.to_string()))?;
        }
        Ok(config)
    }

    fn check_objects(&self) -> Result<(), String> {
        match (self.n_objects, &self.plan) {
            (Some(_), SceneChoice::File(path)) => Err(format!(
                "--objects cannot be used with a scene file; write the number into {}",
                path.display()
            )),
            _ => Ok(()),
        }
    }

    /// Scene to simulate and its object models.
    ///
    /// # Errors
    /// When a file cannot be used, or the objects find no place.
    pub(crate) fn scene(&self) -> Result<(Scene, ModelLibrary), simulated_world::Error> {
        let (mut scene, library) = self.scene_of_plan()?;
        if let Some(arm) = &mut scene.arm {
            arm.gripper = self.gripper;
        }
        Ok((scene, library))
    }

    fn scene_of_plan(&self) -> Result<(Scene, ModelLibrary), simulated_world::Error> {
        let mut library = ModelLibrary::open(&self.models)?;
        let scene = match &self.plan {
            SceneChoice::File(path) => return Scene::open(path, self.seed),
            SceneChoice::Everyday => {
                let n_objects = self.n_objects.unwrap_or(EVERYDAY_OBJECTS);
                Scene::everyday(n_objects, self.seed(), &mut library)?
            }
            SceneChoice::Generated(kind) => {
                let n_objects = self.n_objects.unwrap_or(kind.default_n_objects());
                // The mounting pose fits the default table; that of a crowd varies.
                let has_arm = !matches!(kind, SceneKind::Clutter | SceneKind::Shelf);
                Scene {
                    arm: has_arm.then(ArmMount::default),
                    ..Scene::generate(*kind, n_objects, self.seed(), &mut library)?
                }
            }
        };
        Ok((scene, library))
    }

    /// Seed of a generated scene.
    fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }

    /// Human-readable name of the scene.
    pub(crate) fn name(&self) -> String {
        match &self.plan {
            SceneChoice::Everyday => format!("simulation:everyday:{}", self.seed()),
            SceneChoice::Generated(kind) => format!("simulation:{}:{}", kind.word(), self.seed()),
            SceneChoice::File(path) => format!("simulation:{}", path.display()),
        }
    }
}

fn plan(scene: Option<&str>) -> Result<SceneChoice, String> {
    let Some(scene) = scene.filter(|scene| *scene != "everyday") else {
        return Ok(SceneChoice::Everyday);
    };
    if let Ok(kind) = scene.parse() {
        return Ok(SceneChoice::Generated(kind));
    }
    let path = Path::new(scene);
    if path.exists()
        || path
            .extension()
            .is_some_and(|extension| extension == "toml")
    {
        return Ok(SceneChoice::File(path.to_owned()));
    }
    let kinds = SceneKind::ALL.map(SceneKind::word).join(", ");
    Err(format!(
        "`{scene}` is no scene: there are everyday, {kinds}, or a TOML file that is there"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use simulated_world::MAX_OBJECTS;

    fn config(words: &str) -> Result<Config, String> {
        let words = std::iter::once("tabula-simulator").chain(words.split_ascii_whitespace());
        let arguments = SimulatorArguments::try_parse_from(words).map_err(|e| e.to_string())?;
        Config::new(&arguments, &Configuration::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn section_agrees_with_the_key_reference() {
        let arguments = SimulatorArguments::parse_from(["tabula-simulator"]);
        // A seed that is not given is the default one.
        let read = |found: &Configuration| {
            let config = Config::new(&arguments, found)?;
            Ok::<_, Failure>(Config {
                seed: Some(config.seed()),
                ..config
            })
        };
        service::check_section_reference(SECTION, read).unwrap();
        let gripper = |found: &Configuration| found.section::<GripperModel>(GRIPPER_SECTION);
        service::check_section_reference(GRIPPER_SECTION, gripper).unwrap();
        let objects = KeyReference::get().key(SECTION, "objects").unwrap();
        let most = objects.range.as_ref().unwrap().most;
        assert_eq!(most, Some(MAX_OBJECTS as f64));
    }

    #[test]
    fn the_default_is_an_everyday_table() {
        assert_eq!(config("").unwrap().plan, SceneChoice::Everyday);
        assert_eq!(
            config("--scene bin").unwrap().plan,
            SceneChoice::Generated(SceneKind::Bin)
        );
    }

    #[test]
    fn an_impossible_scene_is_refused_with_its_rule() {
        let check = |words: &str, word: &str| {
            let sentence = config(words).unwrap_err();
            assert!(sentence.contains(word), "{sentence}");
        };
        check("--scene palace", "palace");
        check("--rate 0", "--rate");
        check("--rate NaN", "--rate");
        check("--objects 1000", "--objects");
        check("--scene there-is-no.toml --objects 3", "--objects");
    }
}
