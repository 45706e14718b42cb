//! Object of known shape for tests and benchmarks: views of it by ray casting.

use geometry::PinholeCamera;
use model_construction::{PoseSigma, View};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use point_cloud::{Point, Rgba};
use random::Random;

/// Distance of the camera from the object, metres.
pub(crate) const DISTANCE_M: f64 = 0.8;

/// Standard deviation of the depth, metres.
const DEPTH_SIGMA_M: f64 = 0.001;

/// Box with a ball on one of its edges; or a ball alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TestObject {
    BoxWithBall,
    Ball,
}

impl TestObject {
    /// Signed distance of a place from the surface, metres.
    pub(crate) fn distance_m(self, place: &Point3<f64>) -> f64 {
        match self {
            Self::Ball => place.coords.norm() - 0.04,
            Self::BoxWithBall => {
                let half = Vector3::new(0.06, 0.04, 0.05);
                let beyond = place.coords.abs() - half;
                let outside = beyond.sup(&Vector3::zeros()).norm();
                let of_box = outside + beyond.max().min(0.0);
                let of_ball = (place - Point3::new(0.06, 0.01, 0.05)).norm() - 0.025;
                of_box.min(of_ball)
            }
        }
    }

    /// Segmented points that a camera sees, in its frame, with noise.
    pub(crate) fn points(self, world_from_camera: &Isometry3<f64>, seed: u64) -> Vec<Point> {
        let camera = PinholeCamera::KINECT_V1;
        let mut random = Random::from_seed(seed);
        let centre = camera.project(&(world_from_camera.inverse() * Point3::origin()));
        let Some(centre) = centre else {
            return Vec::new();
        };
        let mut points = Vec::new();
        for row in -100..100 {
            for column in -100..100 {
                let pixel = (
                    centre.x.round() + f64::from(column),
                    centre.y.round() + f64::from(row),
                );
                let ray = camera.ray(pixel.0, pixel.1);
                let Some(depth_m) = self.depth_m(world_from_camera, &ray) else {
                    continue;
                };
                let place = ray * (depth_m + DEPTH_SIGMA_M * random.normal());
                points.push(Point {
                    x: place.x as f32,
                    y: place.y as f32,
                    z: place.z as f32,
                    color: color(&(world_from_camera * Point3::from(ray * depth_m))),
                });
            }
        }
        points
    }

    /// Depth of the surface along a ray with a depth of 1, by sphere tracing.
    fn depth_m(self, world_from_camera: &Isometry3<f64>, ray: &Vector3<f64>) -> Option<f64> {
        let mut depth_m = 0.0;
        for _ in 0..100 {
            let distance_m = self.distance_m(&(world_from_camera * Point3::from(ray * depth_m)));
            depth_m += distance_m / ray.norm();
            if distance_m < 1e-5 {
                return Some(depth_m);
            }
            if depth_m > 2.0 {
                return None;
            }
        }
        None
    }
}

/// Pattern of stripes around the object.
fn color(place: &Point3<f64>) -> Rgba {
    let wave = |value: f64| (127.0 + 120.0 * (value / 0.006).sin()) as u8;
    Rgba::opaque(wave(place.x), wave(place.y), wave(place.z))
}

/// Pose of a camera that looks at the origin, by its azimuth and elevation, degrees.
pub(crate) fn world_from_camera(azimuth_deg: f64, elevation_deg: f64) -> Isometry3<f64> {
    let (sin_a, cos_a) = azimuth_deg.to_radians().sin_cos();
    let (sin_e, cos_e) = elevation_deg.to_radians().sin_cos();
    let outward = Vector3::new(cos_e * sin_a, -cos_e * cos_a, sin_e);
    let right = Vector3::z().cross(&outward).normalize();
    let down = right.cross(&outward);
    let rotation = Rotation3::from_basis_unchecked(&[right, down, -outward]);
    Isometry3::from_parts(
        Translation3::from(DISTANCE_M * outward),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

/// Pose with a random error about the camera.
pub(crate) fn disturbed(
    pose: &Isometry3<f64>,
    sigma: &PoseSigma,
    random: &mut Random,
) -> Isometry3<f64> {
    let rotation = Vector3::from_fn(|_, _| sigma.rotation_rad * random.normal());
    let shift = Vector3::from_fn(|_, _| sigma.translation_m * random.normal());
    pose * Isometry3::from_parts(
        Translation3::from(shift),
        UnitQuaternion::from_scaled_axis(rotation),
    )
}

/// View with a reported pose, taken after some half seconds.
pub(crate) fn view(
    points: &[Point],
    world_from_camera: impl Into<Option<Isometry3<f64>>>,
    sigma: PoseSigma,
    index: u64,
) -> View<'_> {
    View {
        points,
        camera: PinholeCamera::KINECT_V1,
        captured_ns: index * 500_000_000,
        world_from_camera: world_from_camera.into(),
        sigma,
        up_in_camera: None,
        placement: 0,
    }
}
