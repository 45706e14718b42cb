//! Trivial rival of the planner: from straight above, across the shorter side of the object's upright
//! bounding box.

use super::mujoco_judge::JudgedGrasp;
use arm_kinematics::GripperModel;
use geometry::{BoundingRectangle, ConvexPolygon, RigidTransform};
use nalgebra::{Matrix3, Point2, Point3, Rotation3, UnitQuaternion, Vector3};
use scene_client::Snapshot;

/// Height of the fingertips over the table at least, metres.
const OVER_TABLE_M: f64 = 0.003;
/// Length of the approach, metres.
const APPROACH_M: f64 = 0.10;

/// Grasp of the rival; `None` for an object without a bounding box, or one that is too wide.
pub(super) fn rival_grasp(
    snapshot: &Snapshot,
    object: usize,
    gripper: &GripperModel,
    friction: f64,
) -> Option<JudgedGrasp> {
    let pose = snapshot.pose();
    let points = snapshot.objects[object].points.iter();
    let places: Vec<Point3<f64>> = points
        .map(|point| pose * Point3::from(*point).cast::<f64>())
        .collect();
    let mut outline: Vec<Point2<f64>> = places.iter().map(Point3::xy).collect();
    let hull = ConvexPolygon::convex_hull_of(&mut outline);
    let rectangle = BoundingRectangle::of_outline(hull.corners())?;
    let top_m = places.iter().fold(f64::NEG_INFINITY, |top, p| top.max(p.z));
    let middle = Point3::new(rectangle.centre.x, rectangle.centre.y, top_m);
    let table_m = top_m - snapshot.table_in_world()?.height_m(&middle).abs();
    let (sine, cosine) = rectangle.yaw_rad.sin_cos();
    let closing = Vector3::new(-sine, cosine, 0.0);
    let width_m = 2.0 * rectangle.half_sides_m.y;
    if width_m > gripper.max_opening_m {
        return None;
    }
    let half_pad_m = 0.5 * gripper.pad_length_m;
    let lowest_m = table_m + OVER_TABLE_M + half_pad_m;
    let z = (0.5 * (top_m + table_m))
        .max(top_m - gripper.palm_m)
        .max(lowest_m);
    let down = -Vector3::z();
    let axes = Matrix3::from_columns(&[closing, down.cross(&closing), down]);
    let rotation = Rotation3::from_matrix_unchecked(axes);
    Some(JudgedGrasp {
        world_from_tool: RigidTransform::from_parts(
            Vector3::new(middle.x, middle.y, z).into(),
            UnitQuaternion::from_rotation_matrix(&rotation),
        ),
        opening_m: (width_m + 0.04).min(gripper.max_opening_m),
        approach_m: APPROACH_M,
        friction,
    })
}
