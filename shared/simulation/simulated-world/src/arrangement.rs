//! Seeded generators: which objects, and where they stand or fall.

use crate::chance;
use crate::error::Error;
use crate::object_model::ObjectModel;
use crate::scene::{Bin, ModelChoice, Placing, SceneKind, Table};
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion};
use random::Random;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::PathBuf;

/// Free space around an isolated object, metres; the second is taken when the
/// first leaves no place.
const GAPS_M: [f64; 2] = [0.06, 0.03];
/// Distance of an isolated object from the table's rim, metres.
const RIM_M: f64 = 0.05;
/// Part of the table that the default camera sees well, half sides, metres.
const IN_VIEW_HALF_M: [f64; 2] = [0.46, 0.30];
/// Tries to find a place for one object.
const N_TRIES: usize = 400;
/// How far from the middle the objects of a pile are let go, metres.
const PILE_REACH_M: f64 = 0.05;
/// Height over the table from which objects are let go, metres.
const PILE_DROP_M: f64 = 0.30;
const BIN_DROP_M: f64 = 0.36;

/// Purposes of random streams.
const CHOOSE: u64 = 1;
const PLACE: u64 = 2;

/// Chooses `n_objects` of the categories, each once before one comes twice.
pub(crate) fn choose(categories: &[&str], n_objects: usize, seed: u64) -> Vec<ModelChoice> {
    let mut random = chance::stream(seed, CHOOSE);
    let chosen = in_turn(categories, n_objects, &mut random);
    chosen
        .into_iter()
        .map(|category| ModelChoice::Generated {
            category: category.to_owned(),
            instance: random.next_u64() % 1000,
        })
        .collect()
}

/// Chooses `n_objects` of the model files, each once before one comes twice.
pub(crate) fn choose_files(files: &[PathBuf], n_objects: usize, seed: u64) -> Vec<ModelChoice> {
    let chosen = in_turn(files, n_objects, &mut chance::stream(seed, CHOOSE));
    chosen.into_iter().map(ModelChoice::File).collect()
}

fn in_turn<T: Clone>(items: &[T], n: usize, random: &mut Random) -> Vec<T> {
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

/// Places for the models, by the kind of scene. A set table says itself what
/// stands on it, see [`set_table`].
///
/// # Errors
/// When isolated objects do not find a place each.
pub(crate) fn place(
    kind: SceneKind,
    models: &[&ObjectModel],
    table: &Table,
    bin: Option<&Bin>,
    seed: u64,
) -> Result<Vec<Placing>, Error> {
    let mut random = chance::stream(seed, PLACE);
    match kind {
        SceneKind::Isolated | SceneKind::SetTable => isolated(models, table, &mut random),
        SceneKind::Pile => Ok(thrown(models.len(), table, PILE_DROP_M, &mut random, |r| {
            let (angle, reach) = (r.between(0.0, TAU), PILE_REACH_M * r.unit().sqrt());
            [reach * angle.cos(), reach * angle.sin()]
        })),
        SceneKind::Bin => {
            let inner_size_m = bin.copied().unwrap_or_default().inner_size_m;
            let [x, y, _] = inner_size_m.map(|side| side * 0.25);
            Ok(thrown(models.len(), table, BIN_DROP_M, &mut random, |r| {
                [r.between(-x, x), r.between(-y, y)]
            }))
        }
    }
}

fn thrown(
    n_objects: usize,
    table: &Table,
    drop_m: f64,
    random: &mut Random,
    spot: impl Fn(&mut Random) -> [f64; 2],
) -> Vec<Placing> {
    (0..n_objects)
        .map(|_| {
            let [x, y] = spot(random);
            let position = Translation3::new(x, y, table.height_m + drop_m);
            Placing::Dropped {
                world_from_object: RigidTransform::from_parts(position, chance::rotation(random)),
            }
        })
        .collect()
}

fn isolated(
    models: &[&ObjectModel],
    table: &Table,
    random: &mut Random,
) -> Result<Vec<Placing>, Error> {
    let mut most = 0;
    for gap_m in GAPS_M {
        let places = apart(models, table, gap_m, random);
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

/// Places the largest objects first, as many as fit; in the models' order.
fn apart(models: &[&ObjectModel], table: &Table, gap_m: f64, random: &mut Random) -> Vec<Placing> {
    let radii: Vec<f64> = models.iter().map(|m| m.footprint_radius_m()).collect();
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by(|&a, &b| radii[b].total_cmp(&radii[a]));
    let mut taken: Vec<([f64; 2], f64)> = Vec::new();
    let mut places = vec![None; models.len()];
    for index in order {
        let Some(spot) = free_spot(&taken, radii[index], table, gap_m, random) else {
            continue;
        };
        taken.push((spot, radii[index]));
        places[index] = Some(Placing::Upright {
            position_m: spot,
            yaw_rad: random.between(-PI, PI),
        });
    }
    places.into_iter().flatten().collect()
}

/// A place for a disc of `radius_m`, at least `gap_m` from the taken ones and
/// in the part of the table that is seen well.
pub(crate) fn free_spot(
    taken: &[([f64; 2], f64)],
    radius_m: f64,
    table: &Table,
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

/// A laid table: covers along the long sides, and what is shared between them.
/// Categories that are not among those given are left out.
pub(crate) fn set_table(
    categories: &[&str],
    n_objects: usize,
    seed: u64,
) -> Vec<(ModelChoice, Placing)> {
    let mut random = chance::stream(seed, PLACE);
    let family = random.next_u64() % 1000;
    let mut laid = Vec::new();
    let n_seats = (n_objects.saturating_sub(SHARED.len()) / COVER.len()).clamp(1, SEATS.len());
    for (x, y, turn) in SEATS.into_iter().take(n_seats) {
        for (category, across, along, yaw_rad) in COVER {
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
            let model = ModelChoice::Generated {
                category: category.to_owned(),
                instance,
            };
            let placing = Placing::Upright {
                position_m: spot.map(|v| v + jitter(&mut random)),
                yaw_rad: yaw_rad + random.between(-0.06, 0.06),
            };
            (model, placing)
        })
        .collect()
}

/// Middles of the covers, and the way they are turned.
const SEATS: [(f64, f64, f64); 4] = [
    (-0.25, -0.17, 0.0),
    (0.25, -0.17, 0.0),
    (0.25, 0.19, PI),
    (-0.25, 0.19, PI),
];

/// One cover: category, place to the right of and beyond the plate's middle, turn.
const COVER: [(&str, f64, f64, f64); 5] = [
    ("plate", 0.0, 0.0, 0.0),
    ("fork", -0.155, 0.0, FRAC_PI_2),
    ("knife", 0.150, 0.0, FRAC_PI_2),
    ("spoon", 0.185, 0.0, FRAC_PI_2),
    ("mug", 0.13, 0.17, 0.4),
];

/// What stands between the covers.
const SHARED: [(&str, [f64; 2]); 4] = [
    ("vase", [0.0, 0.08]),
    ("bottle", [-0.07, -0.04]),
    ("salt-shaker", [0.03, -0.05]),
    ("bowl", [0.0, -0.20]),
];

/// The pose of an object that stands with its bounding box `lift_m` over the table.
pub(crate) fn upright_pose(
    model: &ObjectModel,
    table: &Table,
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
