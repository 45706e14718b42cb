//! Generation of an object from its category and instance number.

use crate::{Category, Variation};
use mesh::{ConvexPart, TriangleMesh, simplify_contact_faces};
use std::ops::Range;

/// Least mass of an object, kilograms. Chosen.
const MASS_MIN_KG: f32 = 0.005;

/// Generated household object: mesh, convex parts, mass and friction.
///
/// Frame: z up, in the resting pose on a table; the origin is the centre of the bounding box.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Name of the object's category.
    pub category: &'static str,
    /// Number of the instance within its category.
    pub instance: u64,
    /// Mesh of closed, overlapping parts, metres.
    pub mesh: TriangleMesh,
    /// Convex decomposition for physics; fills the surface to a few millimetres.
    pub convex_parts: Vec<ConvexPart>,
    /// Triangle ranges of the mesh without convex parts: stems, leaves, stickers.
    pub decoration: Vec<Range<usize>>,
    /// Mass of the object, kilograms.
    pub mass_kg: f32,
    /// Coulomb friction coefficient against a wooden table.
    pub friction: f32,
}

/// Generates an instance of a category. The same arguments give the same bytes.
pub fn generate(category: &Category, instance: u64) -> Object {
    let mut variation = Variation::of(category.name, instance);
    let solid = (category.build)(&mut variation).recentred();
    let volume_m3 = solid.mesh.signed_volume() as f32;
    Object {
        category: category.name,
        instance,
        mass_kg: (volume_m3 * category.density_kg_m3).max(MASS_MIN_KG),
        friction: category.friction,
        mesh: solid.mesh,
        convex_parts: simplify_contact_faces(solid.convex_parts),
        decoration: solid.decoration,
    }
}
