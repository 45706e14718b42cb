//! Extrusion of a polygon to a solid.

use crate::surface_builder::SurfaceBuilder;
use crate::triangulation::doubled_signed_area;
use crate::{ConvexPart, Solid, convex_decomposition, simplify_polygon, triangulate};
use nalgebra::{Point2, Vector2};

/// Concavity tolerance of the convex parts, metres. Chosen.
const TOLERANCE_M: f32 = 0.003;
/// Simplification tolerance of the outline before its decomposition, metres. Chosen.
const SIMPLIFICATION_M: f32 = 0.0006;

/// Extrudes a simple outline, convex or concave, from z = 0 to `height_m`. Its edges are
/// bevelled by `bevel_m` (0 for sharp edges), which must be less than the narrowest part
/// allows. Fewer than three points give an empty solid.
pub fn extrude(outline: &[Point2<f32>], height_m: f32, bevel_m: f32) -> Solid {
    let mut outline = outline.to_vec();
    outline.dedup_by(|a, b| (*a - *b).norm() < 1e-6);
    if outline.len() < 3 {
        return Solid::default();
    }
    if doubled_signed_area(&outline) < 0.0 {
        outline.reverse();
    }
    let pieces = convex_decomposition(&simplify_polygon(&outline, SIMPLIFICATION_M), TOLERANCE_M);
    let raised = |piece: &Vec<Point2<f32>>| {
        let points = piece
            .iter()
            .flat_map(|p| [0.0, height_m].map(|z| p.coords.push(z).into()));
        ConvexPart::around(points.collect())
    };
    Solid {
        mesh: surface(&outline, height_m, bevel_m.clamp(0.0, height_m / 2.0)).into_mesh(),
        convex_parts: pieces.iter().map(raised).collect(),
        ..Solid::default()
    }
}

fn surface(outline: &[Point2<f32>], height: f32, bevel: f32) -> SurfaceBuilder {
    let cap = if bevel > 0.0 {
        inset(outline, bevel)
    } else {
        outline.to_vec()
    };
    let mut surface = SurfaceBuilder::default();
    let mut ring = |points: &[Point2<f32>], z: f32| -> Vec<u32> {
        let points = points.iter();
        points
            .map(|p| surface.point(p.coords.push(z).into()))
            .collect()
    };
    let bottom = ring(&cap, 0.0);
    let mut rings = vec![bottom.clone()];
    if bevel > 0.0 {
        rings.push(ring(outline, bevel));
        rings.push(ring(outline, height - bevel));
    }
    let top = ring(&cap, height);
    rings.push(top.clone());
    for pair in rings.windows(2) {
        surface.band(&pair[0], &pair[1]);
    }
    for [a, b, c] in triangulate(&cap) {
        surface.triangle(bottom[a], bottom[c], bottom[b]);
        surface.triangle(top[a], top[b], top[c]);
    }
    surface
}

/// Inset polygon: corners moved inwards along their bisectors.
fn inset(outline: &[Point2<f32>], distance: f32) -> Vec<Point2<f32>> {
    let n = outline.len();
    let inwards = |from: Point2<f32>, to: Point2<f32>| {
        let along = (to - from).normalize();
        Vector2::new(-along.y, along.x)
    };
    (0..n)
        .map(|i| {
            let (before, at, after) = (outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n]);
            let (a, b) = (inwards(before, at), inwards(at, after));
            let middle = a + b;
            // A sharp corner would move too far; limit it to twice the distance.
            at + middle * (distance * 2.0 / middle.norm_squared()).min(2.0 * distance)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_star_becomes_a_sound_body(
            radii in prop::collection::vec(0.03..0.06_f32, 5..40), bevel in 0.0..0.001_f32,
        ) {
            let n = radii.len() as f32;
            let at = |(i, r): (usize, &f32)| {
                let (sin, cos) = (i as f32 / n * std::f32::consts::TAU).sin_cos();
                Point2::new(r * cos, r * sin)
            };
            let outline: Vec<_> = radii.iter().enumerate().map(at).collect();
            let solid = extrude(&outline, 0.02, bevel);
            let found = solid.mesh.diagnostics();
            prop_assert!(found.is_sound(), "{:?}", found);
            let volume = doubled_signed_area(&outline) / 2.0 * 0.02;
            let share = solid.mesh.signed_volume() as f32 / volume;
            prop_assert!(share <= 1.0001 && share > 0.85, "{}", share);
        }
    }

    #[test]
    fn extrusion_keeps_the_notch_of_a_u_free() {
        let u = [
            (0.0, 0.0),
            (0.06, 0.0),
            (0.06, 0.05),
            (0.05, 0.05),
            (0.05, 0.01),
            (0.01, 0.01),
        ];
        let mut outline: Vec<_> = u.iter().map(|&(x, y)| Point2::new(x, y)).collect();
        outline.extend([Point2::new(0.01, 0.05), Point2::new(0.0, 0.05)]);
        let solid = extrude(&outline, 0.02, 0.0);
        let notch = nalgebra::Point3::new(0.03, 0.03, 0.01);
        assert!(
            solid
                .convex_parts
                .iter()
                .all(|part| part.distance(&notch) > 0.015)
        );
    }
}
