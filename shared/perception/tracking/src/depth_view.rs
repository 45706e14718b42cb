//! Occlusion test: rays through a box are compared with the depth image.

use crate::visibility::OcclusionState;
use geometry::{OrientedBox, PinholeCamera, RigidTransform};
use nalgebra::{Point3, Translation3, Vector3};
use point_cloud::Point;
use sensor_noise::DepthNoise;

/// Depth tolerance in sigmas of the depth noise. Chosen.
const DEPTH_TOLERANCE_SIGMAS: f64 = 4.0;

/// Smallest depth tolerance, metres. Chosen.
const DEPTH_TOLERANCE_MIN_M: f64 = 0.012;

/// Sample positions along each side of a box, relative to the half side. Chosen.
const SAMPLE_OFFSETS: [f64; 4] = [-0.8, -0.3, 0.3, 0.8];

/// Tested upper fraction of a box on a table; the foot is too close to the table behind
/// it. Chosen.
const UPPER_RATIO: f64 = 0.6;

/// Tested central fraction of the horizontal sides; the corners of round objects are
/// empty. Chosen.
const SIDE_RATIO: f64 = 0.9;

/// Fraction of samples outside the image above which a box is out of view. Chosen.
const OUT_OF_VIEW_FRACTION: f64 = 0.5;

/// Fraction of observed samples with free space above which a box is empty. It is below
/// 1 because of noise, and high because any object leaves some surface in its box.
/// Chosen.
const EMPTY_FRACTION_MIN: f64 = 0.92;

/// Fraction of samples with a depth behind or inside the box that the empty test
/// requires. Chosen.
const OBSERVED_FRACTION_MIN: f64 = 0.25;

/// Fraction of samples behind a nearer surface above which a box is occluded. Chosen.
const OCCLUDED_FRACTION_MIN: f64 = 0.3;

/// Depth image for occlusion tests: organised cloud, camera intrinsics, camera pose and depth
/// noise.
#[derive(Debug, Clone, Copy)]
pub struct DepthView<'a> {
    cloud: &'a [Point],
    camera: PinholeCamera,
    camera_from_world: RigidTransform,
    depth_noise: DepthNoise,
}

/// Relation of the measured depth to a box along one ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RayResult {
    /// Outside the image or behind the camera.
    Outside,
    /// No valid depth along the ray.
    NoDepth,
    /// Measured surface lies in front of the box.
    Nearer,
    /// Measured surface lies inside the box.
    Inside,
    /// Surface behind the box, so that the sample is free space.
    Farther,
}

/// Number of rays with each result.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    outside: u32,
    no_depth: u32,
    nearer: u32,
    inside: u32,
    farther: u32,
}

impl Counts {
    fn add(&mut self, seen: RayResult) {
        *match seen {
            RayResult::Outside => &mut self.outside,
            RayResult::NoDepth => &mut self.no_depth,
            RayResult::Nearer => &mut self.nearer,
            RayResult::Inside => &mut self.inside,
            RayResult::Farther => &mut self.farther,
        } += 1;
    }

    fn total(&self) -> f64 {
        f64::from(self.outside + self.no_depth + self.nearer + self.inside + self.farther)
    }
}

impl<'a> DepthView<'a> {
    /// Depth image; `None` when the cloud does not have one point per pixel of the
    /// camera.
    ///
    /// *Frame*: points in the camera frame.
    pub fn new(
        cloud: &'a [Point],
        camera: PinholeCamera,
        world_from_camera: &RigidTransform,
        depth_noise: DepthNoise,
    ) -> Option<Self> {
        (cloud.len() == camera.n_pixels()).then(|| Self {
            cloud,
            camera,
            camera_from_world: world_from_camera.inverse(),
            depth_noise,
        })
    }

    /// Occlusion state of an expected box that was not detected. The box is upright: its
    /// z axis points up.
    pub fn occlusion_of(&self, box_in_world: &OrientedBox) -> OcclusionState {
        let counts = self.cast_rays(
            &upper_part(box_in_world),
            |depth_m, [entry_m, exit_m], tolerance_m| {
                if depth_m < entry_m - tolerance_m {
                    RayResult::Nearer
                } else if depth_m > exit_m + tolerance_m {
                    RayResult::Farther
                } else {
                    RayResult::Inside
                }
            },
        );
        let share = |n: u32| f64::from(n) / counts.total();
        let n_seen = counts.inside + counts.farther;
        if share(counts.outside) > OUT_OF_VIEW_FRACTION {
            OcclusionState::OutOfView
        } else if share(n_seen) >= OBSERVED_FRACTION_MIN
            && f64::from(counts.farther) >= EMPTY_FRACTION_MIN * f64::from(n_seen)
        {
            OcclusionState::Empty
        } else if share(counts.nearer) >= OCCLUDED_FRACTION_MIN {
            OcclusionState::Occluded
        } else {
            OcclusionState::Unknown
        }
    }

    /// Occluded fraction of a box, 0 to 1: samples in front of which a surface lies, or
    /// which are outside the image. A surface at the far side of the box, such as the
    /// table, does not occlude it.
    pub fn occluded_fraction(&self, box_in_world: &OrientedBox) -> f64 {
        let counts = self.rays_to_far_side(box_in_world);
        f64::from(counts.outside + counts.nearer) / counts.total()
    }

    /// Fraction of a box in which nothing can be seen, 0 to 1: samples as in
    /// [`occluded_fraction`](Self::occluded_fraction), and those without a valid depth. The
    /// depth image of a structured-light sensor has a border without depth.
    pub fn unseen_fraction(&self, box_in_world: &OrientedBox) -> f64 {
        let counts = self.rays_to_far_side(box_in_world);
        f64::from(counts.outside + counts.nearer + counts.no_depth) / counts.total()
    }

    /// Casts rays through sample points of a box and compares the depth with its far side.
    fn rays_to_far_side(&self, box_in_world: &OrientedBox) -> Counts {
        self.cast_rays(box_in_world, |depth_m, [_, exit_m], tolerance_m| {
            if depth_m < exit_m - tolerance_m {
                RayResult::Nearer
            } else {
                RayResult::Farther
            }
        })
    }

    /// Casts rays through sample points of a box. `classify` receives the measured
    /// depth, the depths at which the ray enters and leaves the box, and the depth
    /// tolerance, metres.
    fn cast_rays(
        &self,
        box_in_world: &OrientedBox,
        classify: impl Fn(f64, [f64; 2], f64) -> RayResult,
    ) -> Counts {
        let camera_from_box = self.camera_from_world * box_in_world.frame_from_box;
        let rays = BoxRays::new(&camera_from_box, &box_in_world.half_sides_m);
        let tolerance_m = (DEPTH_TOLERANCE_SIGMAS
            * self
                .depth_noise
                .bounded_sigma_m(camera_from_box.translation.z))
        .max(DEPTH_TOLERANCE_MIN_M);
        let half = box_in_world.half_sides_m;
        let mut counts = Counts::default();
        for z in SAMPLE_OFFSETS {
            for y in SAMPLE_OFFSETS {
                for x in SAMPLE_OFFSETS {
                    let place = camera_from_box * Point3::new(x * half.x, y * half.y, z * half.z);
                    counts.add(match self.depth_at(&place) {
                        Err(seen) => seen,
                        Ok((depth_m, ray)) => {
                            let range_m = rays.depths_m(&ray).unwrap_or([place.z; 2]);
                            classify(depth_m, range_m, tolerance_m)
                        }
                    });
                }
            }
        }
        counts
    }

    /// Measured depth in the direction of a point and the ray of its pixel.
    fn depth_at(&self, place_in_camera: &Point3<f64>) -> Result<(f64, Vector3<f64>), RayResult> {
        let pixel = self.camera.pixel_of(place_in_camera);
        let [column, row] = pixel.ok_or(RayResult::Outside)?;
        let index = row * self.camera.width as usize + column;
        let depth_m = f64::from(self.cloud[index].z);
        if depth_m.is_finite() && depth_m > 0.0 {
            Ok((depth_m, self.camera.ray(column as f64, row as f64)))
        } else {
            Err(RayResult::NoDepth)
        }
    }
}

/// Upper central part of an upright box.
fn upper_part(whole: &OrientedBox) -> OrientedBox {
    let half = whole.half_sides_m;
    let up = Translation3::new(0.0, 0.0, (1.0 - UPPER_RATIO) * half.z);
    OrientedBox {
        frame_from_box: whole.frame_from_box * up,
        half_sides_m: half.component_mul(&Vector3::new(SIDE_RATIO, SIDE_RATIO, UPPER_RATIO)),
    }
}

/// Box prepared for ray intersection, in the camera frame.
struct BoxRays {
    box_from_camera: RigidTransform,
    half_sides_m: Vector3<f64>,
}

impl BoxRays {
    fn new(camera_from_box: &RigidTransform, half_sides_m: &Vector3<f64>) -> Self {
        Self {
            box_from_camera: camera_from_box.inverse(),
            half_sides_m: *half_sides_m,
        }
    }

    /// Entry and exit depth of a ray (z = 1); `None` when it misses (slab method, Kay
    /// and Kajiya 1986).
    fn depths_m(&self, ray: &Vector3<f64>) -> Option<[f64; 2]> {
        let origin = self.box_from_camera.translation.vector;
        let direction = self.box_from_camera.rotation * ray;
        let (mut entry, mut exit) = (0.0_f64, f64::INFINITY);
        for i in 0..3 {
            if direction[i].abs() < 1e-9 {
                if origin[i].abs() > self.half_sides_m[i] {
                    return None;
                }
                continue;
            }
            let a = (-self.half_sides_m[i] - origin[i]) / direction[i];
            let b = (self.half_sides_m[i] - origin[i]) / direction[i];
            (entry, exit) = (entry.max(a.min(b)), exit.min(a.max(b)));
        }
        (entry <= exit).then_some([entry, exit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// Camera facing walls along z, with the depth given per column.
    fn wall(depth_of: impl Fn(u32) -> f32) -> (Vec<Point>, PinholeCamera) {
        let camera = PinholeCamera::KINECT_V1;
        let point = |column: u32| Point {
            z: depth_of(column),
            ..Point::default()
        };
        let row: Vec<Point> = (0..camera.width).map(point).collect();
        let rows = std::iter::repeat_n(row, camera.height as usize);
        (rows.flatten().collect(), camera)
    }

    /// Box of 16 cm at a depth, upright for a camera whose y points down.
    fn box_at(x: f64, z: f64) -> OrientedBox {
        let upright =
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        OrientedBox {
            frame_from_box: RigidTransform::from_parts(Vector3::new(x, 0.0, z).into(), upright),
            half_sides_m: Vector3::repeat(0.08),
        }
    }

    /// Depth image of a cloud with this law of the depth noise.
    fn view_with(cloud: &[Point], camera: PinholeCamera, depth_noise: DepthNoise) -> DepthView<'_> {
        DepthView::new(cloud, camera, &RigidTransform::identity(), depth_noise).unwrap()
    }

    fn occlusion(depth_of: impl Fn(u32) -> f32, shape: &OrientedBox) -> OcclusionState {
        let (cloud, camera) = wall(depth_of);
        view_with(&cloud, camera, DepthNoise::KINECT_V1).occlusion_of(shape)
    }

    #[test]
    fn occlusion_state_follows_from_the_depths_along_the_rays() {
        let shape = box_at(0.0, 1.0);
        assert_eq!(occlusion(|_| 1.5, &shape), OcclusionState::Empty);
        assert_eq!(occlusion(|_| 0.6, &shape), OcclusionState::Occluded);
        assert_eq!(
            occlusion(|_| 0.93, &shape),
            OcclusionState::Unknown,
            "the object's own front is visible"
        );
        assert_eq!(occlusion(|_| f32::NAN, &shape), OcclusionState::Unknown);
        assert_eq!(
            occlusion(|_| 1.5, &box_at(2.0, 1.0)),
            OcclusionState::OutOfView
        );
        assert_eq!(
            occlusion(|_| 1.5, &box_at(0.0, -1.0)),
            OcclusionState::OutOfView
        );
    }

    #[test]
    fn free_space_begins_beyond_the_depth_noise() {
        // The tested part of the box ends at 2.072 m; four sigmas at 2 m are 12, 24 and 43 mm.
        let shape = box_at(0.0, 2.0);
        let is_empty = |behind_m: f32, depth_noise| {
            let (cloud, camera) = wall(|_| 2.072 + behind_m);
            let state = view_with(&cloud, camera, depth_noise).occlusion_of(&shape);
            state == OcclusionState::Empty
        };
        for (depth_noise, tolerance_m) in [
            (DepthNoise::TIME_OF_FLIGHT, 0.012),
            (DepthNoise::KINECT_V1, 0.024),
            (DepthNoise::STEREO, 0.043),
            (DepthNoise::KINECT_V1.scaled(3.0), 0.073),
        ] {
            assert!(
                !is_empty(tolerance_m - 0.004, depth_noise),
                "{depth_noise:?}"
            );
            assert!(
                is_empty(tolerance_m + 0.004, depth_noise),
                "{depth_noise:?}"
            );
        }
    }

    #[test]
    fn a_half_occluded_box_with_free_space_is_empty() {
        let shape = box_at(0.0, 1.0);
        assert_eq!(
            occlusion(|column| if column < 320 { 0.6 } else { 1.5 }, &shape),
            OcclusionState::Empty
        );
        assert_eq!(
            occlusion(|column| if column < 320 { 0.6 } else { 1.0 }, &shape),
            OcclusionState::Occluded
        );
        assert_eq!(
            occlusion(|column| if column < 320 { 1.0 } else { 1.5 }, &shape),
            OcclusionState::Unknown
        );
    }

    #[test]
    fn a_box_is_occluded_by_nearer_and_inner_surfaces_only() {
        let slab = box_at(0.0, 1.0);
        for (depth_m, is_obstructed) in [(0.7, true), (1.0, true), (1.09, false), (1.4, false)] {
            let (cloud, camera) = wall(|_| depth_m);
            let view = view_with(&cloud, camera, DepthNoise::KINECT_V1);
            assert_eq!(
                view.occluded_fraction(&slab) > 0.5,
                is_obstructed,
                "{depth_m}"
            );
        }
    }

    #[test]
    fn a_box_without_depth_is_unseen_but_not_occluded() {
        let (cloud, camera) = wall(|column| if column < 320 { f32::NAN } else { 1.4 });
        let view = view_with(&cloud, camera, DepthNoise::KINECT_V1);
        for (x, unseen) in [(-0.2, 1.0), (0.2, 0.0)] {
            assert_eq!(view.unseen_fraction(&box_at(x, 1.0)), unseen);
            assert_eq!(view.occluded_fraction(&box_at(x, 1.0)), 0.0);
        }
    }

    #[test]
    fn an_unorganised_cloud_gives_no_depth_view() {
        let camera = PinholeCamera::KINECT_V1;
        let pose = RigidTransform::identity();
        let points = [Point::default()];
        assert!(DepthView::new(&points, camera, &pose, DepthNoise::KINECT_V1).is_none());
    }
}
