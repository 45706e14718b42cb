//! Scenes of solids by their signed distance, seen by a noiseless depth camera (sphere tracing,
//! Hart 1996).

use geometry::{ConvexPolygon, PinholeCamera, Plane, RigidTransform};
use grasping::{GraspObject, GraspScene, ObservedSpace, SupportPlane};
use nalgebra::{Point2, Point3, Vector3};
use point_cloud::{Point, Rgba};

/// Number of steps of a ray, and the distance at which it hits, metres.
const N_STEPS: usize = 200;
const HIT_M: f64 = 2e-4;
/// Length of a ray, metres.
const FAR_M: f64 = 3.0;

/// Solid on the table, whose top is at z = 0.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Solid {
    /// Box by its middle, half sides and turn about the vertical, radians.
    Box(Point3<f64>, Vector3<f64>, f64),
    /// Ball by its middle and radius.
    Ball(Point3<f64>, f64),
    /// Upright tube without a lid: middle of its foot, outer radius, wall, height.
    Tube(Point3<f64>, f64, f64, f64),
}

impl Solid {
    pub(crate) fn distance_m(&self, place: &Point3<f64>) -> f64 {
        match *self {
            Self::Box(middle, half, turn_rad) => {
                let off = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), -turn_rad)
                    * (place - middle);
                let beyond = off.abs() - half;
                let inside = beyond.max().min(0.0);
                beyond.map(|c| c.max(0.0)).norm() + inside
            }
            Self::Ball(middle, radius_m) => (place - middle).norm() - radius_m,
            Self::Tube(foot, radius_m, wall_m, height_m) => {
                let off = place - foot;
                let round = (off.xy().norm() - (radius_m - wall_m / 2.0)).abs() - wall_m / 2.0;
                let up = (off.z - height_m / 2.0).abs() - height_m / 2.0;
                let wall = round.max(0.0).hypot(up.max(0.0)) + round.max(up).min(0.0);
                // The floor of the tube.
                let flat = off.xy().norm() - radius_m;
                let floor = (off.z - wall_m / 2.0).abs() - wall_m / 2.0;
                let floor = flat.max(0.0).hypot(floor.max(0.0)) + flat.max(floor).min(0.0);
                wall.min(floor)
            }
        }
    }
}

/// Image of solids on a table, from in front of it and above.
pub(crate) struct SolidScene {
    camera: PinholeCamera,
    plan_from_camera: RigidTransform,
    points: Vec<Point>,
    /// Points of each solid in the camera.
    objects: Vec<Vec<[f32; 3]>>,
}

impl SolidScene {
    /// Renders solids, the table included, from 0.9 m at 40°.
    pub(crate) fn new(solids: &[Solid]) -> Self {
        let eye = Point3::new(0.0, -0.69, 0.58);
        let target = Point3::new(0.0, 0.0, 0.03);
        let plan_from_camera = RigidTransform::face_towards(&eye, &target, &-Vector3::z());
        let camera = PinholeCamera::KINECT_V1;
        let mut scene = Self {
            camera,
            plan_from_camera,
            points: Vec::with_capacity(camera.n_pixels()),
            objects: vec![Vec::new(); solids.len()],
        };
        for row in 0..camera.height {
            for column in 0..camera.width {
                let ray = camera.ray(f64::from(column), f64::from(row));
                scene.add_pixel(&ray, solids);
            }
        }
        scene
    }

    fn add_pixel(&mut self, ray: &Vector3<f64>, solids: &[Solid]) {
        let direction = self.plan_from_camera.rotation * ray;
        let eye = Point3::from(self.plan_from_camera.translation.vector);
        let (mut along, per_depth) = (0.2, ray.norm());
        for _ in 0..N_STEPS {
            let place = eye + direction * along;
            let distances = solids.iter().map(|solid| solid.distance_m(&place));
            let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            let table_m = place.z;
            let (hit, distance_m) = match nearest {
                Some((index, distance_m)) if distance_m < table_m => (Some(index), distance_m),
                _ => (None, table_m),
            };
            if distance_m < HIT_M {
                let [x, y, z] = (ray * along).map(|c| c as f32).into();
                // The last millimetres over the table are no object for detection.
                if let Some(index) = hit.filter(|_| place.z > 0.003) {
                    self.objects[index].push([x, y, z]);
                }
                let color = Rgba::opaque(90, 90, 90);
                self.points.push(Point { x, y, z, color });
                return;
            }
            along += distance_m / per_depth;
            if along > FAR_M {
                break;
            }
        }
        self.points
            .push(Point::without_depth(Rgba::opaque(0, 0, 0)));
    }

    /// Grasp scene, with the solids as tracks from 1.
    pub(crate) fn grasp_scene(&self) -> GraspScene<'_> {
        let space = ObservedSpace::new(self.camera, self.plan_from_camera, &self.points);
        let objects = self
            .objects
            .iter()
            .zip(1..)
            .map(|(points, track)| GraspObject {
                track,
                points_in_camera: points.clone(),
                model: Vec::new(),
            });
        let mut corners = [[-0.5, -0.4], [0.5, -0.4], [0.5, 0.6], [-0.5, 0.6]].map(Point2::from);
        let table = SupportPlane {
            plane: Plane::through(&Point3::origin(), Vector3::z_axis()),
            outline: ConvexPolygon::convex_hull_of(&mut corners),
            name: "the table".to_owned(),
            is_solid_below: true,
        };
        GraspScene::new(
            space,
            objects.collect(),
            vec![table],
            Vec::new(),
            Vec::new(),
        )
    }
}
