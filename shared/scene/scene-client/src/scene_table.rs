//! Support surfaces of a scene.

use geometry::Plane;
use message::{SceneSummary, SurfaceKind, WireSurface};
use nalgebra::{Point3, Unit, Vector3};

/// Support surface in the world, which is the camera's frame while its pose is not known.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSurface {
    /// Kind of the surface.
    pub kind: SurfaceKind,
    /// Plane of the surface.
    pub plane_in_world: Plane,
    /// Corners of the convex hull of what is seen of it, in order around it.
    pub corners_in_world: Vec<Point3<f64>>,
}

impl SceneSurface {
    /// Valid surfaces of a scene, the table first.
    pub fn all_of(scene: &SceneSummary) -> Vec<Self> {
        scene.surfaces().iter().filter_map(Self::of).collect()
    }

    fn of(surface: &WireSurface) -> Option<Self> {
        let corners = surface.corners_m().iter();
        Some(Self {
            kind: surface.checked_kind()?,
            plane_in_world: plane_in_world(surface)?,
            corners_in_world: corners
                .map(|corner| Point3::from(*corner).cast::<f64>())
                .filter(|corner| corner.iter().all(|c| c.is_finite()))
                .collect(),
        })
    }
}

/// Plane of the table in the world, which is the camera's frame while its pose is not known; `None`
/// without a table.
pub fn table_in_world(scene: &SceneSummary) -> Option<Plane> {
    plane_in_world(scene.table()?)
}

fn plane_in_world(surface: &WireSurface) -> Option<Plane> {
    let [x, y, z, offset_m] = surface.plane;
    let normal = Unit::try_new(Vector3::new(x, y, z), 1e-6)?;
    Some(Plane { normal, offset_m })
}
