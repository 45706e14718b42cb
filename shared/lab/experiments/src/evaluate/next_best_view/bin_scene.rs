//! Scene of the next best view: objects in a bin with their models and poses, and candidate
//! cameras.

use geometry::RigidTransform;
use mesh::TriangleMesh;
use nalgebra::Point3;
use next_best_view::SurfaceModel;
use scene_client::{HypothesisSource, ObjectHypothesis};
use service::Failure;
use simulated_world::Bin;
use std::rc::Rc;
use view_planning::PlanningSpace;

/// Distance from the middle of a wall within which a point belongs to the bin, metres. Chosen:
/// the wall's thickness and the noise of the depth.
const WALL_BAND_M: f64 = 0.015;
/// Spacing of the points of the surroundings, metres. Chosen: closed by the splats of 3 mm.
pub(super) const SURROUNDINGS_SPACING_M: f64 = 0.005;
/// Spacing of the surface models, metres: the cells of a virtual view.
const SPACING_M: f64 = 0.003;

/// Walls of a bin around the origin of a table, of which a robot knows where they are.
#[derive(Debug, Clone, Copy)]
pub(super) struct BinWalls {
    pub(super) bin: Bin,
    /// Height of the table top, metres.
    pub(super) table_m: f64,
}

impl BinWalls {
    /// `true` for a place at a wall.
    pub(super) fn contain(&self, in_world: &Point3<f64>) -> bool {
        let [x, y, z] = self.bin.inner_size_m;
        let at = |value: f64, side: f64| (value.abs() - side / 2.0).abs() < WALL_BAND_M;
        let is_below_rim = in_world.z < self.table_m + z + WALL_BAND_M;
        is_below_rim && (at(in_world.x, x) || at(in_world.y, y))
    }
}

/// Object at rest in the bin.
#[derive(Debug)]
pub(super) struct BinObject {
    /// Number in the masks of the images.
    pub(super) id: u16,
    /// Name of its model, which equal objects share.
    pub(super) name: String,
    pub(super) mesh: Rc<TriangleMesh>,
    pub(super) surface: Rc<SurfaceModel>,
    pub(super) world_from_object: RigidTransform,
}

impl BinObject {
    /// Object of a mesh, metres.
    pub(super) fn new(
        (id, name): (u16, &str),
        mesh: Rc<TriangleMesh>,
        world_from_object: RigidTransform,
    ) -> Result<Self, Failure> {
        let surface = SurfaceModel::of_mesh(&mesh, SPACING_M).map_err(Failure::general)?;
        Ok(Self {
            id,
            name: name.to_owned(),
            mesh,
            surface: Rc::new(surface),
            world_from_object,
        })
    }

    /// The object as a hypothesis at a pose.
    pub(super) fn hypothesis(&self, plan_from_object: RigidTransform) -> ObjectHypothesis {
        ObjectHypothesis {
            track: self.id.into(),
            label: Some(self.name.clone()),
            source: HypothesisSource::Model {
                name: self.name.clone(),
                contradiction: 0.0,
            },
            surface: self.surface.clone(),
            plan_from_object,
            note: String::new(),
        }
    }
}

/// Scene at rest with its objects and candidate cameras, simulated or recorded.
#[derive(Debug)]
pub(super) struct BinScene {
    pub(super) objects: Vec<BinObject>,
    /// Space around the objects, world frame. Only what is in it counts as visible area.
    pub(super) space: PlanningSpace,
    /// Points of what is around the objects and known beside them, such as table and bin, world
    /// frame, metres: for the bounds of the prediction, not for the program.
    pub(super) surroundings: Vec<[f32; 3]>,
    /// Walls of the bin; `None` where they are not known.
    pub(super) walls: Option<BinWalls>,
    /// Pose of each camera, `world_from_camera`.
    pub(super) cameras: Vec<RigidTransform>,
}

impl BinScene {
    /// Scene of objects seen by cameras.
    pub(super) fn new(
        objects: Vec<BinObject>,
        walls: Option<BinWalls>,
        cameras: Vec<RigidTransform>,
    ) -> Self {
        let true_poses = objects
            .iter()
            .map(|object| object.hypothesis(object.world_from_object));
        Self {
            space: PlanningSpace::around(&true_poses.collect::<Vec<_>>()),
            objects,
            surroundings: Vec::new(),
            walls,
            cameras,
        }
    }
}
