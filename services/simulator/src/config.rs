//! The configuration, checked.

use crate::arguments::Arguments;
use serde::Deserialize;
use service::{ConfigFile, Failure, exit_code};
use simulated_world::{ArmMount, MOST_OBJECTS, ModelLibrary, ModelSource, Scene, SceneKind};
use std::path::{Path, PathBuf};

/// Rates that can be asked for.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.1..=120.0;
/// Objects of the everyday scene.
const EVERYDAY_OBJECTS: usize = 5;

/// The section `[simulator]` as written.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawConfig {
    scene: Option<String>,
    objects: Option<usize>,
    seed: Option<u64>,
    models: Option<PathBuf>,
    rate_hz: Option<f64>,
    lockstep: bool,
}

/// Which scene is played.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ScenePlan {
    /// Some objects, an arm, and a person who now and then does something.
    Everyday,
    /// A generated scene.
    Generated(SceneKind),
    /// A TOML file.
    File(PathBuf),
}

/// What the simulator does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Config {
    pub(crate) plan: ScenePlan,
    n_objects: Option<usize>,
    seed: Option<u64>,
    models: ModelSource,
    pub(crate) rate_hz: f64,
    pub(crate) lockstep: bool,
}

impl Config {
    /// The section `[simulator]` of the file, overruled by the arguments.
    ///
    /// # Errors
    /// A usage failure that names the value and its rule.
    pub(crate) fn new(arguments: &Arguments, file: &ConfigFile) -> Result<Self, Failure> {
        let raw: RawConfig = file.section("simulator")?;
        let given = &arguments.scene;
        let usage = |rule: String| Failure::new(exit_code::USAGE, rule);
        let scene = given.scene.clone().or(raw.scene);
        let config = Self {
            plan: plan(scene.as_deref()).map_err(usage)?,
            n_objects: given.objects.or(raw.objects),
            seed: given.seed.or(raw.seed),
            models: raw
                .models
                .map_or(ModelSource::Generated, ModelSource::Folder),
            rate_hz: given.rate.or(raw.rate_hz).unwrap_or(30.0),
            lockstep: given.lockstep || raw.lockstep,
        };
        config.check().map_err(usage)?;
        if arguments.process.check_config {
            config.scene().map_err(|error| usage(error.to_string()))?;
        }
        Ok(config)
    }

    fn check(&self) -> Result<(), String> {
        let rate_hz = self.rate_hz;
        if !RATES_HZ.contains(&rate_hz) {
            return Err(format!(
                "--rate must lie between 0.1 and 120 frames per second, not {rate_hz}"
            ));
        }
        match (self.n_objects, &self.plan) {
            (Some(_), ScenePlan::File(path)) => Err(format!(
                "--objects can not be used with a scene file; write the number into {}",
                path.display()
            )),
            (Some(n), _) if n > MOST_OBJECTS => {
                Err(format!("--objects must be at most {MOST_OBJECTS}, not {n}"))
            }
            _ => Ok(()),
        }
    }

    /// The scene and the models it is made of.
    ///
    /// # Errors
    /// When a file can not be used, or the objects find no place.
    pub(crate) fn scene(&self) -> Result<(Scene, ModelLibrary), simulated_world::Error> {
        let mut library = ModelLibrary::open(&self.models)?;
        let scene = match &self.plan {
            ScenePlan::File(path) => return Scene::open(path, self.seed),
            ScenePlan::Everyday => {
                let n_objects = self.n_objects.unwrap_or(EVERYDAY_OBJECTS);
                Scene::everyday(n_objects, self.seed(), &mut library)?
            }
            ScenePlan::Generated(kind) => {
                let n_objects = self.n_objects.unwrap_or(kind.usual_number());
                Scene {
                    arm: Some(ArmMount::default()),
                    ..Scene::generate(*kind, n_objects, self.seed(), &mut library)?
                }
            }
        };
        Ok((scene, library))
    }

    /// The seed of a generated scene.
    fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }

    /// What people call the scene.
    pub(crate) fn name(&self) -> String {
        match &self.plan {
            ScenePlan::Everyday => format!("simulation:everyday:{}", self.seed()),
            ScenePlan::Generated(kind) => format!("simulation:{}:{}", kind.word(), self.seed()),
            ScenePlan::File(path) => format!("simulation:{}", path.display()),
        }
    }
}

fn plan(scene: Option<&str>) -> Result<ScenePlan, String> {
    let Some(scene) = scene.filter(|scene| *scene != "everyday") else {
        return Ok(ScenePlan::Everyday);
    };
    if let Ok(kind) = scene.parse() {
        return Ok(ScenePlan::Generated(kind));
    }
    let path = Path::new(scene);
    if path.exists()
        || path
            .extension()
            .is_some_and(|extension| extension == "toml")
    {
        return Ok(ScenePlan::File(path.to_owned()));
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

    fn config(words: &str) -> Result<Config, String> {
        let words = std::iter::once("tabula-simulator").chain(words.split_ascii_whitespace());
        let arguments = Arguments::try_parse_from(words).map_err(|e| e.to_string())?;
        Config::new(&arguments, &ConfigFile::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn the_default_is_an_everyday_table() {
        assert_eq!(config("").unwrap().plan, ScenePlan::Everyday);
        assert_eq!(
            config("--scene bin").unwrap().plan,
            ScenePlan::Generated(SceneKind::Bin)
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
