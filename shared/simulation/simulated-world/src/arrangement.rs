//! Scene generators: random choice of objects and collision-free placement.

mod clutter;
mod scene_setting;

use crate::error::Error;
use crate::furniture::{Bin, TableDimensions};
use crate::model_choice::ModelChoice;
use crate::object_model::ObjectModel;
use crate::random_stream::{random_rotation, random_stream};
use crate::scene::{ObjectPlacement, ObjectPlan};
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion};
use random::Random;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::PathBuf;

pub(crate) use clutter::clutter;
pub(crate) use scene_setting::SceneSetting;

/// Free space around an isolated object, metres; the second value is used when the first leaves
/// no room. Chosen.
const GAPS_M: [f64; 2] = [0.06, 0.03];
/// Distance of an isolated object from the table's edge, metres. Chosen.
const RIM_M: f64 = 0.05;
/// Half sides of the part of the table that the default camera sees well, metres.
const IN_VIEW_HALF_M: [f64; 2] = [0.46, 0.30];
/// Number of tries of rejection sampling per object. Chosen.
const N_TRIES: usize = 400;
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
    /// Upright at random free positions.
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
    table: &TableDimensions,
    bin: Option<&Bin>,
    seed: u64,
) -> Result<Vec<ObjectPlacement>, Error> {
    let mut random = random_stream(seed, STREAM_PLACEMENT);
    match rule {
        PlacementRule::Apart => isolated(models, table, &mut random),
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
            let inner_size_m = bin.copied().unwrap_or_default().inner_size_m;
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

fn isolated(
    models: &[&ObjectModel],
    table: &TableDimensions,
    random: &mut Random,
) -> Result<Vec<ObjectPlacement>, Error> {
    let mut most = 0;
    for gap_m in GAPS_M {
        let places = place_apart(models, table, gap_m, random);
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

/// Places as many isolated objects as fit, the largest first; returns placements in the models'
/// order.
fn place_apart(
    models: &[&ObjectModel],
    table: &TableDimensions,
    gap_m: f64,
    random: &mut Random,
) -> Vec<ObjectPlacement> {
    let radii: Vec<f64> = models.iter().map(|m| m.footprint_radius_m()).collect();
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by(|&a, &b| radii[b].total_cmp(&radii[a]));
    let mut taken: Vec<([f64; 2], f64)> = Vec::new();
    let mut places = vec![None; models.len()];
    for index in order {
        let Some(spot) = free_position(&taken, radii[index], table, gap_m, random) else {
            continue;
        };
        taken.push((spot, radii[index]));
        places[index] = Some(ObjectPlacement::Upright {
            position_m: spot,
            yaw_rad: random.between(-PI, PI),
        });
    }
    places.into_iter().flatten().collect()
}

/// Rejection sampling of a free position for a disc of `radius_m`, at least `gap_m` from the
/// taken discs and in the part of the table that the camera sees well.
pub(crate) fn free_position(
    taken: &[([f64; 2], f64)],
    radius_m: f64,
    table: &TableDimensions,
    gap_m: f64,
    random: &mut Random,
) -> Option<[f64; 2]> {
    let half: [f64; 2] = std::array::from_fn(|axis| {
        (table.size_m[axis] / 2.0 - RIM_M - radius_m).min(IN_VIEW_HALF_M[axis])
    });
    if half.iter().any(|&half| half < 0.0) {
        return None;
    }
    (0..N_TRIES).find_map(|_| {
        let spot = half.map(|half| random.between(-half, half));
        let is_free = taken.iter().all(|&(other, other_radius_m)| {
            let distance_m = (spot[0] - other[0]).hypot(spot[1] - other[1]);
            distance_m > radius_m + other_radius_m + gap_m
        });
        is_free.then_some(spot)
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
