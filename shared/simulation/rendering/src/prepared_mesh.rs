//! Validated mesh with precomputed shading data.

use mesh::{Surface, Triangle, TriangleMesh, Vertex};

/// Greatest coordinate of a drawn vertex, metres.
const COORDINATE_MAX_M: f32 = 1000.0;

/// Mesh corner with linear colour, mesh frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) linear_rgb: [f32; 3],
}

/// Triangle: indices of its corners and its surface finish.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    pub(crate) corners: [u32; 3],
    pub(crate) specular: f32,
    pub(crate) infrared: f32,
}

/// Validated triangle mesh of which every face can be drawn.
///
/// Skips faces with a missing corner, a coordinate or normal that is not finite, a coordinate
/// beyond 1 km, or no area. A face without a valid surface index is matte.
#[derive(Debug, Clone, Default)]
pub struct PreparedMesh {
    pub(crate) corners: Vec<Corner>,
    pub(crate) faces: Vec<Face>,
    pub(crate) center: [f32; 3],
    pub(crate) radius_m: f32,
    n_skipped: usize,
}

impl PreparedMesh {
    /// Validates and copies a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let corners: Vec<Corner> = mesh.vertices.iter().map(corner).collect();
        let faces: Vec<Face> = mesh
            .triangles
            .iter()
            .filter(|triangle| is_drawable(triangle, &mesh.vertices))
            .map(|triangle| face(triangle, &mesh.surfaces))
            .collect();
        let (center, radius_m) = bounding_sphere(&corners, &faces);
        Self {
            n_skipped: mesh.triangles.len() - faces.len(),
            corners,
            faces,
            center,
            radius_m,
        }
    }

    /// Number of faces of the mesh.
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Number of faces of the source mesh that were skipped.
    pub fn n_skipped(&self) -> usize {
        self.n_skipped
    }
}

impl From<&TriangleMesh> for PreparedMesh {
    fn from(mesh: &TriangleMesh) -> Self {
        Self::new(mesh)
    }
}

fn corner(vertex: &Vertex) -> Corner {
    let p = vertex.position;
    let is_usable = p.iter().all(|c| c.abs() <= COORDINATE_MAX_M)
        && vertex.normal.iter().all(|c| c.abs() <= 10.0);
    let (position, normal) = if is_usable {
        ([p.x, p.y, p.z], vertex.normal.into())
    } else {
        ([0.0; 3], [0.0, 0.0, 1.0])
    };
    Corner {
        position,
        normal,
        linear_rgb: vertex.color.map(linear_from_srgb),
    }
}

fn is_drawable(triangle: &Triangle, vertices: &[Vertex]) -> bool {
    let corner = |i: usize| vertices.get(triangle.vertices[i] as usize);
    let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else {
        return false;
    };
    let is_usable = [a, b, c].iter().all(|vertex| {
        vertex
            .position
            .iter()
            .all(|coordinate| coordinate.abs() <= COORDINATE_MAX_M)
            && vertex.normal.iter().all(|part| part.abs() <= 10.0)
    });
    is_usable
        && (b.position - a.position)
            .cross(&(c.position - a.position))
            .norm_squared()
            > 0.0
}

fn face(triangle: &Triangle, surfaces: &[Surface]) -> Face {
    let surface = surfaces
        .get(usize::from(triangle.surface))
        .unwrap_or(&Surface::MATTE);
    let share = |value: f32| {
        if value.is_finite() {
            value.clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    Face {
        corners: triangle.vertices,
        specular: share(surface.specular),
        infrared: share(surface.infrared),
    }
}

/// Bounding sphere: centre of the bounding box and distance of the farthest corner.
fn bounding_sphere(corners: &[Corner], faces: &[Face]) -> ([f32; 3], f32) {
    let used = || {
        faces
            .iter()
            .flat_map(|face| face.corners)
            .map(|i| corners[i as usize].position)
    };
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for position in used() {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    if faces.is_empty() {
        return ([0.0; 3], 0.0);
    }
    let center: [f32; 3] = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
    let radius_m = used()
        .map(|p| (0..3).map(|axis| (p[axis] - center[axis]).powi(2)).sum())
        .fold(0.0, |farthest: f32, squared: f32| farthest.max(squared))
        .sqrt();
    (center, radius_m)
}

/// sRGB decoding: linear value of a byte, 0 to 1 (IEC 61966-2-1).
pub(crate) fn linear_from_srgb(value: u8) -> f32 {
    let s = f32::from(value) / 255.0;
    if s <= 0.040_45 {
        s / 12.92
    } else {
        ((s + 0.055) / 1.055).powf(2.4)
    }
}

/// Infrared albedo: share of infrared light that a face of this luminance scatters back.
///
/// Dyes that look dark are often bright in the near infrared, so the colour's
/// brightness counts only in part.
#[inline]
pub(crate) fn infrared_albedo(infrared: f32, luminance: f32) -> f32 {
    infrared * (0.35 + 0.65 * luminance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    fn vertex(x: f32, y: f32) -> Vertex {
        Vertex {
            position: Point3::new(x, y, 0.0),
            normal: Vector3::z(),
            color: [128; 3],
        }
    }

    #[test]
    fn invalid_faces_are_skipped() {
        let mesh = TriangleMesh {
            vertices: vec![
                vertex(0.0, 0.0),
                vertex(1.0, 0.0),
                vertex(0.0, 1.0),
                vertex(f32::NAN, 0.0),
                vertex(2.0, 0.0),
                vertex(1e30, 0.0),
            ],
            triangles: [[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 99], [0, 5, 2]]
                .map(|vertices| Triangle {
                    vertices,
                    surface: 7,
                })
                .to_vec(),
            surfaces: vec![],
        };
        let prepared = PreparedMesh::new(&mesh);
        assert_eq!((prepared.n_faces(), prepared.n_skipped()), (1, 4));
        assert!((prepared.radius_m - 0.5_f32.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn srgb_decoding_matches_known_values() {
        assert_eq!(linear_from_srgb(0), 0.0);
        assert_eq!(linear_from_srgb(255), 1.0);
        assert!((linear_from_srgb(188) - 0.5).abs() < 0.005);
    }
}
