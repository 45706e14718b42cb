//! Virtual viewpoint: a cluster of an unorganised cloud is rendered into a depth image, so
//! that the image path can split it.

use super::label_groups::UNLABELLED;
use super::point_labels::PointLabels;
use crate::affine_form::AffineForm;
use crate::execution::Execution;
use crate::input::{DetectionInput, ScenePriors};
use crate::organized::{OrganizedBuffers, detect_organized};
use crate::output::Detection;
use crate::table::Table;
use crate::{Config, RawConfig};
use geometry::{OrientedBox, PinholeCamera, RigidTransform};
use nalgebra::{Matrix3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use point_cloud::{OrganizedCloud, Point, Rgba};
use std::f64::consts::TAU;

/// Virtual camera; its pixels match the thresholds of the image path.
const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;

/// Least distance of the virtual camera, metres. A nearer view would imply a finer depth
/// resolution than the original sensor had. Chosen.
const DISTANCE_MIN_M: f64 = 1.0;

/// Radius of the cluster in the image, pixels. Chosen.
const RADIUS_PX: f64 = 200.0;

/// Greatest radius of a cluster on a table, metres. Chosen.
const RADIUS_MAX_M: f64 = 1.0;

/// Number of azimuths of candidate viewpoints; the one with the largest visible area is
/// used.
const N_AZIMUTHS: usize = 12;

/// Elevations of candidate viewpoints over the table, radians. Chosen.
const ELEVATIONS_RAD: [f64; 2] = [0.65, 0.95];

/// Side of the coarse pixels in which visible area is counted, pixels.
const COARSE_PX: usize = 4;

/// Target number of points counted per candidate viewpoint.
const N_COUNTED: usize = 20_000;

/// Splat radius of a point, pixels.
const SPLAT_PX: isize = 1;

/// Least distance behind the splatted surface of an occluded point, metres. Chosen.
const BEHIND_M: f32 = 0.012;

/// Width and height of the image, pixels.
const SIZE: [usize; 2] = [CAMERA.width as usize, CAMERA.height as usize];

/// Virtual view with the parts found last, and buffers.
#[derive(Debug, Default)]
pub(super) struct VirtualView {
    seen: Vec<bool>,
    pixel_of: Vec<u32>,
    depth_of: Vec<f32>,
    splats: Vec<SplatPixel>,
    image: Vec<Point>,
    detection: Detection,
    labels: PointLabels,
}

/// Z-buffer pixel of the splatting.
#[derive(Debug, Clone, Copy)]
struct SplatPixel {
    /// Nearest depth of any point splatted onto the pixel, metres.
    depth_m: f32,
    color: Rgba,
    /// Nearest depth of a point in the pixel itself, metres.
    own_m: f32,
}

const EMPTY_PIXEL: SplatPixel = SplatPixel {
    depth_m: f32::INFINITY,
    color: Rgba(0xff80_8080),
    own_m: f32::INFINITY,
};

/// Cluster of an unorganised cloud above a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct CloudCluster<'a> {
    /// All points of the cloud.
    pub(super) points: &'a [Point],
    pub(super) members: &'a [u32],
    /// Bounding box of the members, in the frame of the cloud.
    pub(super) bounds: &'a OrientedBox,
    pub(super) table: &'a Table,
}

impl VirtualView {
    /// Find the parts of a cluster in its depth image, standing alone on the table. Returns
    /// their number.
    pub(super) fn find_parts(
        &mut self,
        cluster: &CloudCluster<'_>,
        config: &RawConfig,
        organized: &mut OrganizedBuffers,
    ) -> usize {
        let CloudCluster {
            points,
            members,
            bounds,
            table,
        } = *cluster;
        let radius_m = bounds.half_sides_m.norm();
        let settings = RawConfig {
            range_min_m: 0.1,
            range_max_m: 10.0,
            // The gaps of a resampled image are none of the camera's.
            joins_parts: false,
            ..config.clone()
        };
        let (true, Ok(config)) = (radius_m <= RADIUS_MAX_M, Config::new(settings)) else {
            return 0;
        };
        let camera_from_table = self.widest_view(cluster, radius_m);
        let camera_from_cloud = camera_from_table * table.table_from_camera;
        self.splat(points, members, &camera_from_cloud);
        // Occluders of the base are not rendered, so the ground is raised to the lowest
        // point and nothing floats.
        let ground_m = lowest_height_m(points, members, table) - config.get().height_min_m;
        self.compose_depth_image(&camera_from_table, ground_m.max(0.0));
        let Ok(cloud) = OrganizedCloud::new(&self.image, SIZE[0], SIZE[1]) else {
            return 0;
        };
        let up_in_camera = Some(camera_from_table.rotation * Vector3::z_axis());
        let frame = DetectionInput {
            cloud,
            up_in_camera,
            priors: ScenePriors::default(),
        };
        organized.recycle(&mut self.detection);
        let detection = &mut self.detection;
        detect_organized(&frame, &config, organized, detection, Execution::default());
        let Self {
            pixel_of,
            depth_of,
            splats,
            detection,
            labels,
            ..
        } = self;
        let surface = |i: usize| {
            let pixel = pixel_of[i] as usize;
            let splats = splats.get(pixel)?;
            (depth_of[i] <= splats.depth_m + BEHIND_M).then_some(pixel)
        };
        labels.refill(detection, self.image.len(), members.len(), surface);
        detection.candidates.len()
    }

    /// Per member: the part it is visible in, or [`UNLABELLED`].
    pub(super) fn part_of(&self) -> &[u32] {
        self.labels.of_point()
    }

    /// Viewpoint with the largest visible area, as `camera_from_table`; sides that were
    /// never measured are transparent and show little.
    fn widest_view(&mut self, cluster: &CloudCluster<'_>, radius_m: f64) -> RigidTransform {
        let CloudCluster {
            points,
            members,
            bounds,
            table,
        } = *cluster;
        let target = table.table_from_camera * bounds.centre();
        let distance_m = (radius_m * CAMERA.fx_px / RADIUS_PX).max(DISTANCE_MIN_M);
        let step = members.len().div_ceil(N_COUNTED).max(1);
        let mut best = (RigidTransform::identity(), 0);
        for i in 0..N_AZIMUTHS * ELEVATIONS_RAD.len() {
            let azimuth_rad = TAU * i as f64 / N_AZIMUTHS as f64;
            let elevation_rad = ELEVATIONS_RAD[i / N_AZIMUTHS];
            let camera_from_table = look_at(&target, azimuth_rad, elevation_rad, distance_m);
            let camera_from_cloud = camera_from_table * table.table_from_camera;
            let coarse = SIZE.map(|side| side / COARSE_PX);
            self.seen.clear();
            self.seen.resize(coarse[0] * coarse[1], false);
            for &member in members.iter().step_by(step) {
                if let Some(([column, row], _)) =
                    project(&points[member as usize], &camera_from_cloud)
                {
                    self.seen[row / COARSE_PX * coarse[0] + column / COARSE_PX] = true;
                }
            }
            let n_seen = self.seen.iter().filter(|&&seen| seen).count();
            if n_seen > best.1 || i == 0 {
                best = (camera_from_table, n_seen);
            }
        }
        best.0
    }

    /// Splat the points into the z-buffer.
    fn splat(&mut self, points: &[Point], members: &[u32], camera_from_cloud: &RigidTransform) {
        self.splats.clear();
        self.splats.resize(SIZE[0] * SIZE[1], EMPTY_PIXEL);
        self.pixel_of.clear();
        self.depth_of.clear();
        for &member in members {
            let point = &points[member as usize];
            let Some(([column, row], depth_m)) = project(point, camera_from_cloud) else {
                self.pixel_of.push(UNLABELLED);
                self.depth_of.push(f32::INFINITY);
                continue;
            };
            let pixel = row * SIZE[0] + column;
            self.pixel_of.push(pixel as u32);
            self.depth_of.push(depth_m);
            let own = &mut self.splats[pixel].own_m;
            *own = own.min(depth_m);
            let reach = |at: usize, side: usize| {
                let splat = SPLAT_PX as usize;
                at.saturating_sub(splat)..(at + splat + 1).min(side)
            };
            for near in reach(row, SIZE[1]) {
                for splats in
                    &mut self.splats[near * SIZE[0]..(near + 1) * SIZE[0]][reach(column, SIZE[0])]
                {
                    if depth_m < splats.depth_m {
                        (splats.depth_m, splats.color) = (depth_m, point.color);
                    }
                }
            }
        }
    }

    /// Compose the depth image from the splats, with a ground plane at a height, metres, in
    /// empty pixels.
    fn compose_depth_image(&mut self, camera_from_table: &RigidTransform, ground_m: f64) {
        let up = camera_from_table.rotation * Vector3::z();
        let height_m = camera_from_table.translation.vector.dot(&up) + ground_m;
        self.image.clear();
        for (pixel, splats) in self.splats.iter().enumerate() {
            let ray = CAMERA.ray((pixel % SIZE[0]) as f64, (pixel / SIZE[0]) as f64);
            let depth_m = if splats.own_m <= splats.depth_m + BEHIND_M {
                f64::from(splats.own_m)
            } else {
                f64::from(splats.depth_m)
            };
            let depth_m = if depth_m.is_finite() {
                depth_m
            } else {
                height_m / ray.dot(&up)
            };
            self.image.push(Point {
                x: (ray.x * depth_m) as f32,
                y: (ray.y * depth_m) as f32,
                z: depth_m as f32,
                color: splats.color,
            });
        }
    }
}

/// Least height of points over the table, metres.
fn lowest_height_m(points: &[Point], members: &[u32], table: &Table) -> f64 {
    let height = AffineForm::from(&table.plane);
    let heights = members.iter().map(|&member| {
        let point = &points[member as usize];
        height.at(point.x, point.y, point.z)
    });
    f64::from(heights.fold(f32::INFINITY, f32::min))
}

/// Look-at transform `camera_from_table` at a distance from a target.
fn look_at(
    target: &Point3<f64>,
    azimuth_rad: f64,
    elevation_rad: f64,
    distance_m: f64,
) -> RigidTransform {
    let (sin, cos) = azimuth_rad.sin_cos();
    let (height, reach) = elevation_rad.sin_cos();
    let back = Vector3::new(reach * cos, reach * sin, height);
    let right = Unit::new_normalize((-back).cross(&Vector3::z())).into_inner();
    let down = (-back).cross(&right);
    let rows = Matrix3::from_rows(&[right.transpose(), down.transpose(), -back.transpose()]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows));
    let eye = target + back * distance_m;
    RigidTransform::from_parts((-(rotation * eye.coords)).into(), rotation)
}

/// Projection of a point: column, row and depth.
#[inline]
fn project(point: &Point, camera_from_cloud: &RigidTransform) -> Option<([usize; 2], f32)> {
    let seen = camera_from_cloud * point.position();
    Some((CAMERA.pixel_of(&seen)?, seen.z as f32))
}
