//! Scene of given objects apart from each other, tried with several placements.

use service::Failure;
use simulated_world::{Error, ModelChoice, ModelLibrary, Scene};

/// Maximum number of placement attempts of a scene. Chosen.
const N_TRIES: u64 = 20;

/// Scene of the objects, upright and apart from each other, by the seed of a run and the number of
/// the scene.
///
/// # Errors
/// When the objects find no place, or a model is unusable.
pub(super) fn isolated_scene(
    objects: &[ModelChoice],
    (seed, number): (u64, u64),
    library: &mut ModelLibrary,
) -> Result<Scene, Failure> {
    let seeds = (0..N_TRIES).map(|again| seed << 32 ^ again << 24 ^ number);
    let mut laid = seeds.map(|seed| Scene::isolated(objects.to_vec(), seed, library));
    let is_final = |laid: &Result<Scene, Error>| !matches!(laid, Err(Error::NoRoom { .. }));
    let laid = laid
        .find(is_final)
        .ok_or_else(|| Failure::general(format!("the objects of scene {number} find no room")))?;
    laid.map_err(Failure::general)
}
