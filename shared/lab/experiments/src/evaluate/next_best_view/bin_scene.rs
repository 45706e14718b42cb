//! Scene of the next best view: objects thrown into a bin, and cameras over the upper hemisphere.

use geometry::RigidTransform;
use nalgebra::Point3;
use next_best_view::SurfaceModel;
use service::Failure;
use simulated_world::{Bin, CameraMount, ModelLibrary, ObjectState, Scene, SceneKind, World};

/// Number of objects of a scene (Kasaei et al. 2018).
pub(super) const N_OBJECTS: usize = 20;
/// Distance of the cameras from the middle of the bin, metres. Chosen: the bin fills the image of
/// a Kinect.
const CAMERA_DISTANCE_M: f64 = 0.9;
/// Height of the point that the cameras look at, above the table, metres. Chosen.
const LOOK_AT_M: f64 = 0.07;
/// Margin of the workspace around the bin, metres. Chosen.
const MARGIN_M: f64 = 0.05;
/// Height of the workspace above the table, metres. Chosen: above every heap.
const HEIGHT_M: f64 = 0.40;
/// Depth of the workspace below the table top, metres: for the noise of its measured points.
const DEPTH_M: f64 = 0.02;
/// Distance from the middle of a wall within which a point belongs to the bin, metres. Chosen:
/// the wall's thickness and the noise of the depth.
const WALL_BAND_M: f64 = 0.015;
/// Thickness of the bin's walls, metres, as in the simulation.
const WALL_M: f64 = 0.008;
/// Spacing of the surface models, metres: the cells of a virtual view.
pub(super) const SPACING_M: f64 = 0.003;
/// Spacing of the furniture's points, metres. Chosen: closed by the splats of 3 mm.
const FURNITURE_SPACING_M: f64 = 0.005;
/// Spacing of the coarse models, metres. Chosen.
const COARSE_SPACING_M: f64 = 0.006;
/// Golden angle of the Fibonacci lattice, degrees.
const GOLDEN_ANGLE_DEG: f64 = 137.507_764;

/// Box of space in which the objects lie. Only what is in it counts as visible area.
#[derive(Debug, Clone, Copy)]
pub(super) struct Workspace {
    pub(super) least: Point3<f64>,
    pub(super) greatest: Point3<f64>,
    bin: Bin,
}

impl Workspace {
    /// `true` for a place in the workspace.
    pub(super) fn contains(&self, in_world: &Point3<f64>) -> bool {
        (0..3).all(|axis| (self.least[axis]..self.greatest[axis]).contains(&in_world[axis]))
    }

    /// `true` for a place at a wall of the bin, of which a robot knows where it is.
    pub(super) fn is_at_wall(&self, in_world: &Point3<f64>) -> bool {
        let [x, y, z] = self.bin.inner_size_m;
        let at = |value: f64, side: f64| (value.abs() - side / 2.0).abs() < WALL_BAND_M;
        let is_below_rim = in_world.z < self.least.z + DEPTH_M + z + WALL_BAND_M;
        is_below_rim && (at(in_world.x, x) || at(in_world.y, y))
    }
}

/// Object at rest in the bin.
#[derive(Debug)]
pub(super) struct BinObject {
    /// Number in the masks of the simulation.
    pub(super) id: u16,
    pub(super) model: SurfaceModel,
    /// The same surface with few points, for coarse searches.
    pub(super) coarse: SurfaceModel,
    pub(super) world_from_object: RigidTransform,
}

/// Scene at rest with its objects and candidate cameras.
#[derive(Debug)]
pub(super) struct BinScene {
    pub(super) world: World,
    pub(super) objects: Vec<BinObject>,
    pub(super) workspace: Workspace,
    /// Points of the table and of the bin's walls in the workspace, world frame, metres.
    pub(super) furniture: Vec<[f32; 3]>,
    pub(super) mounts: Vec<CameraMount>,
    /// Pose of each camera, `world_from_camera`.
    pub(super) cameras: Vec<RigidTransform>,
}

impl BinScene {
    /// Throws objects into the bin and waits until they rest. Objects that ended up outside of the
    /// workspace are left out.
    pub(super) fn new(seed: u64, n_views: u32, library: &ModelLibrary) -> Result<Self, Failure> {
        let mut library = library.clone();
        let scene = Scene::generate(SceneKind::Bin, N_OBJECTS, seed, &mut library);
        let world = World::new(scene.map_err(Failure::general)?, library);
        let world = world.map_err(Failure::general)?;
        let workspace = workspace(world.scene());
        let mut objects = Vec::new();
        for object in world.objects() {
            let place = object.world_from_object.translation.vector.into();
            if object.state == ObjectState::OnFloor || !workspace.contains(&place) {
                continue;
            }
            let model = |spacing_m| {
                SurfaceModel::of_mesh(&object.model.mesh, spacing_m).map_err(Failure::general)
            };
            objects.push(BinObject {
                id: object.id,
                model: model(SPACING_M)?,
                coarse: model(COARSE_SPACING_M)?,
                world_from_object: object.world_from_object,
            });
        }
        let mounts = mounts(n_views, world.scene().table.height_m);
        let cameras = mounts
            .iter()
            .map(|mount| mount.world_from_camera(0.0))
            .collect();
        Ok(Self {
            world,
            objects,
            furniture: furniture(&workspace)?,
            workspace,
            mounts,
            cameras,
        })
    }
}

fn workspace(scene: &Scene) -> Workspace {
    let bin = scene.bin.unwrap_or_default();
    let [x, y] = [0, 1].map(|axis| bin.inner_size_m[axis] / 2.0 + MARGIN_M);
    let table_m = scene.table.height_m;
    Workspace {
        least: Point3::new(-x, -y, table_m - DEPTH_M),
        greatest: Point3::new(x, y, table_m + HEIGHT_M),
        bin,
    }
}

/// Surface of the furniture, of which a robot knows where it is: the table in the workspace, and
/// the bin.
fn furniture(workspace: &Workspace) -> Result<Vec<[f32; 3]>, Failure> {
    let (least, greatest) = (workspace.least, workspace.greatest);
    let table_m = least.z + DEPTH_M;
    let table = [
        [least.x, least.y, table_m - WALL_M],
        [greatest.x, greatest.y, table_m],
    ];
    let mut points = Vec::new();
    for [low, high] in std::iter::once(table).chain(walls(workspace)) {
        let sides: [f64; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
        let mesh = mesh::rounded_box(sides.map(|side| side as f32), 0.0005, 1.0).mesh;
        let model = SurfaceModel::of_mesh(&mesh, FURNITURE_SPACING_M).map_err(Failure::general)?;
        let middle: [f64; 3] = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        points.extend(model.points().iter().map(|point| {
            let place: [f32; 3] = std::array::from_fn(|axis| point[axis] + middle[axis] as f32);
            place
        }));
    }
    Ok(points)
}

/// Walls of the bin: least and greatest corners, world frame, metres.
fn walls(workspace: &Workspace) -> [[[f64; 3]; 2]; 4] {
    let [x, y, height_m] = workspace.bin.inner_size_m;
    let (x, y) = (x / 2.0, y / 2.0);
    let low = workspace.least.z + DEPTH_M;
    let high = low + height_m;
    [
        [[-x - WALL_M, -y - WALL_M, low], [-x, y + WALL_M, high]],
        [[x, -y - WALL_M, low], [x + WALL_M, y + WALL_M, high]],
        [[-x, -y - WALL_M, low], [x, -y, high]],
        [[-x, y, low], [x, y + WALL_M, high]],
    ]
}

/// Cameras on a Fibonacci lattice over the upper hemisphere around the middle of the bin.
fn mounts(n_views: u32, table_m: f64) -> Vec<CameraMount> {
    let mount = |i: u32| CameraMount {
        look_at_m: [0.0, 0.0, table_m + LOOK_AT_M],
        distance_m: CAMERA_DISTANCE_M,
        elevation_deg: ((f64::from(i) + 0.5) / f64::from(n_views))
            .asin()
            .to_degrees(),
        azimuth_deg: (f64::from(i) * GOLDEN_ANGLE_DEG).rem_euclid(360.0),
        orbit_deg_s: 0.0,
    };
    (0..n_views).map(mount).collect()
}
