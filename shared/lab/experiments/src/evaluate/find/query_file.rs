//! Query file (TOML): queries that people wrote about the simulated scenes.

use super::TrueQuery;
use serde::Deserialize;
use service::Failure;
use std::collections::BTreeMap;
use std::path::Path;

/// Queries of the project, written by hand from the pictures of the scenes.
const HAND_WRITTEN: &str = include_str!("../../../queries/hand-written.toml");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    /// Seed of the scenes.
    seed: u64,
    #[serde(default)]
    query: Vec<RawQuery>,
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
pub(super) fn read(
    path: Option<&Path>,
    seed: u64,
) -> Result<BTreeMap<u64, Vec<TrueQuery>>, Failure> {
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
            None => Ok(BTreeMap::new()),
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
    Ok(queries)
}
