//! Projection of mesh faces onto the image plane.

use crate::PreparedMesh;
use crate::near_clip::clip;
use crate::projection::{Projection, RigidTransformF32, ScreenCorner};
use crate::scanline::{FaceSide, ScanlineSpan, rasterize};

/// Frustum culling: true if a mesh may be within an image of `size` pixels.
pub(crate) fn is_mesh_visible(
    projection: &Projection,
    view_from_mesh: &RigidTransformF32,
    mesh: &PreparedMesh,
    size: (usize, usize),
) -> bool {
    projection.is_sphere_visible(view_from_mesh.point(mesh.center), mesh.radius_m, size)
}

/// Projects all corners of a mesh.
pub(crate) fn project_corners(
    mesh: &PreparedMesh,
    view_from_mesh: &RigidTransformF32,
    projection: &Projection,
    corners: &mut Vec<ScreenCorner>,
) {
    corners.clear();
    corners.extend(
        mesh.corners
            .iter()
            .map(|corner| projection.project(view_from_mesh.point(corner.position))),
    );
}

/// Mesh with its corners projected onto the image plane.
pub(crate) struct ProjectedMesh<'a> {
    pub(crate) mesh: &'a PreparedMesh,
    pub(crate) camera_from_mesh: &'a RigidTransformF32,
    pub(crate) projection: &'a Projection,
    /// Projected corners of the mesh, see [`project_corners`].
    pub(crate) corners: &'a [ScreenCorner],
    pub(crate) size: (usize, usize),
}

impl ProjectedMesh<'_> {
    /// Rasterises all front faces and calls `visit` with each span and the face's index.
    #[inline]
    pub(crate) fn for_each_span(&self, mut visit: impl FnMut(&ScanlineSpan, u32)) {
        for (number, face) in self.mesh.faces.iter().enumerate() {
            let corners = face.corners.map(|i| &self.corners[i as usize]);
            let mut draw = |corners: [&ScreenCorner; 3]| {
                rasterize(corners, FaceSide::Front, self.size, |span| {
                    visit(&span, number as u32);
                });
            };
            if corners.iter().all(|corner| corner.reverse_z > 0.0) {
                draw(corners);
            } else if corners.iter().any(|corner| corner.reverse_z > 0.0) {
                let in_camera = face.corners.map(|i| {
                    self.camera_from_mesh
                        .point(self.mesh.corners[i as usize].position)
                });
                clip(in_camera, self.projection, |part| draw(part.each_ref()));
            }
        }
    }
}
