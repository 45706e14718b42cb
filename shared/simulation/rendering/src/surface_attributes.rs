//! Surface attributes of a face, interpolated in each pixel.

use crate::Texture;
use crate::instance::Instance;
use crate::prepared_mesh::{Face, PreparedMesh};
use crate::projection::RigidTransformF32;
use geometry::RigidTransform;

/// Interpolated surface attributes in a pixel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceSample {
    /// Point on the surface, mesh frame.
    pub(crate) place: [f32; 3],
    /// Normal, camera frame, of any length but zero.
    pub(crate) normal: [f32; 3],
    /// Albedo of the surface without texture, linear sRGB.
    pub(crate) albedo: [f32; 3],
}

/// Attributes that all faces of an instance have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InstanceAttributes {
    mesh_from_camera: RigidTransformF32,
    camera_from_mesh: RigidTransformF32,
    pub(crate) texture: Texture,
    pub(crate) id: u16,
}

impl InstanceAttributes {
    /// Attributes of an instance; `None` when a transform is not finite.
    pub(crate) fn new(instance: &Instance<'_>, world_from_camera: &RigidTransform) -> Option<Self> {
        let mesh_from_camera = instance.world_from_mesh.inverse() * world_from_camera;
        Some(Self {
            mesh_from_camera: RigidTransformF32::new(&mesh_from_camera)?,
            camera_from_mesh: RigidTransformF32::new(&mesh_from_camera.inverse())?,
            texture: instance.texture,
            id: instance.id,
        })
    }
}

/// Precomputed attribute interpolation of one face, mesh frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceAttributes {
    origin: [f32; 3],
    /// Gradients of the barycentric coordinates of the second and third corner.
    gradients: [[f32; 3]; 2],
    normals: [[f32; 3]; 3],
    colors: [[f32; 3]; 3],
    pub(crate) specular: f32,
    pub(crate) infrared: f32,
}

impl FaceAttributes {
    #[inline]
    pub(crate) fn new(mesh: &PreparedMesh, face: &Face) -> Self {
        let [a, b, c] = face.corners.map(|i| &mesh.corners[i as usize]);
        let (along_b, along_c) = (sub(b.position, a.position), sub(c.position, a.position));
        let normal = cross(along_b, along_c);
        let per_area = 1.0 / dot(normal, normal).max(f32::MIN_POSITIVE);
        Self {
            origin: a.position,
            gradients: [
                scale(cross(along_c, normal), per_area),
                scale(cross(normal, along_b), per_area),
            ],
            normals: [a.normal, sub(b.normal, a.normal), sub(c.normal, a.normal)],
            colors: [
                a.linear_rgb,
                sub(b.linear_rgb, a.linear_rgb),
                sub(c.linear_rgb, a.linear_rgb),
            ],
            specular: face.specular,
            infrared: face.infrared,
        }
    }

    /// Interpolates the attributes at a point of the face, camera frame.
    #[expect(
        clippy::inline_always,
        reason = "a loop with a call in it is not vectorised; bench `camera_that_moves`"
    )]
    #[inline(always)]
    pub(crate) fn sample(
        &self,
        instance: &InstanceAttributes,
        point_in_camera: [f32; 3],
    ) -> SurfaceSample {
        let place = instance.mesh_from_camera.point(point_in_camera);
        let from_origin = sub(place, self.origin);
        let b = dot(from_origin, self.gradients[0]).clamp(0.0, 1.0);
        let c = dot(from_origin, self.gradients[1]).clamp(0.0, 1.0);
        let blend = |[a, along_b, along_c]: &[[f32; 3]; 3]| {
            std::array::from_fn(|i| a[i] + along_b[i] * b + along_c[i] * c)
        };
        SurfaceSample {
            place,
            normal: instance.camera_from_mesh.direction(blend(&self.normals)),
            albedo: blend(&self.colors),
        }
    }
}

#[inline]
fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
fn scale(a: [f32; 3], factor: f32) -> [f32; 3] {
    a.map(|part| part * factor)
}

#[inline]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
