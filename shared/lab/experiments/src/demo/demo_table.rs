//! Table of a demonstration: its objects at random free positions, and the places to which they belong.

use super::run_record::DemoKind;
use crate::arguments::{DemoArguments, DemoVariant};
use random::Random;
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary, ModelSource};
use std::fmt::Write as _;

/// Categories of the first variant, with its standard item in front.
const FIRST: [&str; 11] = [
    "vase",
    "bottle",
    "mug",
    "soda-can",
    "milk-carton",
    "cereal-box",
    "tin-can",
    "jar",
    "apple",
    "juice-box",
    "sponge",
];
/// Categories of the second variant, with its standard item in front.
const SECOND: [&str; 11] = [
    "goblet",
    "teacup",
    "banana",
    "orange",
    "pear",
    "tomato",
    "shampoo",
    "salt-shaker",
    "tissue-box",
    "lemon",
    "thermos",
];
/// Purposes of the random numbers of a table.
const PURPOSE_CHOICE: u64 = 0xde_01;
const PURPOSE_POSITION: u64 = 0xde_02;
const PURPOSE_WISH: u64 = 0xde_03;
/// Number of tables of which one is asked for an object that it does not have.
const ABSENT_PERIOD: u64 = 5;
/// Fewest objects of a table, and the number of counts up to the most.
const N_OBJECTS_MIN: u64 = 5;
const N_COUNTS: u64 = 4;
/// Arm at the middle of the near rim, and the camera opposite to it, which sees the whole table.
const ARM_AND_CAMERA: &str = "
[arm]
position_m = [0.0, -0.50, 0.70]
yaw_deg = 90.0
[camera]
azimuth_deg = 180.0
elevation_deg = 50.0
distance_m = 1.1
look_at_m = [0.0, -0.1, 0.74]
";
/// Area of the objects seen from above, world, metres: within reach of the arm.
const LOW_M: [f64; 2] = [-0.22, -0.28];
const HIGH_M: [f64; 2] = [0.22, 0.12];
/// Free space between two objects, metres. Chosen.
const GAP_M: f64 = 0.05;
/// Number of attempts at a position, and at a whole table.
const N_POSITIONS: usize = 200;
const N_TABLES: usize = 500;

/// Object as the person puts it on the table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DemoObject {
    pub(super) category: String,
    model: ModelChoice,
    /// Middle seen from above, world, metres.
    pub(super) position_m: [f64; 2],
    yaw_deg: f64,
    /// True for an item that stays on the table.
    pub(super) is_standard: bool,
    /// True for an object that the robot is to carry.
    pub(super) is_wanted: bool,
    /// Index of the place to which it is carried.
    pub(super) place: usize,
}

/// Place on the table: a rectangle seen from above, world, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DemoPlace {
    pub(super) name: &'static str,
    low_m: [f64; 2],
    high_m: [f64; 2],
}

impl DemoPlace {
    /// True if a point seen from above is in the place.
    pub(super) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.low_m[0]..=self.high_m[0]).contains(&x)
            && (self.low_m[1]..=self.high_m[1]).contains(&y)
    }
}

/// Places of the categories, on both sides of the objects.
pub(super) const PLACES: [DemoPlace; 3] = [
    DemoPlace {
        name: "pantry",
        low_m: [-0.58, -0.37],
        high_m: [-0.28, -0.06],
    },
    DemoPlace {
        name: "kitchen",
        low_m: [0.28, -0.37],
        high_m: [0.58, -0.06],
    },
    DemoPlace {
        name: "hand-over",
        low_m: [0.28, -0.37],
        high_m: [0.58, -0.06],
    },
];
/// Index of the place of what is fetched; those before it are of categories.
const HAND_OVER: usize = 2;

/// Table of a demonstration.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DemoTable {
    pub(super) seed: u64,
    kind: DemoKind,
    pub(super) objects: Vec<DemoObject>,
    /// Category that the person asks for; of no object on every fifth table.
    pub(super) wanted: Option<String>,
}

impl DemoTable {
    /// Table of a seed.
    ///
    /// # Errors
    /// When a model cannot be used, or the objects find no room.
    pub(super) fn new(
        seed: u64,
        kind: DemoKind,
        arguments: &DemoArguments,
    ) -> Result<Self, Failure> {
        let mut library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
        let n_objects = arguments
            .objects
            .map_or_else(|| N_OBJECTS_MIN + seed % N_COUNTS, u64::from);
        let mut models = chosen(seed, n_objects as usize + 1, arguments.variant, &library);
        // The last one stays in the cupboard.
        let absent = models.pop().filter(|_| models.len() == n_objects as usize);
        let wanted = (kind == DemoKind::Fetch).then(|| wish(seed, &models, absent.as_ref()));
        let loaded: Result<Vec<_>, _> = models.iter().map(|model| library.load(model)).collect();
        let loaded = loaded.map_err(Failure::usage)?;
        let radii_m: Vec<f64> = loaded
            .iter()
            .map(|model| model.footprint_radius_m())
            .collect();
        let mut random = Random::substream(seed, PURPOSE_POSITION);
        let mut tables = (0..N_TABLES).filter_map(|_| positions(&radii_m, &mut random));
        let positions_m = tables.next().ok_or_else(|| {
            Failure::usage(format!(
                "the {n_objects} objects of seed {seed} find no room on the table; name fewer with \
                 --objects, or smaller models"
            ))
        })?;
        let objects = models.into_iter().zip(positions_m).enumerate();
        let objects = objects.map(|(number, (model, position_m))| {
            let category = model.category();
            let is_standard = number == 0;
            DemoObject {
                is_wanted: wanted
                    .as_ref()
                    .map_or(!is_standard, |wanted| *wanted == category),
                category,
                model,
                position_m,
                yaw_deg: random.between(0.0, 360.0),
                is_standard,
                place: match kind {
                    DemoKind::ClearTable => number % HAND_OVER,
                    DemoKind::Fetch => HAND_OVER,
                },
            }
        });
        Ok(Self {
            seed,
            kind,
            objects: objects.collect(),
            wanted,
        })
    }

    /// Categories of the objects, each once.
    fn categories(&self, is_wanted: impl Fn(&DemoObject) -> bool) -> Vec<&str> {
        let wanted = self.objects.iter().filter(|object| is_wanted(object));
        wanted.map(|object| object.category.as_str()).collect()
    }

    /// Scene file of the simulator.
    pub(super) fn scene_toml(&self) -> String {
        let mut text = format!("seed = {}\n{ARM_AND_CAMERA}", self.seed);
        for object in &self.objects {
            let [x, y] = object.position_m;
            let model = match &object.model {
                ModelChoice::Generated { category, instance } => {
                    format!("category = {category:?}\ninstance = {instance}")
                }
                ModelChoice::File(path) => format!("model = {:?}", path.display().to_string()),
            };
            // Writing to a text never fails.
            let _ = write!(
                text,
                "[[object]]\n{model}\nposition_m = [{x:.4}, {y:.4}]\nyaw_deg = {:.1}\n",
                object.yaw_deg
            );
        }
        text
    }

    /// Configuration of the daemon: places and rules of the task.
    pub(super) fn configuration_toml(&self) -> String {
        let standard = self.categories(|object| object.is_standard);
        let mut text = format!("[executive]\nstandard_items = {standard:?}\n");
        let places = match self.kind {
            DemoKind::ClearTable => 0..HAND_OVER,
            DemoKind::Fetch => HAND_OVER..PLACES.len(),
        };
        for number in places {
            let place = &PLACES[number];
            let is_carried = self.kind == DemoKind::ClearTable;
            let categories = self.categories(|o| is_carried && o.place == number && !o.is_standard);
            let ([x, y], [right, far]) = (place.low_m, place.high_m);
            let _ = write!(
                text,
                "[places.{}]\noutline = [[{x}, {y}], [{right}, {y}], [{right}, {far}], [{x}, \
                 {far}]]\ncategories = {categories:?}\n",
                place.name
            );
        }
        text
    }
}

/// Category that the person asks for: of one of the objects, and on every fifth table of an absent one.
fn wish(seed: u64, models: &[ModelChoice], absent: Option<&ModelChoice>) -> String {
    if let Some(absent) = absent.filter(|_| seed.is_multiple_of(ABSENT_PERIOD)) {
        return absent.category();
    }
    let number = Random::substream(seed, PURPOSE_WISH).below(models.len() - 1);
    models[1 + number].category()
}

/// Models of different categories, the standard item first.
fn chosen(
    seed: u64,
    n_objects: usize,
    variant: DemoVariant,
    library: &ModelLibrary,
) -> Vec<ModelChoice> {
    let mut random = Random::substream(seed, PURPOSE_CHOICE);
    if let ModelSource::Folder(_) = library.source() {
        let mut models = library.all(1, seed);
        random.shuffle(&mut models);
        let mut categories = Vec::new();
        models.retain(|model| {
            let category = model.category();
            let is_new = !categories.contains(&category);
            categories.push(category);
            is_new
        });
        models.truncate(n_objects);
        return models;
    }
    let names = match variant {
        DemoVariant::First => FIRST,
        DemoVariant::Second => SECOND,
    };
    let mut others = names[1..].to_vec();
    random.shuffle(&mut others);
    let names = names[..1].iter().copied().chain(others).take(n_objects);
    let models = names.map(|name| ModelChoice::Generated {
        category: name.to_owned(),
        instance: random.next_u64() % 1000,
    });
    models.collect()
}

/// Free positions of objects with such footprints; `None` when one finds none.
fn positions(radii_m: &[f64], random: &mut Random) -> Option<Vec<[f64; 2]>> {
    let mut placed: Vec<([f64; 2], f64)> = Vec::new();
    for &radius_m in radii_m {
        let is_free = |[x, y]: &[f64; 2]| {
            let mut others = placed.iter();
            others.all(|([its_x, its_y], its_radius_m)| {
                (x - its_x).hypot(y - its_y) >= radius_m + its_radius_m + GAP_M
            })
        };
        let mut tried =
            (0..N_POSITIONS).map(|_| [0, 1].map(|axis| random.between(LOW_M[axis], HIGH_M[axis])));
        let position_m = tried.find(is_free)?;
        placed.push((position_m, radius_m));
    }
    Some(
        placed
            .into_iter()
            .map(|(position_m, _)| position_m)
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use simulated_world::Scene;
    use std::path::Path;

    #[derive(Parser)]
    struct DemoLine {
        #[command(flatten)]
        arguments: DemoArguments,
    }

    fn table(seed: u64, kind: DemoKind, words: &[&str]) -> DemoTable {
        let line = [&["demo", "--out", "o"], words].concat();
        DemoTable::new(seed, kind, &DemoLine::parse_from(line).arguments).unwrap()
    }

    #[test]
    fn tables_repeat_and_have_one_standard_item() {
        for seed in 1..=30 {
            let table_of = |variant| table(seed, DemoKind::ClearTable, &["--variant", variant]);
            let first = table_of("first");
            assert_eq!(first, table_of("first"));
            assert_ne!(first, table_of("second"));
            assert!((5..=8).contains(&first.objects.len()));
            assert_eq!(first.categories(|object| object.is_standard), ["vase"]);
            let all = first.categories(|_| true);
            let different: std::collections::BTreeSet<_> = all.iter().collect();
            assert_eq!(different.len(), all.len());
        }
    }

    #[test]
    fn scene_of_a_table_has_its_objects() {
        let table = table(7, DemoKind::ClearTable, &[]);
        let (scene, _) = Scene::from_toml(&table.scene_toml(), Path::new("."), None).unwrap();
        assert_eq!(scene.objects.len(), table.objects.len());
        assert!(scene.arm.is_some());
    }

    #[test]
    fn objects_stand_outside_of_the_places() {
        for seed in 1..=30 {
            let objects = table(seed, DemoKind::ClearTable, &[]).objects;
            let is_placed =
                |object: &DemoObject| PLACES.iter().any(|place| place.contains(object.position_m));
            assert!(!objects.iter().any(is_placed));
        }
    }

    #[test]
    fn wanted_object_is_on_four_of_five_tables() {
        for seed in 1..=20 {
            let table = table(seed, DemoKind::Fetch, &[]);
            let n_wanted = table
                .objects
                .iter()
                .filter(|object| object.is_wanted)
                .count();
            assert!(!table.objects[0].is_wanted, "the standard item stays");
            assert_eq!(n_wanted, usize::from(seed % ABSENT_PERIOD != 0));
        }
    }
}
