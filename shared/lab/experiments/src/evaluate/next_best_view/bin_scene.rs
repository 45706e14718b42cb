//! Scene of the next best view: objects in a bin with their models and poses, and candidate
//! cameras.

use geometry::RigidTransform;
use nalgebra::{Point3, Vector3, center};
use next_best_view::SurfaceModel;
use service::Failure;
use simulated_world::Bin;

/// Margin of the workspace around the bin, or around the objects, metres. Chosen.
pub(super) const MARGIN_M: f64 = 0.05;
/// Depth of the workspace below the table top, metres: for the noise of its measured points.
pub(super) const DEPTH_M: f64 = 0.02;
/// Distance from the middle of a wall within which a point belongs to the bin, metres. Chosen:
/// the wall's thickness and the noise of the depth.
const WALL_BAND_M: f64 = 0.015;
/// Spacing of the surface models, metres: the cells of a virtual view.
pub(super) const SPACING_M: f64 = 0.003;
/// Spacing of the furniture's points, metres. Chosen: closed by the splats of 3 mm.
pub(super) const FURNITURE_SPACING_M: f64 = 0.005;
/// Spacing of the coarse models, metres. Chosen.
const COARSE_SPACING_M: f64 = 0.006;

/// Space in which the objects lie. Only what is in it counts as visible area.
#[derive(Debug, Clone, Copy)]
pub(super) struct Workspace {
    pub(super) least: Point3<f64>,
    pub(super) greatest: Point3<f64>,
    shape: WorkspaceShape,
}

/// Shape of a workspace within its least and greatest coordinates.
#[derive(Debug, Clone, Copy)]
enum WorkspaceShape {
    /// Box around a bin whose walls are known.
    Box(Bin),
    /// Ball: it depends on no axis of the world.
    Ball,
}

impl Workspace {
    /// Box around a bin on a table.
    pub(super) fn around_bin(least: Point3<f64>, greatest: Point3<f64>, bin: Bin) -> Self {
        Self {
            least,
            greatest,
            shape: WorkspaceShape::Box(bin),
        }
    }

    /// Ball around the middle of the objects that holds their surfaces and a margin.
    pub(super) fn around_objects(objects: &[BinObject]) -> Self {
        let origins = objects.iter().map(|object| object.origin().coords);
        let middle = origins.sum::<Vector3<f64>>() / objects.len().max(1) as f64;
        let places = objects.iter().flat_map(|object| {
            let points = object.coarse.points().iter();
            points.map(|point| object.world_from_object * Point3::from(*point).cast::<f64>())
        });
        let reach_m = places.map(|place| (place.coords - middle).norm());
        let radius_m = reach_m.fold(0.0, f64::max) + MARGIN_M;
        Self {
            least: middle.add_scalar(-radius_m).into(),
            greatest: middle.add_scalar(radius_m).into(),
            shape: WorkspaceShape::Ball,
        }
    }

    /// `true` for a place in the workspace.
    pub(super) fn contains(&self, in_world: &Point3<f64>) -> bool {
        match self.shape {
            WorkspaceShape::Box(_) => {
                (0..3).all(|axis| (self.least[axis]..self.greatest[axis]).contains(&in_world[axis]))
            }
            WorkspaceShape::Ball => {
                let middle = center(&self.least, &self.greatest);
                (in_world - middle).norm() < (self.greatest.x - self.least.x) / 2.0
            }
        }
    }

    /// `true` for a place at a wall of the bin, of which a robot knows where it is; `None` if the
    /// walls are not known.
    pub(super) fn is_at_wall(&self, in_world: &Point3<f64>) -> Option<bool> {
        let WorkspaceShape::Box(bin) = self.shape else {
            return None;
        };
        let [x, y, z] = bin.inner_size_m;
        let at = |value: f64, side: f64| (value.abs() - side / 2.0).abs() < WALL_BAND_M;
        let is_below_rim = in_world.z < self.least.z + DEPTH_M + z + WALL_BAND_M;
        Some(is_below_rim && (at(in_world.x, x) || at(in_world.y, y)))
    }
}

/// Object at rest in the bin.
#[derive(Debug)]
pub(super) struct BinObject {
    /// Number in the masks of the images.
    pub(super) id: u16,
    pub(super) model: SurfaceModel,
    /// The same surface with few points, for coarse searches.
    pub(super) coarse: SurfaceModel,
    pub(super) world_from_object: RigidTransform,
}

impl BinObject {
    /// Object of a mesh, metres.
    pub(super) fn new(
        id: u16,
        mesh: &mesh::TriangleMesh,
        world_from_object: RigidTransform,
    ) -> Result<Self, Failure> {
        let model = |spacing_m| SurfaceModel::of_mesh(mesh, spacing_m).map_err(Failure::general);
        Ok(Self {
            id,
            model: model(SPACING_M)?,
            coarse: model(COARSE_SPACING_M)?,
            world_from_object,
        })
    }

    /// Origin of the object, world frame, metres.
    pub(super) fn origin(&self) -> Point3<f64> {
        self.world_from_object.translation.vector.into()
    }
}

/// Scene at rest with its objects and candidate cameras, simulated or recorded.
#[derive(Debug)]
pub(super) struct BinScene {
    pub(super) objects: Vec<BinObject>,
    pub(super) workspace: Workspace,
    /// Points of the table and of the bin's walls in the workspace, world frame, metres.
    pub(super) furniture: Vec<[f32; 3]>,
    /// Pose of each camera, `world_from_camera`.
    pub(super) cameras: Vec<RigidTransform>,
}
