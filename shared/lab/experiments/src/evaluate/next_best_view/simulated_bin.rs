//! Simulated bin: objects thrown into a bin until they rest, and cameras around it.

use super::bin_scene::{BinObject, BinScene, BinWalls, SURROUNDINGS_SPACING_M};
use next_best_view::SurfaceModel;
use service::Failure;
use simulated_world::{CameraMount, ModelLibrary, ObjectState, Scene, SceneKind, World};
use std::rc::Rc;
use view_planning::PlanningSpace;

/// Number of objects of a scene (Kasaei et al. 2018).
pub(super) const N_OBJECTS: usize = 20;
/// Distance of the cameras from the middle of the bin, metres. Chosen: the bin fills the image of
/// a Kinect.
const CAMERA_DISTANCE_M: f64 = 0.9;
/// Height of the point that the cameras look at, above the table, metres. Chosen.
const LOOK_AT_M: f64 = 0.07;
/// Thickness of the walls of the bin, metres, as in the simulation.
const WALL_M: f64 = 0.008;
/// Margin around the bin within which an object counts as in it, metres. Chosen.
const MARGIN_M: f64 = 0.05;
/// Golden angle of the Fibonacci lattice, degrees.
const GOLDEN_ANGLE_DEG: f64 = 137.507_764;

/// Camera places around the bin.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewLattice {
    pub(super) n_views: u32,
    /// Least elevation of a camera, degrees; 0 for the upper hemisphere.
    pub(super) elevation_min_deg: f64,
}

/// Bin in the simulation with its scene.
#[derive(Debug)]
pub(super) struct SimulatedBin {
    pub(super) world: World,
    pub(super) mounts: Vec<CameraMount>,
    pub(super) scene: BinScene,
}

impl SimulatedBin {
    /// Throws different objects into the bin and waits until they rest; cameras are on the upper
    /// hemisphere.
    pub(super) fn new(seed: u64, n_views: u32, library: &ModelLibrary) -> Result<Self, Failure> {
        let mut library = library.clone();
        let scene = Scene::generate(SceneKind::Bin, N_OBJECTS, seed, &mut library);
        let views = ViewLattice {
            n_views,
            elevation_min_deg: 0.0,
        };
        Self::of_scene(scene.map_err(Failure::general)?, views, library)
    }

    /// Throws the same objects into the bin anew.
    pub(super) fn thrown_anew(
        &self,
        seed: u64,
        views: ViewLattice,
        library: &ModelLibrary,
    ) -> Result<Self, Failure> {
        let (mut library, own) = (library.clone(), self.world.scene());
        let scene = Scene::generate(SceneKind::Bin, own.objects.len(), seed, &mut library);
        let mut scene = scene.map_err(Failure::general)?;
        for (object, own) in scene.objects.iter_mut().zip(&own.objects) {
            object.model = own.model.clone();
        }
        Self::of_scene(scene, views, library)
    }

    /// Lets the objects of a scene come to rest. Objects that ended up beside the bin are left out.
    pub(super) fn of_scene(
        scene: Scene,
        views: ViewLattice,
        library: ModelLibrary,
    ) -> Result<Self, Failure> {
        let world = World::new(scene, library).map_err(Failure::general)?;
        let bin = world.scene().bin.unwrap_or_default();
        let walls = BinWalls {
            bin,
            table_m: world.scene().table.height_m,
        };
        let mut objects = Vec::new();
        for object in world.objects() {
            let pose = object.world_from_object;
            let is_in = |axis: usize| {
                pose.translation.vector[axis].abs() < bin.inner_size_m[axis] / 2.0 + MARGIN_M
            };
            if object.state != ObjectState::OnFloor && is_in(0) && is_in(1) {
                let mesh = Rc::new(object.model.mesh.clone());
                objects.push(BinObject::new((object.id, &object.model.name), mesh, pose)?);
            }
        }
        let mounts = mounts(views, world.scene().table.height_m);
        let poses = mounts.iter().map(|mount| mount.world_from_camera(0.0));
        let mut scene = BinScene::new(objects, Some(walls), poses.collect());
        scene.surroundings = furniture(&scene.space, walls)?;
        Ok(Self {
            world,
            mounts,
            scene,
        })
    }
}

/// Surface of the table in the space around the objects, and of the bin.
pub(super) fn furniture(space: &PlanningSpace, walls: BinWalls) -> Result<Vec<[f32; 3]>, Failure> {
    let ([least, greatest], table_m) = (space.corners(), walls.table_m);
    let table = [
        [least.x, least.y, table_m - WALL_M],
        [greatest.x, greatest.y, table_m],
    ];
    let mut points = Vec::new();
    for [low, high] in std::iter::once(table).chain(wall_boxes(walls)) {
        let sides: [f64; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
        let mesh = mesh::rounded_box(sides.map(|side| side as f32), 0.0005, 1.0).mesh;
        let model =
            SurfaceModel::of_mesh(&mesh, SURROUNDINGS_SPACING_M).map_err(Failure::general)?;
        let middle: [f64; 3] = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        points.extend(model.points().iter().map(|point| {
            let place: [f32; 3] = std::array::from_fn(|axis| point[axis] + middle[axis] as f32);
            place
        }));
    }
    Ok(points)
}

/// Walls of the bin: least and greatest corners, world frame, metres.
fn wall_boxes(walls: BinWalls) -> [[[f64; 3]; 2]; 4] {
    let [x, y, height_m] = walls.bin.inner_size_m;
    let (x, y) = (x / 2.0, y / 2.0);
    let (low, high) = (walls.table_m, walls.table_m + height_m);
    [
        [[-x - WALL_M, -y - WALL_M, low], [-x, y + WALL_M, high]],
        [[x, -y - WALL_M, low], [x + WALL_M, y + WALL_M, high]],
        [[-x, -y - WALL_M, low], [x, -y, high]],
        [[-x, y, low], [x, y + WALL_M, high]],
    ]
}

/// Cameras on a Fibonacci lattice over the sphere around the middle of the bin, evenly from the
/// least elevation to the zenith.
fn mounts(views: ViewLattice, table_m: f64) -> Vec<CameraMount> {
    let least = views.elevation_min_deg.to_radians().sin();
    let share = |i: u32| (f64::from(i) + 0.5) / f64::from(views.n_views);
    let mount = |i: u32| CameraMount {
        look_at_m: [0.0, 0.0, table_m + LOOK_AT_M],
        distance_m: CAMERA_DISTANCE_M,
        elevation_deg: (least + (1.0 - least) * share(i)).asin().to_degrees(),
        azimuth_deg: (f64::from(i) * GOLDEN_ANGLE_DEG).rem_euclid(360.0),
        orbit_deg_s: 0.0,
    };
    (0..views.n_views).map(mount).collect()
}
