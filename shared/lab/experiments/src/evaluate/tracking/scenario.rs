//! Tracking scenarios: built-in and user-defined scene files.

use super::small_text_file;
use service::Failure;
use simulated_world::{EVERYDAY_OBJECTS, ModelLibrary, Scene, SceneKind};
use std::path::{Path, PathBuf};

/// Names and texts of scene files of this crate.
macro_rules! scene_files {
    ($($name:literal),+) => {
        [$(($name, include_str!(concat!("../../../scenes/tracking/", $name, ".toml")))),+]
    };
}

/// Name of the daemon's default scene.
const EVERYDAY: &str = "everyday";

/// Built-in tracking scenarios: name and scene file.
const BUILT_IN: [(&str, &str); 7] = scene_files![
    "static",
    "moved-by-hand",
    "crossing",
    "occlusion",
    "contact-and-separation",
    "camera-moving",
    "removed"
];

/// Scene that each seed plays with other objects at other places.
#[derive(Debug, Clone)]
pub(super) struct Scenario {
    pub(super) name: String,
    source: SceneSource,
}

/// Source of a scene.
#[derive(Debug, Clone)]
enum SceneSource {
    /// Text of a scene file, and the folder to which paths in it are relative.
    File { text: String, folder: PathBuf },
    /// Generated scene of a kind.
    Generated(SceneKind),
    /// Default scene of the daemon.
    Everyday,
}

impl Scenario {
    pub(super) fn scene(&self, seed: u64) -> Result<(Scene, ModelLibrary), Failure> {
        let mut library = ModelLibrary::generated();
        let scene = match &self.source {
            SceneSource::File { text, folder } => Scene::from_toml(text, folder, Some(seed)),
            SceneSource::Generated(kind) => {
                let n_objects = kind.default_n_objects();
                Scene::generate(*kind, n_objects, seed, &mut library).map(|scene| (scene, library))
            }
            SceneSource::Everyday => {
                Scene::everyday(EVERYDAY_OBJECTS, seed, &mut library).map(|scene| (scene, library))
            }
        };
        scene.map_err(|error| Failure::usage(format!("{}: {error}", self.name)))
    }

    fn open(path: &Path) -> Result<Self, Failure> {
        let text = small_text_file::read(path).map_err(|cause| unreadable(path, cause))?;
        let name = path.file_stem().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            source: SceneSource::File {
                text,
                folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            },
        })
    }
}

fn unreadable(path: &Path, cause: impl std::fmt::Display) -> Failure {
    let sentence = format!("the scene {} cannot be read: {cause}", path.display());
    Failure::usage(sentence)
}

/// Built-in tracking scenarios.
pub(super) fn built_in() -> Vec<Scenario> {
    let scenarios = BUILT_IN.iter().map(|(name, text)| Scenario {
        name: (*name).to_owned(),
        source: SceneSource::File {
            text: (*text).to_owned(),
            folder: PathBuf::new(),
        },
    });
    scenarios.collect()
}

/// Scenario of a kind of generated scene, or of the daemon's default scene, by its name.
pub(super) fn generated(name: &str) -> Option<Scenario> {
    let source = match name {
        EVERYDAY => SceneSource::Everyday,
        _ => SceneSource::Generated(name.parse().ok()?),
    };
    Some(Scenario {
        name: name.to_owned(),
        source,
    })
}

/// Scenarios of a path: the file itself, or the TOML files of the folder, sorted by name.
pub(super) fn of_files(path: &Path) -> Result<Vec<Scenario>, Failure> {
    if path.is_file() {
        return Ok(vec![Scenario::open(path)?]);
    }
    let is_scene = |name: &str| Path::new(name).extension().is_some_and(|e| e == "toml");
    let files = file_access::file_names(path, is_scene);
    let mut files = files.map_err(|error| unreadable(path, error))?;
    files.sort_unstable();
    let files = files.iter();
    files.map(|file| Scenario::open(&path.join(file))).collect()
}

/// Scenarios of the given names; all without names.
pub(super) fn chosen(scenarios: Vec<Scenario>, names: &[String]) -> Result<Vec<Scenario>, Failure> {
    let known: Vec<String> = scenarios
        .iter()
        .map(|scenario| scenario.name.clone())
        .collect();
    if let Some(unknown) = names.iter().find(|name| !known.contains(name)) {
        let sentence = format!(
            "there is no scene `{unknown}`; there are {}",
            known.join(", ")
        );
        return Err(Failure::usage(sentence));
    }
    let is_chosen = |scenario: &Scenario| names.is_empty() || names.contains(&scenario.name);
    Ok(scenarios.into_iter().filter(is_chosen).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use simulated_world::{ObjectState, World};

    fn scenario(name: &str) -> Scenario {
        chosen(built_in(), &[name.to_owned()]).unwrap().remove(0)
    }

    fn world(name: &str, seed: u64) -> World {
        let (scene, library) = scenario(name).scene(seed).unwrap();
        World::new(scene, library).unwrap()
    }

    fn place(world: &World, id: u16) -> Point3<f64> {
        let object = world.find(id).unwrap();
        object.world_from_object.translation.vector.into()
    }

    fn play(world: &mut World, until_s: f64) {
        while world.time_s() < until_s {
            world.step();
        }
        let notes = world.take_notes();
        assert!(notes.is_empty(), "{notes:?}");
    }

    #[test]
    fn every_scenario_has_six_objects_two_of_them_alike_and_ends_settled() {
        for scenario in built_in() {
            for seed in 1..=20 {
                let mut world = world(&scenario.name, seed);
                let names: Vec<_> = world.objects().iter().map(|o| &o.model.name).collect();
                assert!(names.len() >= 6, "{}: {names:?}", scenario.name);
                assert_eq!(names[0], names[1], "{}", scenario.name);
                let duration_s = world.scene().duration_s.unwrap();
                play(&mut world, duration_s);
                let is_down =
                    |o: &simulated_world::SimulatedObject| o.state == ObjectState::Settled;
                assert!(world.objects().iter().all(is_down), "{}", scenario.name);
                assert!(
                    !world.is_person_busy(),
                    "{} is too short from {seed}",
                    scenario.name
                );
            }
        }
    }

    #[test]
    fn crossing_objects_change_places() {
        let mut world = world("crossing", 3);
        let before = [1, 2].map(|id| place(&world, id));
        play(&mut world, 21.0);
        let after = [2, 1].map(|id| place(&world, id));
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).norm() < 0.05, "{before} {after}");
        }
    }

    #[test]
    fn pushed_object_touches_the_other_and_leaves_it() {
        for seed in [1, 2, 3] {
            let mut world = world("contact-and-separation", seed);
            let gap_m = |world: &World| {
                let [a, b] = [1, 2].map(|id| world.find(id).unwrap());
                let apart = (place(world, 1) - place(world, 2)).xy().norm();
                apart - a.model.footprint_radius_m() - b.model.footprint_radius_m()
            };
            assert!(gap_m(&world) > 0.05);
            play(&mut world, 7.5);
            assert!(gap_m(&world) < 0.003, "{}", gap_m(&world));
            play(&mut world, 15.0);
            assert!(gap_m(&world) > 0.05);
        }
    }

    #[test]
    fn removed_object_is_gone() {
        let mut world = world("removed", 1);
        play(&mut world, 9.5);
        assert!(world.find(1).is_none() && world.find(2).is_some());
    }

    #[test]
    fn scenario_files_are_sorted_by_name_and_unknown_names_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.toml", "a.toml", "c.txt"] {
            std::fs::write(folder.path().join(name), "seed = 3").unwrap();
        }
        let scenarios = of_files(folder.path()).unwrap();
        let names: Vec<_> = scenarios
            .iter()
            .map(|scenario| scenario.name.as_str())
            .collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(of_files(&folder.path().join("b.toml")).unwrap().len(), 1);
        let unknown = chosen(built_in(), &["dance".to_owned()]).unwrap_err();
        assert!(unknown.to_string().contains("moved-by-hand"), "{unknown}");
        assert!(of_files(&folder.path().join("none")).is_err());
    }
}
