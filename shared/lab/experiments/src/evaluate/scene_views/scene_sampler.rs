//! Scene sampler: object sets on a table under a camera of two heights.

use crate::evaluate::isolated_scene::isolated_scene;
use service::Failure;
use simulated_world::{CameraMount, ModelChoice, ModelLibrary, Scene, World};

/// Object sets; a scene has one object of each category of its set.
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

/// Heights of the camera above the table, metres. Chosen.
const HEIGHTS_M: [f64; 2] = [0.5, 0.9];
/// Horizontal distance of the camera from the middle of the table, metres. Chosen.
const AWAY_M: f64 = 0.95;
/// Source of simulated scenes: seed, categories and models.
#[derive(Debug)]
pub(super) struct SceneSampler {
    seed: u64,
    /// Names of the categories of all sets, sorted.
    categories: Vec<&'static str>,
    /// Library with the object models of all sets.
    library: ModelLibrary,
}

impl SceneSampler {
    /// Number of kinds of scenes: object sets times camera heights.
    const N_KINDS: usize = SETS.len() * HEIGHTS_M.len();

    /// Sampler with one loaded model of each category, chosen by the seed.
    pub(super) fn new(seed: u64) -> Result<Self, Failure> {
        let mut library = ModelLibrary::generated();
        let mut categories: Vec<&str> =
            SETS.iter().flat_map(|(_, names)| *names).copied().collect();
        categories.sort_unstable();
        for &name in &categories {
            library
                .load(&object(name, seed))
                .map_err(Failure::general)?;
        }
        Ok(Self {
            seed,
            categories,
            library,
        })
    }

    /// Category names in the order of their numbers.
    pub(super) fn categories(&self) -> &[&'static str] {
        &self.categories
    }

    /// Number of a category of the sets.
    pub(super) fn number_of(&self, category: &str) -> Option<u32> {
        let index = self.categories.binary_search(&category).ok()?;
        Some(index as u32)
    }

    /// Kind of a scene: object set and camera height as one number; kinds alternate.
    pub(super) fn kind_of(scene: usize) -> usize {
        scene % Self::N_KINDS
    }

    /// Name of the kind of a scene, if the scene is the first of its kind.
    pub(super) fn name_if_first(scene: usize) -> Option<String> {
        let (set, height) = set_and_height(scene);
        let name = || format!("{}-{:.0}-cm", SETS[set].0, 100.0 * HEIGHTS_M[height]);
        (scene < Self::N_KINDS).then(name)
    }

    /// World of a scene with its objects at rest.
    ///
    /// # Errors
    /// When the objects find no place.
    pub(super) fn world(&self, scene: usize) -> Result<World, Failure> {
        let (set, height) = set_and_height(scene);
        let objects = SETS[set].1.iter().map(|name| object(name, self.seed));
        let objects: Vec<ModelChoice> = objects.collect();
        let mut library = self.library.clone();
        let mut laid = isolated_scene(&objects, (self.seed, scene as u64), &mut library)?;
        laid.camera = mount(HEIGHTS_M[height], &laid);
        World::new(laid, library).map_err(Failure::general)
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

/// Camera mount at a height above the table, in the direction of the default mount.
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
    fn scenes_have_the_objects_and_camera_height_of_their_kind() {
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
