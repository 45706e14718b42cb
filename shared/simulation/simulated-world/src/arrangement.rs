//! Scene generators: random choice of objects and collision-free placement.

mod boards;
mod clutter;
mod scene_setting;

use crate::error::Error;
use crate::furniture::TableDimensions;
use crate::model_choice::ModelChoice;
use crate::object_model::ObjectModel;
use crate::random_stream::{random_rotation, random_stream};
use crate::scene::{ObjectPlacement, ObjectPlan, Scene};
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion};
use random::Random;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::PathBuf;

pub(crate) use boards::{Board, boards};
pub(crate) use clutter::clutter;
pub(crate) use scene_setting::SceneSetting;

/// Free space around an isolated object, metres; the next value is used when the one before
/// leaves no room. Chosen.
const GAPS_M: [f64; 4] = [0.06, 0.03, 0.03, 0.03];
/// Radius of the disc over which the objects of a pile are dropped, metres. Chosen.
const PILE_REACH_M: f64 = 0.05;
/// Drop height of the objects of a pile above the table, metres. Chosen.
const PILE_DROP_M: f64 = 0.30;
/// Drop height of the objects of a bin above the table, metres. Chosen.
const BIN_DROP_M: f64 = 0.36;

/// Random stream of the choice of models.
const STREAM_MODELS: u64 = 1;
/// Random stream of the placements.
const STREAM_PLACEMENT: u64 = 2;

/// Chooses `n_objects` random categories, each once before any is repeated, with random
/// instances.
pub(crate) fn choose(categories: &[&str], n_objects: usize, seed: u64) -> Vec<ModelChoice> {
    let mut random = random_stream(seed, STREAM_MODELS);
    let chosen = sample_in_rounds(categories, n_objects, &mut random);
    chosen
        .into_iter()
        .map(|category| ModelChoice::Generated {
            category: category.to_owned(),
            instance: random.next_u64() % 1000,
        })
        .collect()
}

/// Chooses `n_objects` random model files, each once before any is repeated.
pub(crate) fn choose_files(files: &[PathBuf], n_objects: usize, seed: u64) -> Vec<ModelChoice> {
    let chosen = sample_in_rounds(files, n_objects, &mut random_stream(seed, STREAM_MODELS));
    chosen.into_iter().map(ModelChoice::File).collect()
}

fn sample_in_rounds<T: Clone>(items: &[T], n: usize, random: &mut Random) -> Vec<T> {
    let mut left: Vec<T> = Vec::new();
    let mut chosen = Vec::new();
    while chosen.len() < n && !items.is_empty() {
        if left.is_empty() {
            left = items.to_vec();
        }
        chosen.push(left.swap_remove(random.below(left.len())));
    }
    chosen
}

/// Placement rule for models without a plan of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlacementRule {
    /// Upright at random free positions, on all boards.
    Apart,
    /// Dropped onto one spot of the table.
    Pile,
    /// Dropped into the bin.
    Bin,
}

/// Placements of the models by a rule.
///
/// # Errors
/// [`Error::NoRoom`] when isolated objects do not all fit onto the table.
pub(crate) fn place(
    rule: PlacementRule,
    models: &[&ObjectModel],
    scene: &Scene,
) -> Result<Vec<ObjectPlacement>, Error> {
    let mut random = random_stream(scene.seed, STREAM_PLACEMENT);
    let table = &scene.table;
    match rule {
        PlacementRule::Apart => isolated(models, &boards(scene), &mut random),
        PlacementRule::Pile => Ok(dropped(
            models.len(),
            table,
            PILE_DROP_M,
            &mut random,
            |r| {
                let (angle, reach) = (r.between(0.0, TAU), PILE_REACH_M * r.unit().sqrt());
                [reach * angle.cos(), reach * angle.sin()]
            },
        )),
        PlacementRule::Bin => {
            let inner_size_m = scene.bin.unwrap_or_default().inner_size_m;
            let [x, y, _] = inner_size_m.map(|side| side * 0.25);
            Ok(dropped(models.len(), table, BIN_DROP_M, &mut random, |r| {
                [r.between(-x, x), r.between(-y, y)]
            }))
        }
    }
}

fn dropped(
    n_objects: usize,
    table: &TableDimensions,
    drop_m: f64,
    random: &mut Random,
    spot: impl Fn(&mut Random) -> [f64; 2],
) -> Vec<ObjectPlacement> {
    (0..n_objects)
        .map(|_| {
            let [x, y] = spot(random);
            let position = Translation3::new(x, y, table.height_m + drop_m);
            ObjectPlacement::Dropped {
                world_from_object: RigidTransform::from_parts(position, random_rotation(random)),
            }
        })
        .collect()
}

/// Isolated objects on boards.
fn isolated(
    models: &[&ObjectModel],
    boards: &[Board],
    random: &mut Random,
) -> Result<Vec<ObjectPlacement>, Error> {
    let mut most = 0;
    for gap_m in GAPS_M {
        let places = boards::place_apart(models, boards, gap_m, random);
        if places.len() == models.len() {
            return Ok(places);
        }
        most = most.max(places.len());
    }
    Err(Error::NoRoom {
        n_objects: models.len(),
        n_placed: most,
    })
}

/// Set table: place settings along the long sides and shared objects between them. Categories
/// that are not in `categories` are left out.
pub(crate) fn set_table(categories: &[&str], n_objects: usize, seed: u64) -> Vec<ObjectPlan> {
    let mut random = random_stream(seed, STREAM_PLACEMENT);
    let family = random.next_u64() % 1000;
    let mut laid = Vec::new();
    let n_seats =
        (n_objects.saturating_sub(SHARED.len()) / PLACE_SETTING.len()).clamp(1, SEATS.len());
    for (x, y, turn) in SEATS.into_iter().take(n_seats) {
        for (category, across, along, yaw_rad) in PLACE_SETTING {
            let (sin, cos) = f64::sin_cos(turn);
            let spot = [
                x + across * cos - along * sin,
                y + across * sin + along * cos,
            ];
            laid.push((category, family, spot, yaw_rad + turn));
        }
    }
    for (category, spot) in SHARED {
        let yaw_rad = random.between(-PI, PI);
        laid.push((category, random.next_u64() % 1000, spot, yaw_rad));
    }
    laid.into_iter()
        .filter(|(category, ..)| categories.contains(category))
        .take(n_objects)
        .map(|(category, instance, spot, yaw_rad)| {
            let jitter = |r: &mut Random| r.between(-0.006, 0.006);
            ObjectPlan {
                model: ModelChoice::Generated {
                    category: category.to_owned(),
                    instance,
                },
                placement: ObjectPlacement::Upright {
                    position_m: spot.map(|v| v + jitter(&mut random)),
                    yaw_rad: yaw_rad + random.between(-0.06, 0.06),
                    raised_m: 0.0,
                },
            }
        })
        .collect()
}

/// Positions (x, y) in metres and yaw in radians of the place settings.
const SEATS: [(f64, f64, f64); 4] = [
    (-0.25, -0.17, 0.0),
    (0.25, -0.17, 0.0),
    (0.25, 0.19, PI),
    (-0.25, 0.19, PI),
];

/// Place setting: category, offset to the right of and beyond the plate's middle in metres, yaw
/// in radians.
const PLACE_SETTING: [(&str, f64, f64, f64); 5] = [
    ("plate", 0.0, 0.0, 0.0),
    ("fork", -0.155, 0.0, FRAC_PI_2),
    ("knife", 0.150, 0.0, FRAC_PI_2),
    ("spoon", 0.185, 0.0, FRAC_PI_2),
    ("mug", 0.13, 0.17, 0.4),
];

/// Shared objects between the place settings: category and position in metres.
const SHARED: [(&str, [f64; 2]); 4] = [
    ("vase", [0.0, 0.08]),
    ("bottle", [-0.07, -0.04]),
    ("salt-shaker", [0.03, -0.05]),
    ("bowl", [0.0, -0.20]),
];

/// Pose of an upright object whose bounding box is `lift_m` above the table.
pub(crate) fn upright_pose(
    model: &ObjectModel,
    table: &TableDimensions,
    position_m: [f64; 2],
    yaw_rad: f64,
    lift_m: f64,
) -> RigidTransform {
    let z = table.height_m + model.half_sides_m.z + lift_m;
    RigidTransform::from_parts(
        Translation3::new(position_m[0], position_m[1], z),
        UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), yaw_rad),
    )
}
