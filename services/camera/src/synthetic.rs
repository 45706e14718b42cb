//! Synthetic table: ray-cast household objects with Kinect v1 depth noise.
//!
//! The scene is cast once, pixel by pixel; a frame only adds the sensor's
//! noise, so it costs about as much as copying it. World frame: z up, origin on
//! the floor under the middle of the table. Frame `k` of an arrangement is the
//! same in every run and on every machine of one architecture.
//!
//! This module never reads a clock, never does I/O, and allocates nothing after
//! [`SyntheticTable::new`] unless a view is rendered.

mod arrangement;
mod catalogue;
mod depth_sensor;
mod paint;
mod scene;
mod surface;
#[cfg(test)]
mod tests;

pub use arrangement::TableObject;

/// Number of phases of [`SyntheticTable::parade`].
pub const N_PHASES: usize = 4;

/// Largest number of blocks of [`SyntheticTable::crowd`].
pub const CROWD_MAX: u32 = arrangement::CROWD_MAX;

use depth_sensor::{BASELINE_M, DepthSensor, N_BLIND_COLUMNS, PixelModel, PixelVisibility};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Point3, Unit, Vector3};
use point_cloud::Point;
use scene::{SyntheticScene, VisibleSurface};
use surface::Ray;

/// Height of the table's surface over the world's origin, metres.
pub const TABLE_HEIGHT_M: f64 = 0.72;
/// Half of the table's sides along world x and y, metres.
pub const TABLE_HALF_SIDES_M: [f64; 2] = [0.65, 0.4];

/// Camera viewpoint, in spherical coordinates around the table's middle.
#[derive(Debug, Clone, Copy)]
struct Viewpoint {
    /// Distance from the table's middle, metres.
    distance_m: f64,
    /// Elevation above the table, and azimuth to the right, degrees.
    elevation_deg: f64,
    azimuth_deg: f64,
}

/// Viewpoint of a person in front of the table.
const BEFORE_THE_TABLE: Viewpoint = Viewpoint {
    distance_m: 1.0,
    elevation_deg: 43.0,
    azimuth_deg: 5.0,
};

/// Viewpoint over the table, from which no block hides another.
const OVER_THE_TABLE: Viewpoint = Viewpoint {
    distance_m: 1.4,
    elevation_deg: 60.0,
    azimuth_deg: 0.0,
};
/// Depth discontinuity at an object's edge, metres. Chosen.
const EDGE_JUMP_M: f64 = 0.02;

/// Synthetic table with one arrangement of objects, and the Kinect that observes it.
#[derive(Debug)]
pub struct SyntheticTable {
    camera: PinholeCamera,
    world_from_camera: RigidTransform,
    objects: Vec<TableObject>,
    scene: SyntheticScene,
    sensor: DepthSensor,
    pixels: Vec<PixelModel>,
    arrangement: u32,
}

/// Rendered depth and colour image without noise.
#[derive(Debug, Clone)]
pub struct RenderedView {
    /// Depth along the optical axis, metres, row-major; NaN where nothing is seen.
    pub depth_m: Vec<f32>,
    /// Red, green, blue, row-major; black where nothing is seen.
    pub rgb: Vec<u8>,
}

impl SyntheticTable {
    /// Table with five objects; equal numbers give equal tables.
    ///
    /// Five objects stand apart from each other and from the rim by at least
    /// 6 cm, all fully in view. Between two arrangements whose numbers differ
    /// by less than eight, an object that occurs in both has moved and turned,
    /// and something else stands where it stood.
    pub fn new(arrangement: u32) -> Self {
        let objects = arrangement::objects(arrangement);
        Self::with_objects(arrangement, objects, PinholeCamera::KINECT_V1)
    }

    /// Table with many small blocks in rows, at least 22 mm apart, seen from above. At
    /// most [`CROWD_MAX`]; more are left out.
    pub fn crowd(n: u32) -> Self {
        Self::crowd_without(n, |_| false)
    }

    /// Phases of a crowd that comes and goes: in each phase another quarter of the blocks
    /// is away.
    pub fn parade(n: u32) -> [Self; N_PHASES] {
        std::array::from_fn(|phase| {
            Self::crowd_without(n, |place| (place as usize + phase).is_multiple_of(N_PHASES))
        })
    }

    fn crowd_without(n: u32, is_away: impl Fn(u32) -> bool) -> Self {
        let objects = arrangement::crowd(n, is_away);
        Self::seen_from(&OVER_THE_TABLE, n, objects, PinholeCamera::KINECT_V1)
    }

    fn with_objects(arrangement: u32, objects: Vec<TableObject>, camera: PinholeCamera) -> Self {
        Self::seen_from(&BEFORE_THE_TABLE, arrangement, objects, camera)
    }

    fn seen_from(
        stand: &Viewpoint,
        arrangement: u32,
        objects: Vec<TableObject>,
        camera: PinholeCamera,
    ) -> Self {
        let scene = SyntheticScene::new(&objects);
        let world_from_camera = camera_pose(stand);
        let sensor = DepthSensor::new(camera.fx_px);
        let pixels = pixel_models(&scene, &camera, &world_from_camera, sensor);
        Self {
            camera,
            world_from_camera,
            objects,
            scene,
            sensor,
            pixels,
            arrangement,
        }
    }

    /// Intrinsics of the depth camera; colour is registered to it.
    pub fn camera(&self) -> PinholeCamera {
        self.camera
    }

    /// Pose of the depth camera in the world.
    pub fn world_from_camera(&self) -> RigidTransform {
        self.world_from_camera
    }

    /// Unit vector against gravity, depth camera frame.
    pub fn up_in_camera(&self) -> Unit<Vector3<f64>> {
        self.world_from_camera.rotation.inverse() * Vector3::z_axis()
    }

    /// Objects on the table.
    pub fn objects(&self) -> &[TableObject] {
        &self.objects
    }

    /// Writes one noisy frame, row-major, camera frame. A shorter slice gets the frame's
    /// beginning, a longer one keeps its end. Allocates nothing.
    pub fn fill(&self, frame: u64, out: &mut [Point]) {
        let seed =
            random::counter_based(random::counter_based(u64::from(self.arrangement)) ^ frame);
        let width = self.camera.width as usize;
        let (step_x, step_y) = (
            1.0 / self.camera.fx_px as f32,
            1.0 / self.camera.fy_px as f32,
        );
        let (cx, cy) = (self.camera.cx_px as f32, self.camera.cy_px as f32);
        let rows = out
            .chunks_mut(width)
            .zip(self.pixels.chunks(width))
            .enumerate();
        for (row, (points, pixels)) in rows {
            let y = (row as f32 - cy) * step_y;
            let first = seed.wrapping_add((row * width) as u64);
            for (column, (point, pixel)) in points.iter_mut().zip(pixels).enumerate() {
                let slope = [(column as f32 - cx) * step_x, y];
                let bits = random::counter_based(first.wrapping_add(column as u64));
                *point = self.sensor.read(pixel, slope, bits);
            }
        }
    }

    /// Renders the scene for another camera, without noise.
    pub fn render(
        &self,
        camera: &PinholeCamera,
        world_from_camera: &RigidTransform,
    ) -> RenderedView {
        let surfaces = cast_image(&self.scene, camera, world_from_camera);
        RenderedView {
            depth_m: surfaces
                .iter()
                .map(|s| s.map_or(f32::NAN, |sight| sight.t as f32))
                .collect(),
            rgb: surfaces
                .iter()
                .flat_map(|s| s.map_or([0; 3], |sight| sight.rgb))
                .collect(),
        }
    }
}

/// Camera pose that looks at the table's middle, upright.
fn camera_pose(stand: &Viewpoint) -> RigidTransform {
    let (elevation, azimuth) = (
        stand.elevation_deg.to_radians(),
        stand.azimuth_deg.to_radians(),
    );
    let level = Vector3::new(azimuth.sin(), -azimuth.cos(), 0.0);
    let towards_camera = level * elevation.cos() + Vector3::z() * elevation.sin();
    let middle = Point3::new(0.0, 0.0, TABLE_HEIGHT_M);
    let eye = middle + towards_camera * stand.distance_m;
    RigidTransform::face_towards(&eye, &middle, &-Vector3::z())
}

/// Viewing ray of a pixel, world frame; its parameter is the depth.
fn world_ray(camera: &PinholeCamera, world_from_camera: &RigidTransform, pixel_idx: usize) -> Ray {
    let width = camera.width as usize;
    let (row, column) = (pixel_idx / width, pixel_idx % width);
    Ray {
        origin: world_from_camera.translation.vector.into(),
        direction: world_from_camera.rotation * camera.ray(column as f64, row as f64),
    }
}

fn cast_image(
    scene: &SyntheticScene,
    camera: &PinholeCamera,
    world_from_camera: &RigidTransform,
) -> Vec<Option<VisibleSurface>> {
    let cast = |pixel_idx| scene.cast(&world_ray(camera, world_from_camera, pixel_idx));
    (0..camera.n_pixels()).map(cast).collect()
}

fn pixel_models(
    scene: &SyntheticScene,
    camera: &PinholeCamera,
    world_from_camera: &RigidTransform,
    sensor: DepthSensor,
) -> Vec<PixelModel> {
    let surfaces = cast_image(scene, camera, world_from_camera);
    let width = camera.width as usize;
    let projector = world_from_camera * Point3::new(BASELINE_M, 0.0, 0.0);
    let model = |(pixel_idx, sight): (usize, &Option<VisibleSurface>)| {
        let Some(sight) = sight else {
            return PixelModel::nothing();
        };
        let ray = world_ray(camera, world_from_camera, pixel_idx);
        // Offset from the surface, against self-shadowing.
        let lit = ray.at(sight.t) + sight.normal * 5e-4;
        let is_blind = pixel_idx % width + N_BLIND_COLUMNS >= width;
        let around = PixelVisibility {
            incidence: -sight.normal.dot(&ray.direction.normalize()),
            is_behind_edge: is_behind_edge(&surfaces, width, pixel_idx),
            is_in_shadow: is_blind || scene.is_blocked(&lit, &projector),
        };
        sensor.model(sight.t, sight.rgb, around)
    };
    surfaces.iter().enumerate().map(model).collect()
}

/// True if one of the pixel's four neighbours is clearly nearer.
fn is_behind_edge(surfaces: &[Option<VisibleSurface>], width: usize, pixel_idx: usize) -> bool {
    let depth = |idx: usize| surfaces.get(idx).copied().flatten().map(|sight| sight.t);
    let column = pixel_idx % width;
    let neighbours = [
        (column > 0).then(|| pixel_idx - 1),
        (column + 1 < width).then(|| pixel_idx + 1),
        pixel_idx.checked_sub(width),
        Some(pixel_idx + width),
    ];
    let mut others = neighbours.into_iter().flatten().filter_map(depth);
    depth(pixel_idx).is_some_and(|own| others.any(|other| own - other > EDGE_JUMP_M))
}
