//! Arrangements: object placement on the synthetic table.

use super::TABLE_HEIGHT_M;
use super::catalogue::{BLOCKS, KINDS, ObjectKind};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, UnitQuaternion, Vector3};

/// Positions on the table, world x and y, metres. In two rows; the front row fills the
/// gaps of the back row as seen by the camera, and any two kinds may be neighbours.
const PLACES_M: [[f64; 2]; 5] = [
    [-0.41, 0.19],
    [-0.175, -0.195],
    [-0.02, 0.19],
    [0.145, -0.195],
    [0.36, 0.19],
];

/// Largest random offset from a position along x and y, metres. Chosen.
const SCATTER_M: f64 = 0.015;

/// Range of yaw angles, radians, in which the camera sees the joint of the mug's handle,
/// which lies along the object's x axis.
const YAW_RANGE: [f64; 2] = [-2.35, -0.6];

/// Ground truth of one object on the table.
#[derive(Debug, Clone)]
pub struct TableObject {
    /// Name of the object's kind.
    pub name: &'static str,
    /// Pose of the object frame (z up, origin in the middle of its base) in the world.
    pub world_from_object: RigidTransform,
    /// Smallest box along the object's own axes, world frame.
    pub bounds_in_world: OrientedBox,
    pub(super) kind: &'static ObjectKind,
}

impl TableObject {
    /// Centre of the bounding box, world frame.
    pub fn centre_in_world(&self) -> Point3<f64> {
        self.bounds_in_world.centre()
    }

    fn standing(kind: &'static ObjectKind, at: Point3<f64>, yaw_rad: f64) -> Self {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        let world_from_object = RigidTransform::from_parts(at.into(), yaw);
        let [low, high] = kind.corners.map(Vector3::from);
        let centre = nalgebra::Translation3::from(0.5 * (low + high));
        let bounds_in_world = OrientedBox {
            frame_from_box: world_from_object * centre,
            half_sides_m: 0.5 * (high - low),
        };
        Self {
            name: kind.name,
            world_from_object,
            bounds_in_world,
            kind,
        }
    }
}

/// Objects of an arrangement, one for each position.
///
/// From one arrangement to the next every kind moves on by one place, so that
/// among any eight in a row no kind stands twice at the same place.
pub(super) fn objects(arrangement: u32) -> Vec<TableObject> {
    let n_kinds = KINDS.len();
    let shift = arrangement as usize % n_kinds;
    let place_of = |(place_idx, place): (usize, &[f64; 2])| {
        let kind_idx = (place_idx + n_kinds - shift) % n_kinds;
        let bits = random::counter_based(u64::from(arrangement) << 8 | place_idx as u64);
        let scatter = |bits| SCATTER_M * (2.0 * random::unit(bits) - 1.0);
        let x = place[0] + scatter(bits);
        let y = place[1] + scatter(random::counter_based(bits));
        let at = Point3::new(x, y, TABLE_HEIGHT_M);
        TableObject::standing(&KINDS[kind_idx], at, yaw_rad(kind_idx, arrangement))
    };
    PLACES_M.iter().enumerate().map(place_of).collect()
}

/// Number of columns and rows of a crowd, along world x and y.
const CROWD_PLACES: [u32; 2] = [20, 13];

/// Distance between neighbouring blocks of a crowd along x and y, metres.
const CROWD_PITCH_M: [f64; 2] = [0.061, 0.056];

/// Largest number of blocks of a crowd.
pub(super) const CROWD_MAX: u32 = 256;

/// Blocks at the first `n` positions of the crowd, without those that are away.
pub(super) fn crowd(n: u32, is_away: impl Fn(u32) -> bool) -> Vec<TableObject> {
    let [n_columns, n_rows] = CROWD_PLACES;
    let along = |i: u32, n: u32, pitch: f64| (f64::from(i) - 0.5 * f64::from(n - 1)) * pitch;
    let block = |i: u32| {
        let x = along(i % n_columns, n_columns, CROWD_PITCH_M[0]);
        let y = along(i / n_columns, n_rows, CROWD_PITCH_M[1]);
        let bits = random::counter_based(u64::from(i));
        let yaw_rad = 0.4 * (random::unit(bits) - 0.5);
        let kind = &BLOCKS[(bits & 3) as usize];
        TableObject::standing(kind, Point3::new(x, y, TABLE_HEIGHT_M), yaw_rad)
    };
    let there = (0..n.min(CROWD_MAX)).filter(|place| !is_away(*place));
    there.map(block).collect()
}

/// Low-discrepancy yaw angle: golden-section steps spread any number of yaws over the
/// range.
fn yaw_rad(kind_idx: usize, arrangement: u32) -> f64 {
    let steps = kind_idx as f64 * 0.29 + f64::from(arrangement) * 0.618_033_988_75;
    YAW_RANGE[0] + (YAW_RANGE[1] - YAW_RANGE[0]) * steps.fract()
}
