//! A mesh's faces on the image plane.

use crate::PreparedMesh;
use crate::near_clip::clip;
use crate::projection::{Lens, Placement, ScreenCorner};
use crate::scanline::{Side, Span, scan};

/// Whether a mesh may lie within an image of `size` pixels.
pub(crate) fn may_see(
    lens: &Lens,
    lens_from_mesh: &Placement,
    mesh: &PreparedMesh,
    size: (usize, usize),
) -> bool {
    lens.may_see(lens_from_mesh.point(mesh.center), mesh.radius_m, size)
}

/// Projects all corners of a mesh.
pub(crate) fn project(
    mesh: &PreparedMesh,
    lens_from_mesh: &Placement,
    lens: &Lens,
    corners: &mut Vec<ScreenCorner>,
) {
    corners.clear();
    corners.extend(
        mesh.corners
            .iter()
            .map(|corner| lens.project(lens_from_mesh.point(corner.position))),
    );
}

/// The faces of a mesh as the camera sees them.
pub(crate) struct FaceView<'a> {
    pub(crate) mesh: &'a PreparedMesh,
    pub(crate) camera_from_mesh: &'a Placement,
    pub(crate) lens: &'a Lens,
    /// All corners of the mesh, by [`project`].
    pub(crate) corners: &'a [ScreenCorner],
    pub(crate) size: (usize, usize),
}

impl FaceView<'_> {
    /// Calls `visit` with each span of each face that shows its outside.
    #[inline]
    pub(crate) fn for_each_span(&self, mut visit: impl FnMut(&Span, u32)) {
        for (number, face) in self.mesh.faces.iter().enumerate() {
            let corners = face.corners.map(|i| &self.corners[i as usize]);
            let mut draw = |corners: [&ScreenCorner; 3]| {
                scan(corners, Side::Front, self.size, |span| {
                    visit(&span, number as u32);
                });
            };
            if corners.iter().all(|corner| corner.closeness > 0.0) {
                draw(corners);
            } else if corners.iter().any(|corner| corner.closeness > 0.0) {
                let in_camera = face.corners.map(|i| {
                    self.camera_from_mesh
                        .point(self.mesh.corners[i as usize].position)
                });
                clip(in_camera, self.lens, |part| draw(part.each_ref()));
            }
        }
    }
}
