//! The look of a face in a pixel: what depends on the mesh.

use crate::Texture;
use crate::image::LINEAR_ONE;
use crate::instance::Instance;
use crate::prepared_mesh::{Face, PreparedMesh};
use crate::projection::Placement;
use crate::whole_number::floor;
use geometry::RigidTransform;

/// Light in a pixel: what always arrives, and what the main light adds where
/// no shadow lies. Linear sRGB.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Radiance {
    pub(crate) unlit: [f32; 3],
    pub(crate) lit: [f32; 3],
}

impl Radiance {
    /// Whether a shadow can be seen on it.
    #[inline]
    pub(crate) fn has_main_light(&self) -> bool {
        self.lit != [0.0; 3]
    }

    /// The image's colour where `light` of 255 parts of the main light arrive.
    #[inline]
    pub(crate) fn color(&self, light: u8) -> [u16; 3] {
        std::array::from_fn(|i| color_channel(self.unlit[i], self.lit[i], light))
    }
}

/// One channel of [`Radiance::color`].
#[inline]
pub(crate) fn color_channel(unlit: f32, lit: f32, light: u8) -> u16 {
    let share = f32::from(light) * (1.0 / 255.0);
    let value = (unlit + lit * share) * LINEAR_ONE + 0.5;
    floor(value.clamp(0.0, 65_535.0)) as u16
}

/// What is seen in a pixel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Mesh frame.
    pub(crate) place: [f32; 3],
    /// Camera frame, of any length but zero.
    pub(crate) normal: [f32; 3],
    /// Linear sRGB, without texture.
    pub(crate) albedo: [f32; 3],
}

/// All that the faces of one instance have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InstanceLook {
    mesh_from_camera: Placement,
    camera_from_mesh: Placement,
    pub(crate) texture: Texture,
    pub(crate) id: u16,
}

impl InstanceLook {
    /// `None` when a transform is not finite.
    pub(crate) fn new(instance: &Instance<'_>, world_from_camera: &RigidTransform) -> Option<Self> {
        let mesh_from_camera = instance.world_from_mesh.inverse() * world_from_camera;
        Some(Self {
            mesh_from_camera: Placement::new(&mesh_from_camera)?,
            camera_from_mesh: Placement::new(&mesh_from_camera.inverse())?,
            texture: instance.texture,
            id: instance.id,
        })
    }
}

/// A face prepared to be looked at in many pixels, mesh frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceLook {
    origin: [f32; 3],
    /// Barycentric coordinates of the second and third corner grow along these.
    gradients: [[f32; 3]; 2],
    normals: [[f32; 3]; 3],
    colors: [[f32; 3]; 3],
    pub(crate) specular: f32,
    pub(crate) infrared: f32,
}

impl FaceLook {
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

    /// What is seen at a point of the face, camera frame.
    #[inline]
    pub(crate) fn sample(&self, look: &InstanceLook, point_in_camera: [f32; 3]) -> Sample {
        let place = look.mesh_from_camera.point(point_in_camera);
        let from_origin = sub(place, self.origin);
        let b = dot(from_origin, self.gradients[0]).clamp(0.0, 1.0);
        let c = dot(from_origin, self.gradients[1]).clamp(0.0, 1.0);
        let blend = |[a, along_b, along_c]: &[[f32; 3]; 3]| {
            std::array::from_fn(|i| a[i] + along_b[i] * b + along_c[i] * c)
        };
        Sample {
            place,
            normal: look.camera_from_mesh.direction(blend(&self.normals)),
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
