//! Which objects stand in which scene, and where the camera is.

use crate::failure::failed;
use service::Failure;
use simulated_world::{CameraMount, Error, ModelChoice, ModelLibrary, Scene, World};

/// Sets of objects; a scene has one object of each category of its set.
const SETS: [(&str, &[&str]); 6] = [
    (
        "breakfast",
        &[
            "mug",
            "bowl",
            "cereal-box",
            "milk-carton",
            "banana",
            "bread",
            "spoon",
        ],
    ),
    (
        "kitchen",
        &["pot", "kettle", "ladle", "salt-shaker", "tin-can", "bottle"],
    ),
    (
        "office",
        &[
            "stapler",
            "calculator",
            "tape-roll",
            "pencil-cup",
            "book",
            "phone",
            "computer-mouse",
        ],
    ),
    (
        "workshop",
        &[
            "hammer",
            "screwdriver",
            "pliers",
            "clamp",
            "flashlight",
            "paintbrush",
        ],
    ),
    (
        "market",
        &[
            "apple",
            "pear",
            "orange",
            "lemon",
            "tomato",
            "bell-pepper",
            "eggplant",
            "carrot",
        ],
    ),
    (
        "nursery",
        &[
            "toy-car",
            "toy-duck",
            "toy-brick",
            "puzzle-cube",
            "tennis-ball",
            "teddy",
            "candle",
        ],
    ),
];

/// Heights of the camera over the table, metres.
const HEIGHTS_M: [f64; 2] = [0.5, 0.9];
/// Distance of the camera from the middle of the table along the floor, metres.
const AWAY_M: f64 = 0.95;
/// How often places are drawn anew for objects that do not all find one.
const N_TRIES: u64 = 20;

/// Everything that scenes are made from.
#[derive(Debug)]
pub(super) struct SceneSampler {
    seed: u64,
    /// Names of the categories of all sets, sorted.
    categories: Vec<&'static str>,
    /// The models of all sets.
    library: ModelLibrary,
}

impl SceneSampler {
    /// Numbers of sets and cameras.
    const N_KINDS: usize = SETS.len() * HEIGHTS_M.len();

    /// Loads the objects: one of each category, chosen by the seed.
    pub(super) fn new(seed: u64) -> Result<Self, Failure> {
        let mut library = ModelLibrary::generated();
        let mut categories: Vec<&str> =
            SETS.iter().flat_map(|(_, names)| *names).copied().collect();
        categories.sort_unstable();
        for &name in &categories {
            library.load(&object(name, seed)).map_err(failed)?;
        }
        Ok(Self {
            seed,
            categories,
            library,
        })
    }

    /// The categories in the order of their numbers.
    pub(super) fn categories(&self) -> &[&'static str] {
        &self.categories
    }

    /// The number of a category that is on the sampler.
    pub(super) fn number_of(&self, category: &str) -> Option<u32> {
        let index = self.categories.binary_search(&category).ok()?;
        Some(index as u32)
    }

    /// Set and camera of a scene as one number: they take turns.
    pub(super) fn kind_of(scene: usize) -> usize {
        scene % Self::N_KINDS
    }

    /// What the kind of a scene is called, if the scene is the first of its kind.
    pub(super) fn name_if_first(scene: usize) -> Option<String> {
        let (set, height) = set_and_height(scene);
        let name = || format!("{}-{:.0}-cm", SETS[set].0, 100.0 * HEIGHTS_M[height]);
        (scene < Self::N_KINDS).then(name)
    }

    /// A scene whose objects have come to rest.
    ///
    /// # Errors
    /// When the objects find no place.
    pub(super) fn world(&self, scene: usize) -> Result<World, Failure> {
        let (set, height) = set_and_height(scene);
        let objects = SETS[set].1.iter().map(|name| object(name, self.seed));
        let objects: Vec<ModelChoice> = objects.collect();
        let mut library = self.library.clone();
        let seeds = (0..N_TRIES).map(|again| self.seed << 32 ^ again << 24 ^ scene as u64);
        let mut laid = seeds.map(|seed| Scene::isolated(objects.clone(), seed, &mut library));
        let is_final = |laid: &Result<Scene, Error>| !matches!(laid, Err(Error::NoRoom { .. }));
        let laid = laid
            .find(is_final)
            .ok_or_else(|| failed(format!("the objects of scene {scene} find no room")))?;
        let mut laid = laid.map_err(failed)?;
        laid.camera = mount(HEIGHTS_M[height], &laid);
        World::new(laid, library).map_err(failed)
    }
}

fn set_and_height(scene: usize) -> (usize, usize) {
    (scene % SETS.len(), scene / SETS.len() % HEIGHTS_M.len())
}

fn object(category: &str, seed: u64) -> ModelChoice {
    ModelChoice::Generated {
        category: category.to_owned(),
        instance: seed,
    }
}

/// Where the default camera is, but so high over the table.
fn mount(height_m: f64, scene: &Scene) -> CameraMount {
    let mount = CameraMount::default();
    let rise_m = scene.table.height_m + height_m - mount.look_at_m[2];
    CameraMount {
        distance_m: rise_m.hypot(AWAY_M),
        elevation_deg: rise_m.atan2(AWAY_M).to_degrees(),
        ..mount
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_the_objects_of_their_set_before_a_camera_of_their_height() {
        let sampler = SceneSampler::new(1).unwrap();
        let heights = [0, 6].map(|scene| {
            let world = sampler.world(scene).unwrap();
            let names: Vec<&str> = world
                .objects()
                .iter()
                .map(|object| object.model.category.as_str())
                .collect();
            assert_eq!(names, SETS[0].1);
            world.world_from_camera().translation.z - world.scene().table.height_m
        });
        for (found, expected) in heights.into_iter().zip(HEIGHTS_M) {
            assert!((found - expected).abs() < 1e-9, "{found} m");
        }
        let kinds: Vec<usize> = (0..24).map(SceneSampler::kind_of).collect();
        assert_eq!(kinds[..12], kinds[12..]);
        assert_eq!(sampler.categories().len(), 41);
        assert!(
            sampler
                .categories()
                .windows(2)
                .all(|pair| pair[0] < pair[1])
        );
    }
}
