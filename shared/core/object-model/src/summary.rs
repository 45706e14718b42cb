//! Summary of an object model for lists and sentences.

use crate::model::ObjectModel;

/// Summary of an object model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelSummary {
    /// Extents of the surface along the axes of the object's frame, metres; zero without vertices.
    pub extents_m: [f64; 3],
    /// Number of vertices.
    pub n_vertices: usize,
    /// Number of triangles.
    pub n_triangles: usize,
    /// Number of views that were fused.
    pub n_views: usize,
    /// Number of views that were refused.
    pub n_refused: usize,
    /// Share of the directions from which the surface was seen, 0 to 1.
    pub completeness: f64,
}

impl ObjectModel {
    /// Extents, counts, and completeness of the model.
    pub fn summary(&self) -> ModelSummary {
        let extent_m = |axis: usize| {
            let vertices = self.mesh.vertices.iter();
            let coordinates = vertices.map(|vertex| f64::from(vertex.position[axis]));
            let bounds = (f64::INFINITY, f64::NEG_INFINITY);
            let (least, most) = coordinates.fold(bounds, |(least, most), coordinate| {
                (least.min(coordinate), most.max(coordinate))
            });
            (most - least).max(0.0)
        };
        ModelSummary {
            extents_m: [0, 1, 2].map(extent_m),
            n_vertices: self.mesh.vertices.len(),
            n_triangles: self.mesh.triangles.len(),
            n_views: self.views.len(),
            n_refused: self.refused.len(),
            completeness: self.unseen.completeness(),
        }
    }
}
