//! Query file (TOML): queries that people wrote about the simulated scenes, and other names and
//! absences in these scenes.

use super::TrueQuery;
use serde::Deserialize;
use service::Failure;
use std::collections::BTreeMap;
use std::path::Path;

/// Queries of the project, written by hand from the pictures of the scenes.
const HAND_WRITTEN: &str = include_str!("../../../queries/hand-written.toml");

/// Queries of a file, and what they change in the scenes.
#[derive(Debug, Default)]
pub(super) struct QueryFile {
    queries: BTreeMap<u64, Vec<TrueQuery>>,
    /// Names that are taught in all scenes, by category.
    names: BTreeMap<String, String>,
    scenes: BTreeMap<u64, RawScene>,
}

/// Changes of one scene: other names, and objects that are gone.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SceneChange {
    /// Names that are taught, by category.
    pub(super) names_by_category: BTreeMap<String, String>,
    /// Names that are taught, by object number; they come before those by category.
    pub(super) names_by_object: BTreeMap<u16, String>,
    /// Numbers of the objects that are gone.
    pub(super) gone: Vec<u16>,
}

impl QueryFile {
    /// Queries about a scene.
    pub(super) fn of_scene(&self, number: u64) -> &[TrueQuery] {
        self.queries.get(&number).map_or(&[], Vec::as_slice)
    }

    /// Change of a scene.
    ///
    /// # Errors
    /// When a key of `names` is no object number.
    pub(super) fn change(&self, number: u64) -> Result<SceneChange, Failure> {
        let scene = self.scenes.get(&number).cloned().unwrap_or_default();
        let names = scene.names.into_iter().map(|(key, name)| {
            let object = key.parse().map_err(|_| {
                Failure::usage(format!(
                    "{key:?} in `names` of scene {number} is no object number; give one, such as 3"
                ))
            })?;
            Ok((object, name))
        });
        Ok(SceneChange {
            names_by_category: self.names.clone(),
            names_by_object: names.collect::<Result<_, Failure>>()?,
            gone: scene.gone,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    /// Seed of the scenes.
    seed: u64,
    /// Names that are taught in place of categories.
    #[serde(default)]
    names: BTreeMap<String, String>,
    #[serde(default)]
    scene: Vec<RawScene>,
    #[serde(default)]
    query: Vec<RawQuery>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawScene {
    /// Number of the scene, from 1.
    number: u64,
    /// Names that are taught, by object number.
    #[serde(default)]
    names: BTreeMap<String, String>,
    /// Numbers of the objects that are gone.
    #[serde(default)]
    gone: Vec<u16>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawQuery {
    /// Number of the scene, from 1.
    scene: u64,
    words: String,
    /// Object numbers that are meant.
    objects: Vec<u16>,
}

/// Reads the queries by the number of their scene: those of a file, or those of the project,
/// which belong to the scenes of one seed.
pub(super) fn read(path: Option<&Path>, seed: u64) -> Result<QueryFile, Failure> {
    let text = path
        .map(std::fs::read_to_string)
        .transpose()
        .map_err(|error| {
            let path = path.unwrap_or(Path::new("")).display();
            Failure::usage(format!("{path} could not be read: {error}"))
        })?;
    let raw: RawFile = toml::from_str(text.as_deref().unwrap_or(HAND_WRITTEN))
        .map_err(|error| Failure::usage(format!("the queries are no query file: {error}")))?;
    if raw.seed != seed {
        return match path {
            Some(path) => Err(Failure::usage(format!(
                "{} has queries about the scenes of seed {}; give that --seed",
                path.display(),
                raw.seed
            ))),
            None => Ok(QueryFile::default()),
        };
    }
    let mut queries: BTreeMap<u64, Vec<TrueQuery>> = BTreeMap::new();
    for RawQuery {
        scene,
        words,
        mut objects,
    } in raw.query
    {
        objects.sort_unstable();
        let of_scene = queries.entry(scene).or_default();
        of_scene.push(TrueQuery { words, objects });
    }
    Ok(QueryFile {
        queries,
        names: raw.names,
        scenes: raw
            .scene
            .into_iter()
            .map(|scene| (scene.number, scene))
            .collect(),
    })
}
