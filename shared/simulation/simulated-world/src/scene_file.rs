//! Scenes as TOML files, and scenes from the seeded generators.
//!
//! A file may name a generator (`kind`), lay objects one by one (`[[object]]`),
//! or both; whatever is left out has the default of the generated scenes. Keys
//! that are not known are errors.

mod raw;
mod variation;

use crate::arm::ArmMount;
use crate::arrangement;
use crate::error::Error;
use crate::model_library::{ModelLibrary, category_names};
use crate::object_model::ObjectModel;
use crate::person::PersonPlan;
use crate::scene::{Bin, ModelChoice, ModelSource, ObjectPlan, Scene, SceneKind};
use std::path::Path;
use std::sync::Arc;

/// Most objects of a scene.
pub const MOST_OBJECTS: usize = 60;
/// Pause between a person's actions by chance, seconds.
const BY_CHANCE_EVERY_S: [f64; 2] = [6.0, 14.0];
/// What stands on the table of [`Scene::everyday`] at first: things that a Kinect
/// sees well and that look unlike each other.
const EVERYDAY: [&str; 12] = [
    "mug",
    "bowl",
    "cereal-box",
    "apple",
    "bottle",
    "banana",
    "soda-can",
    "teapot",
    "milk-carton",
    "teddy",
    "vase",
    "toy-duck",
];
/// Largest scene file, bytes.
const MOST_BYTES: u64 = 1 << 20;

impl Scene {
    /// A scene of a kind: the same kind, number, seed and models give the same scene.
    ///
    /// # Errors
    /// When isolated objects do not all find a place, or a model can not be used.
    pub fn generate(
        kind: SceneKind,
        n_objects: usize,
        seed: u64,
        library: &mut ModelLibrary,
    ) -> Result<Self, Error> {
        let mut scene = Self {
            seed,
            bin: (kind == SceneKind::Bin).then(Bin::default),
            ..Self::default()
        };
        scene.objects = generated_objects(&scene, kind, n_objects, library)?;
        Ok(scene)
    }

    /// These objects apart from each other, standing as they are used, at random free
    /// places and turns.
    ///
    /// # Errors
    /// When they do not all find a place, or a model can not be used.
    pub fn isolated(
        choices: Vec<ModelChoice>,
        seed: u64,
        library: &mut ModelLibrary,
    ) -> Result<Self, Error> {
        let mut scene = Self {
            seed,
            ..Self::default()
        };
        scene.objects = placed(&scene, SceneKind::Isolated, choices, library)?;
        Ok(scene)
    }

    /// The scene the daemon shows when nobody says otherwise: some objects, and a
    /// person who now and then moves, adds or takes one.
    ///
    /// # Errors
    /// As [`generate`](Self::generate).
    pub fn everyday(
        n_objects: usize,
        seed: u64,
        library: &mut ModelLibrary,
    ) -> Result<Self, Error> {
        let mut scene = Self {
            seed,
            ..Self::default()
        };
        let choices = match library.source() {
            ModelSource::Generated => arrangement::choose(&EVERYDAY, n_objects, seed),
            ModelSource::Folder(_) => library.choose(n_objects, seed),
        };
        scene.objects = placed(&scene, SceneKind::Isolated, choices, library)?;
        scene.arm = Some(ArmMount::default());
        scene.person = Some(PersonPlan {
            by_chance_every_s: Some(BY_CHANCE_EVERY_S),
            ..PersonPlan::default()
        });
        Ok(scene)
    }

    /// A scene from the text of a TOML file; paths in it count from `folder`.
    /// The library is opened as the file says; a `seed` given here wins.
    ///
    /// # Errors
    /// A sentence that names the place and the rule.
    pub fn from_toml(
        text: &str,
        folder: &Path,
        seed: Option<u64>,
    ) -> Result<(Self, ModelLibrary), Error> {
        raw::scene(text, folder, seed)
    }

    /// A scene from a TOML file.
    ///
    /// # Errors
    /// When the file can not be read, or as [`from_toml`](Self::from_toml).
    pub fn open(path: &Path, seed: Option<u64>) -> Result<(Self, ModelLibrary), Error> {
        let unreadable = |cause: String| Error::Unreadable {
            path: path.to_owned(),
            cause,
        };
        let size = std::fs::metadata(path).map_err(|error| unreadable(error.to_string()))?;
        if !size.is_file() || size.len() > MOST_BYTES {
            return Err(unreadable("it is not a file of at most 1 MiB".into()));
        }
        let text = std::fs::read_to_string(path).map_err(|error| unreadable(error.to_string()))?;
        Self::from_toml(&text, path.parent().unwrap_or(Path::new("")), seed)
    }
}

/// Objects of a generator.
fn generated_objects(
    scene: &Scene,
    kind: SceneKind,
    n_objects: usize,
    library: &mut ModelLibrary,
) -> Result<Vec<ObjectPlan>, Error> {
    if n_objects > MOST_OBJECTS {
        return Err(Error::Scene {
            place: "objects".into(),
            rule: format!("at most {MOST_OBJECTS} fit a scene, not {n_objects}"),
        });
    }
    if kind == SceneKind::SetTable && *library.source() == ModelSource::Generated {
        let laid = arrangement::set_table(&category_names(), n_objects, scene.seed);
        if laid.len() < n_objects {
            return Err(Error::NoRoom {
                n_objects,
                n_placed: laid.len(),
            });
        }
        let plans = laid.into_iter();
        return Ok(plans
            .map(|(model, placing)| ObjectPlan { model, placing })
            .collect());
    }
    let choices = library.choose(n_objects, scene.seed);
    placed(scene, kind, choices, library)
}

/// The chosen objects in their places.
fn placed(
    scene: &Scene,
    kind: SceneKind,
    choices: Vec<ModelChoice>,
    library: &mut ModelLibrary,
) -> Result<Vec<ObjectPlan>, Error> {
    let models = choices.iter().map(|choice| library.load(choice));
    let models: Vec<Arc<ObjectModel>> = models.collect::<Result<_, _>>()?;
    let models: Vec<&ObjectModel> = models.iter().map(|model| &**model).collect();
    let places = arrangement::place(kind, &models, &scene.table, scene.bin.as_ref(), scene.seed)?;
    let plans = choices.into_iter().zip(places);
    Ok(plans
        .map(|(model, placing)| ObjectPlan { model, placing })
        .collect())
}
