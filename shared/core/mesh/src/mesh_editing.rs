//! Mesh editing: merging, transforming, painting.

use crate::{Surface, TriangleMesh};
use nalgebra::{Isometry3, Point3, Vector3};

impl TriangleMesh {
    /// Corner positions of a triangle; `None` for an invalid index.
    pub(crate) fn corners(&self, triangle_idx: usize) -> Option<[Point3<f32>; 3]> {
        let [a, b, c] = self.triangles.get(triangle_idx)?.vertices;
        let at = |i: u32| self.vertices.get(i as usize).map(|vertex| vertex.position);
        Some([at(a)?, at(b)?, at(c)?])
    }

    /// Appends another mesh; equal surfaces are shared.
    ///
    /// Beyond 256 different surfaces the last one is taken.
    pub fn append(&mut self, other: &Self) {
        let first = self.vertices.len() as u32;
        let surfaces: Vec<u8> = other
            .surfaces
            .iter()
            .map(|surface| self.index_of(*surface))
            .collect();
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles
            .extend(other.triangles.iter().map(|triangle| {
                crate::Triangle {
                    vertices: triangle.vertices.map(|i| i + first),
                    surface: surfaces
                        .get(usize::from(triangle.surface))
                        .copied()
                        .unwrap_or(0),
                }
            }));
    }

    fn index_of(&mut self, surface: Surface) -> u8 {
        let known = self.surfaces.iter().position(|known| *known == surface);
        let idx = known.unwrap_or_else(|| {
            if self.surfaces.len() < 256 {
                self.surfaces.push(surface);
            }
            self.surfaces.len() - 1
        });
        idx as u8
    }

    /// Assigns one surface finish to all faces.
    pub fn set_surface(&mut self, surface: Surface) {
        self.surfaces = vec![surface];
        for triangle in &mut self.triangles {
            triangle.surface = 0;
        }
    }

    /// Colours each vertex by its position and normal.
    pub fn paint(&mut self, color: impl Fn(&Point3<f32>, &Vector3<f32>) -> [u8; 3]) {
        for vertex in &mut self.vertices {
            vertex.color = color(&vertex.position, &vertex.normal);
        }
    }

    /// Transforms the mesh by `pose`, which is `target_from_source`.
    pub fn transform(&mut self, pose: &Isometry3<f32>) {
        for vertex in &mut self.vertices {
            vertex.position = pose * vertex.position;
            vertex.normal = pose.rotation * vertex.normal;
        }
    }

    /// Scales the mesh by a positive factor.
    pub fn scale(&mut self, factor: f32) {
        for vertex in &mut self.vertices {
            vertex.position *= factor;
        }
    }

    /// Moves the centre of the bounding box to the origin; returns the displacement. An empty mesh
    /// is unchanged.
    pub fn recentre(&mut self) -> Vector3<f32> {
        let shift = self
            .bounds()
            .map_or_else(Vector3::zeros, |bounds| -bounds.centre().coords);
        for vertex in &mut self.vertices {
            vertex.position += shift;
        }
        shift
    }
}

#[cfg(test)]
mod tests {
    use crate::{Surface, TriangleMesh, rounded_box};
    use nalgebra::{Isometry3, Vector3};

    #[test]
    fn appended_parts_share_equal_surfaces() {
        let metal = Surface {
            specular: 0.9,
            infrared: 0.7,
        };
        let mut part = rounded_box([0.1, 0.1, 0.1], 0.0, 0.1).mesh;
        let mut mesh = TriangleMesh::default();
        mesh.append(&part);
        mesh.append(&part);
        assert_eq!(mesh.surfaces, [Surface::MATTE]);
        part.set_surface(metal);
        mesh.append(&part);
        assert_eq!(mesh.surfaces, [Surface::MATTE, metal]);
        assert_eq!(mesh.triangles.last().unwrap().surface, 1);
        assert_eq!(
            mesh.diagnostics().n_components,
            1,
            "they lie on one another"
        );
    }

    #[test]
    fn moving_keeps_the_shape_and_recentring_undoes_it() {
        let mut mesh = rounded_box([0.1, 0.2, 0.3], 0.01, 0.05).mesh;
        let (area, volume) = (mesh.surface_area(), mesh.signed_volume());
        mesh.transform(&Isometry3::new(
            Vector3::new(1.0, -2.0, 0.5),
            Vector3::z() * std::f32::consts::FRAC_PI_2,
        ));
        assert!((mesh.surface_area() / area - 1.0).abs() < 1e-4);
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 1e-3);
        mesh.recentre();
        let sides = mesh.bounds().unwrap().sides();
        assert!((sides - Vector3::new(0.2, 0.1, 0.3)).norm() < 1e-5);
        assert!(mesh.bounds().unwrap().centre().coords.norm() < 1e-6);
    }
}
