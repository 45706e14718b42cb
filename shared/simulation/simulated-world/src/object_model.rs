//! Object model: mesh, mass, friction and collision shape.

use crate::error::Error;
use crate::glam_conversion::point_to_glam;
use mesh::{ConvexPart, TriangleMesh};
use nalgebra::Vector3;
use rapier3d::math::Pose;
use rapier3d::prelude::SharedShape;
use std::path::PathBuf;

/// Origin of a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ModelOrigin {
    /// Generated instance of a category.
    Generated {
        /// Instance number of the generated object.
        instance: u64,
    },
    /// Model file in PLY, OBJ, STL or DAE format.
    File(PathBuf),
}

/// Object model for rendering and physics.
///
/// Frame: origin in the middle of the bounding box, z up in the natural upright pose.
#[derive(Clone)]
pub struct ObjectModel {
    /// Category name of the model, such as `mug`.
    pub category: String,
    /// Unique name of the model instance: `mug-3`.
    pub name: String,
    /// Origin of the model.
    pub origin: ModelOrigin,
    /// Surface mesh of the model.
    pub mesh: TriangleMesh,
    /// Half sides of the bounding box, metres.
    pub half_sides_m: Vector3<f64>,
    /// Mass of the object, kilograms.
    pub mass_kg: f64,
    /// Coulomb friction coefficient of the object.
    pub friction: f64,
    /// Convex parts of the object, for collisions.
    pub convex_parts: Vec<ConvexPart>,
    /// Collision shape of the object: its convex parts.
    pub(crate) shape: SharedShape,
}

impl std::fmt::Debug for ObjectModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ObjectModel")
            .field("name", &self.name)
            .field("half_sides_m", &self.half_sides_m)
            .finish_non_exhaustive()
    }
}

impl ObjectModel {
    /// Generated object; the same category and instance give the same object.
    ///
    /// # Errors
    /// [`Error::UnknownCategory`].
    pub fn generated(category: &str, instance: u64) -> Result<Self, Error> {
        let known = household::category(category).ok_or_else(|| Error::UnknownCategory {
            category: category.to_owned(),
        })?;
        let object = household::generate(known, instance);
        let name = format!("{category}-{instance}");
        let shape = compound_shape(&object.convex_parts).ok_or_else(|| Error::Model {
            name: name.clone(),
            cause: "none of its parts has a volume".into(),
        })?;
        Ok(Self {
            category: category.to_owned(),
            name,
            origin: ModelOrigin::Generated { instance },
            half_sides_m: half_sides(&object.mesh),
            mesh: object.mesh,
            mass_kg: object.mass_kg.into(),
            friction: object.friction.into(),
            convex_parts: object.convex_parts,
            shape,
        })
    }

    /// Footprint radius: radius of the smallest upright cylinder around the middle that contains
    /// the object, metres.
    pub fn footprint_radius_m(&self) -> f64 {
        let reach = |v: &mesh::Vertex| v.position.x.hypot(v.position.y);
        f64::from(self.mesh.vertices.iter().map(reach).fold(0.0, f32::max))
    }
}

/// Half sides of the bounding box of a centred mesh, metres.
pub(crate) fn half_sides(mesh: &TriangleMesh) -> Vector3<f64> {
    let mut half = Vector3::<f32>::zeros();
    for vertex in &mesh.vertices {
        half = half.sup(&vertex.position.coords.abs());
    }
    half.cast()
}

/// Compound shape of convex parts; parts without a volume are left out. `None` when none is left.
pub(crate) fn compound_shape(parts: &[ConvexPart]) -> Option<SharedShape> {
    let hulls: Vec<_> = parts
        .iter()
        .filter_map(|part| {
            let points: Vec<_> = part.points.iter().map(point_to_glam).collect();
            SharedShape::convex_hull(&points)
        })
        .map(|hull| (Pose::IDENTITY, hull))
        .collect();
    match hulls.as_slice() {
        [] => None,
        [(_, single)] => Some(single.clone()),
        _ => Some(SharedShape::compound(hulls)),
    }
}
