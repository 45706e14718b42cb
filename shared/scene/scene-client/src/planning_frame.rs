//! Frame of planning: z against gravity, its origin in the middle of the objects.
//!
//! Numbers of single precision are exact enough in it, however far away the origin of the world is,
//! and a camera whose pose is unknown is levelled by it.

use crate::snapshot::Snapshot;
use geometry::{Plane, RigidTransform};
use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use point_cloud::Point;

/// Radius of the image's middle, as a share of its height, in which a place is looked for when
/// there are no objects.
const MIDDLE_SHARE: f64 = 0.1;

/// Height above the objects at which everything is above the table, metres.
const TOP_M: f64 = 100.0;

/// Pose of the frame of planning, with the camera and the table in it.
#[derive(Debug, Clone)]
pub struct PlanningFrame {
    /// Pose in the world, or in the frame of a camera whose pose is unknown.
    pub world_from_plan: RigidTransform,
    /// Pose of the camera.
    pub plan_from_camera: RigidTransform,
    /// Plane of the table with an upward normal.
    pub table_in_plan: Option<Plane>,
    /// Remarks for people.
    pub notes: Vec<String>,
}

impl PlanningFrame {
    /// Frame of a snapshot; `None` if there is neither an object nor a measured point in the middle
    /// of the image.
    pub fn of(snapshot: &Snapshot) -> Option<Self> {
        let world_from_camera = snapshot.pose();
        let mut notes = Vec::new();
        let up_in_world = up_in_world(snapshot, &mut notes);
        let middle_in_world = middle_in_world(snapshot)?;
        let z = Vector3::z_axis();
        let world_from_plan_rotation = UnitQuaternion::rotation_between(&z, &up_in_world)
            .unwrap_or_else(|| {
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
            });
        let world_from_plan = RigidTransform::from_parts(
            Translation3::from(middle_in_world.coords),
            world_from_plan_rotation,
        );
        let plan_from_world = world_from_plan.inverse();
        let overhead = Point3::new(0.0, 0.0, TOP_M);
        let table_in_plan = snapshot
            .table_in_world()
            .map(|plane| plane.transformed(&plan_from_world).facing(&overhead));
        Some(Self {
            world_from_plan,
            plan_from_camera: plan_from_world * world_from_camera,
            table_in_plan,
            notes,
        })
    }

    /// Height of a place above the table, metres; `None` without a table.
    pub fn height_m(&self, in_plan: &Point3<f64>) -> Option<f64> {
        Some(self.table_in_plan?.height_m(in_plan))
    }

    /// Poses in this frame.
    pub fn poses(&self, in_world: &[RigidTransform]) -> Vec<RigidTransform> {
        let plan_from_world = self.world_from_plan.inverse();
        in_world.iter().map(|pose| plan_from_world * pose).collect()
    }

    /// Measured point in this frame, metres.
    pub fn place(&self, in_camera: &Point) -> Point3<f64> {
        self.plan_from_camera * in_camera.position()
    }
}

/// Direction against gravity: z with a pose of the camera; else the measured one, the normal of the
/// table, or that of a level camera.
fn up_in_world(snapshot: &Snapshot, notes: &mut Vec<String>) -> Unit<Vector3<f64>> {
    if snapshot.world_from_camera.is_some() {
        return Vector3::z_axis();
    }
    let begin = "the pose of the camera in the world is unknown: all poses are in the frame of the \
                 camera as it was";
    if let Some(up) = snapshot.up_in_camera {
        notes.push(begin.to_owned());
        return up;
    }
    if let Some(table) = snapshot.table_in_world() {
        notes.push(format!("{begin}, and up is the normal of the table"));
        return table.facing(&Point3::origin()).normal;
    }
    notes.push(format!("{begin}, and the camera is taken as level"));
    -Vector3::y_axis()
}

/// Middle of the seen objects, or of the measured points in the middle of the image.
fn middle_in_world(snapshot: &Snapshot) -> Option<Point3<f64>> {
    let seen = snapshot.objects.iter().filter(|o| !o.points.is_empty());
    let (mut sum, mut n) = (Vector3::zeros(), 0.0);
    for object in seen {
        sum += object.middle_in_world.coords;
        n += 1.0;
    }
    if n > 0.0 {
        return Some((sum / n).into());
    }
    let camera = &snapshot.camera;
    let radius_px = MIDDLE_SHARE * f64::from(camera.height);
    let is_central = |index: usize| {
        let (column, row) = (index % camera.width as usize, index / camera.width as usize);
        let off = |at: usize, size: u32| at as f64 - f64::from(size) / 2.0;
        off(column, camera.width).hypot(off(row, camera.height)) < radius_px
    };
    let numbered = snapshot.points.iter().enumerate();
    let central = numbered.filter(|(index, point)| point.is_finite() && is_central(*index));
    let mut depths_m: Vec<f32> = central.map(|(_, point)| point.z).collect();
    depths_m.sort_unstable_by(f32::total_cmp);
    let depth_m = f64::from(*depths_m.get(depths_m.len() / 2)?);
    Some(snapshot.pose() * Point3::new(0.0, 0.0, depth_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_table::SceneSurface;
    use crate::snapshot::SnapshotObject;
    use geometry::PinholeCamera;
    use message::SurfaceKind;
    use message::TrackState;
    use point_cloud::Rgba;

    fn surface(plane_in_world: Plane) -> SceneSurface {
        SceneSurface {
            kind: SurfaceKind::Table,
            plane_in_world,
            corners_in_world: Vec::new(),
        }
    }

    /// Frame whose points are all 1 m deep.
    fn snapshot() -> Snapshot {
        let camera = PinholeCamera {
            fx_px: 20.0,
            fy_px: 20.0,
            cx_px: 15.5,
            cy_px: 11.5,
            width: 32,
            height: 24,
        };
        let place = |i: u32| camera.back_project(f64::from(i % 32), f64::from(i / 32), 1.0);
        let point = |i: u32| {
            let [x, y, z] = place(i).cast::<f32>().into();
            let color = Rgba::opaque(0, 0, 0);
            Point { x, y, z, color }
        };
        Snapshot::of_points(camera, (0..32 * 24).map(point).collect())
    }

    #[test]
    fn frame_of_a_camera_with_a_pose_is_the_world_about_the_objects() {
        let object = |track, x, points| SnapshotObject {
            track,
            label: None,
            categories: Vec::new(),
            state: TrackState::Tracked,
            middle_in_world: Point3::new(x, 20.0, 0.8),
            points,
        };
        let eye = Point3::new(50.0, 19.0, 1.5);
        let target = Point3::new(50.1, 20.0, 0.8);
        let pose = RigidTransform::face_towards(&eye, &target, &-Vector3::z());
        let table = Plane::through(&Point3::new(0.0, 0.0, 0.7), -Vector3::z_axis());
        let snapshot = Snapshot {
            world_from_camera: Some(pose),
            surfaces: vec![surface(table)],
            objects: vec![
                object(1, 50.0, vec![[0.0, 0.0, 1.0]]),
                object(2, 50.2, vec![[0.1, 0.0, 1.0]]),
                object(3, 90.0, Vec::new()),
            ],
            ..snapshot()
        };
        let frame = PlanningFrame::of(&snapshot).unwrap();
        assert!(frame.notes.is_empty());
        let middle = frame.world_from_plan.translation.vector;
        assert!((middle - target.coords).norm() < 1e-9, "{middle}");
        assert!(frame.world_from_plan.rotation.angle() < 1e-9);
        let height_m = frame.height_m(&Point3::origin()).unwrap();
        assert!((height_m - 0.1).abs() < 1e-9, "{height_m}");
    }

    #[test]
    fn frame_of_a_camera_without_a_pose_is_levelled_and_told() {
        let tilted = Unit::new_normalize(Vector3::new(0.0, -0.8, -0.6));
        let table = Plane::through(&Point3::new(0.0, 0.0, 1.0), -tilted);
        let cases = [
            (Some(tilted), None, tilted, "was"),
            (None, Some(table), tilted, "normal of the table"),
            (None, None, -Vector3::y_axis(), "taken as level"),
        ];
        for (up_in_camera, table_in_world, up, words) in cases {
            let snapshot = Snapshot {
                up_in_camera,
                surfaces: table_in_world.map(surface).into_iter().collect(),
                ..snapshot()
            };
            let frame = PlanningFrame::of(&snapshot).unwrap();
            assert!(frame.notes[0].contains(words), "{:?}", frame.notes);
            let z_in_camera = frame.plan_from_camera.inverse() * Vector3::z();
            assert!(
                (z_in_camera - up.into_inner()).norm() < 1e-9,
                "{z_in_camera}"
            );
            let middle = frame.world_from_plan.translation.vector;
            assert!((middle - Vector3::z()).norm() < 1e-6, "{middle}");
        }
    }

    #[test]
    fn nothing_in_the_middle_of_the_image_is_no_frame() {
        let mut empty = snapshot();
        for point in &mut empty.points {
            *point = Point::without_depth(Rgba::opaque(0, 0, 0));
        }
        assert!(PlanningFrame::of(&empty).is_none());
    }
}
