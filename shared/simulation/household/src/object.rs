//! An instance of a category.

use crate::{Category, Variation};
use mesh::{ConvexPart, TriangleMesh, with_four_cornered_faces};
use std::ops::Range;

/// Least mass of anything, kilograms.
const MASS_MIN_KG: f32 = 0.005;

/// A household object.
///
/// Frame: z up, in the pose in which it stands or lies on a table; the origin
/// is the centre of the bounding box.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Name of its category.
    pub category: &'static str,
    /// Which one of the category.
    pub instance: u64,
    /// Its surface: closed parts that overlap, metres.
    pub mesh: TriangleMesh,
    /// Bodies that together fill it to a few millimetres, for physics.
    pub convex_parts: Vec<ConvexPart>,
    /// Triangles of the mesh that are not filled: stems, leaves, stickers.
    pub decoration: Vec<Range<usize>>,
    /// Mass, kilograms.
    pub mass_kg: f32,
    /// Coefficient of friction against a wooden table.
    pub friction: f32,
}

/// Makes an instance of a category. The same arguments give the same bytes.
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
        convex_parts: with_four_cornered_faces(solid.convex_parts),
        decoration: solid.decoration,
    }
}
