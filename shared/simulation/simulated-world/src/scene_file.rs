//! Scene construction from TOML files and from seeded generators.
//!
//! A file may name a generator (`kind`), place objects one by one (`[[object]]`), or both;
//! missing keys have the defaults of the generated scenes. Unknown keys are errors.

mod raw_scene;
mod scene_variation;

use crate::action::PersonPlan;
use crate::arm_mount::ArmMount;
use crate::arrangement::{self, PlacementRule, SceneSetting};
use crate::error::Error;
use crate::furniture::{Bin, Shelf, Tray};
use crate::model_choice::{ModelChoice, ModelSource};
use crate::model_library::{ModelLibrary, category_names};
use crate::object_model::ObjectModel;
use crate::scene::{ObjectPlan, Scene, SceneKind};
use std::path::Path;
use std::sync::Arc;

/// Greatest number of objects of a scene.
pub const MAX_OBJECTS: usize = 60;
/// Default number of objects of [`Scene::everyday`].
pub const EVERYDAY_OBJECTS: usize = 5;
/// Default pause between a person's random actions, seconds: shortest and longest. Chosen.
const RANDOM_PAUSE_S: [f64; 2] = [6.0, 14.0];
/// Initial categories of [`Scene::everyday`]: objects that a Kinect sees well and that look
/// different from each other.
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
/// Greatest size of a scene file, bytes.
const MOST_BYTES: u64 = 1 << 20;

impl Scene {
    /// Generates a scene. The same kind, number, seed and models give the same scene.
    ///
    /// # Errors
    /// [`Error::NoRoom`] when isolated objects do not all fit, or an error of an unusable model.
    pub fn generate(
        kind: SceneKind,
        n_objects: usize,
        seed: u64,
        library: &mut ModelLibrary,
    ) -> Result<Self, Error> {
        let setting = SceneSetting::of(Some(kind), seed);
        let table = setting.table();
        let mut scene = Self {
            seed,
            table,
            table_finish: setting.table_finish(),
            bin: (kind == SceneKind::Bin).then(Bin::default),
            shelf: (kind == SceneKind::Shelf).then(Shelf::default),
            tray: (kind == SceneKind::Tray).then(Tray::default),
            camera: setting.camera(&table, n_objects),
            ..Self::default()
        };
        scene.objects = generated_objects(&scene, kind, n_objects, library)?;
        Ok(scene)
    }

    /// Scene of given objects, upright and apart from each other at random free positions and
    /// yaws.
    ///
    /// # Errors
    /// [`Error::NoRoom`] when they do not all fit, or an error of an unusable model.
    pub fn isolated(
        choices: Vec<ModelChoice>,
        seed: u64,
        library: &mut ModelLibrary,
    ) -> Result<Self, Error> {
        let mut scene = Self {
            seed,
            ..Self::default()
        };
        scene.objects = placed(&scene, PlacementRule::Apart, choices, library)?;
        Ok(scene)
    }

    /// Default scene of the daemon: some objects, an arm, and a person who at times moves, adds
    /// or takes one.
    ///
    /// # Errors
    /// As for [`generate`](Self::generate).
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
        scene.objects = placed(&scene, PlacementRule::Apart, choices, library)?;
        scene.arm = Some(ArmMount::default());
        scene.person = Some(PersonPlan {
            random_pause_s: Some(RANDOM_PAUSE_S),
            ..PersonPlan::default()
        });
        Ok(scene)
    }

    /// Scene from the text of a TOML file; paths in it are relative to `folder`. Opens the
    /// library that the file names. A `seed` argument overrides the file's.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key and the violated rule, or an error of the models.
    pub fn from_toml(
        text: &str,
        folder: &Path,
        seed: Option<u64>,
    ) -> Result<(Self, ModelLibrary), Error> {
        raw_scene::scene(text, folder, seed)
    }

    /// Scene read from a TOML file.
    ///
    /// # Errors
    /// [`Error::Unreadable`], or as for [`from_toml`](Self::from_toml).
    pub fn open(path: &Path, seed: Option<u64>) -> Result<(Self, ModelLibrary), Error> {
        let unreadable = |error| Error::unreadable(path, &error);
        let size = std::fs::metadata(path).map_err(unreadable)?;
        if !size.is_file() || size.len() > MOST_BYTES {
            let rule = "it is not a file of at most 1 MiB";
            return Err(Error::unreadable(path, &rule));
        }
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        Self::from_toml(&text, path.parent().unwrap_or(Path::new("")), seed)
    }
}

/// Objects that a scene generator places.
fn generated_objects(
    scene: &Scene,
    kind: SceneKind,
    n_objects: usize,
    library: &mut ModelLibrary,
) -> Result<Vec<ObjectPlan>, Error> {
    if n_objects > MAX_OBJECTS {
        return Err(Error::Scene {
            place: "objects".into(),
            rule: format!("at most {MAX_OBJECTS} fit a scene, not {n_objects}"),
        });
    }
    let rule = match kind {
        SceneKind::Clutter => {
            return arrangement::clutter(&scene.table, n_objects, scene.seed, library);
        }
        SceneKind::SetTable if *library.source() == ModelSource::Generated => {
            return set_table(n_objects, scene.seed);
        }
        // Models of a folder have no place at a set table.
        SceneKind::Isolated | SceneKind::SetTable | SceneKind::Shelf | SceneKind::Tray => {
            PlacementRule::Apart
        }
        SceneKind::Pile => PlacementRule::Pile,
        SceneKind::Bin => PlacementRule::Bin,
    };
    let choices = match kind {
        SceneKind::Shelf | SceneKind::Tray => fitting(scene, n_objects, library)?,
        _ => library.choose(n_objects, scene.seed),
    };
    placed(scene, rule, choices, library)
}

/// Chosen models that fit onto a board; onto the tray at least, if there is one.
fn fitting(
    scene: &Scene,
    n_objects: usize,
    library: &mut ModelLibrary,
) -> Result<Vec<ModelChoice>, Error> {
    let mut boards = arrangement::boards(scene);
    if scene.tray.is_some() {
        // The tray comes first.
        boards.truncate(1);
    }
    let mut chosen = Vec::with_capacity(n_objects);
    for choice in library.choose(MAX_OBJECTS, scene.seed) {
        if chosen.len() == n_objects {
            break;
        }
        let model = library.load(&choice)?;
        if boards.iter().any(|board| board.fits(&model)) {
            chosen.push(choice);
        }
    }
    if chosen.len() < n_objects {
        return Err(Error::NoRoom {
            n_objects,
            n_placed: chosen.len(),
        });
    }
    Ok(chosen)
}

/// Generated objects of a set table.
fn set_table(n_objects: usize, seed: u64) -> Result<Vec<ObjectPlan>, Error> {
    let laid = arrangement::set_table(&category_names(), n_objects, seed);
    if laid.len() < n_objects {
        return Err(Error::NoRoom {
            n_objects,
            n_placed: laid.len(),
        });
    }
    Ok(laid)
}

/// Objects of the chosen models with their placements.
fn placed(
    scene: &Scene,
    rule: PlacementRule,
    choices: Vec<ModelChoice>,
    library: &mut ModelLibrary,
) -> Result<Vec<ObjectPlan>, Error> {
    let models = choices.iter().map(|choice| library.load(choice));
    let models: Vec<Arc<ObjectModel>> = models.collect::<Result<_, _>>()?;
    let models: Vec<&ObjectModel> = models.iter().map(|model| &**model).collect();
    let places = arrangement::place(rule, &models, scene)?;
    let plans = choices.into_iter().zip(places);
    Ok(plans
        .map(|(model, placing)| ObjectPlan {
            model,
            placement: placing,
        })
        .collect())
}
