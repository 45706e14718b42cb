//! Ellipsoids and superellipsoids.

use crate::convex_part::sphere_inflation;
use crate::surface_builder::SurfaceBuilder;
use crate::{ConvexPart, Solid};
use nalgebra::Point3;
use std::f32::consts::{PI, TAU};

/// Ellipsoid around the origin with the given semi-axes, metres.
pub fn ellipsoid(semi_axes_m: [f32; 3], n_segments: usize) -> Solid {
    superellipsoid(semi_axes_m, 1.0, 1.0, n_segments)
}

/// Superellipsoid around the origin (Barr 1981). `vertical` and `horizontal` are the exponents
/// of the sections through the z axis and across it, 0.1 to 2: 1 is round, 0 a box, 2 a double
/// pyramid.
pub fn superellipsoid(
    semi_axes_m: [f32; 3],
    vertical: f32,
    horizontal: f32,
    n_segments: usize,
) -> Solid {
    let n_around = n_segments.max(4);
    let n_up = (n_around / 2).max(3);
    let [a, b, c] = semi_axes_m;
    let at = |latitude: f32, longitude: f32| {
        let (sin_up, cos_up) = latitude.sin_cos();
        let (sin, cos) = longitude.sin_cos();
        let across = power(cos_up, vertical);
        Point3::new(
            a * across * power(cos, horizontal),
            b * across * power(sin, horizontal),
            c * power(sin_up, vertical),
        )
    };
    let mut surface = SurfaceBuilder::default();
    let bottom = surface.point(Point3::new(0.0, 0.0, -c));
    let top = surface.point(Point3::new(0.0, 0.0, c));
    let rings: Vec<Vec<u32>> = (1..n_up)
        .map(|i| {
            let latitude = (i as f32 / n_up as f32 - 0.5) * PI;
            let longitude = |k| k as f32 / n_around as f32 * TAU;
            (0..n_around)
                .map(|k| surface.point(at(latitude, longitude(k))))
                .collect()
        })
        .collect();
    let lowest: Vec<u32> = rings[0].iter().rev().copied().collect();
    surface.fan(&lowest, bottom);
    for pair in rings.windows(2) {
        surface.band(&pair[0], &pair[1]);
    }
    surface.fan(&rings[rings.len() - 1], top);
    let mut part = ConvexPart::around(surface.points.clone());
    if part.points.len() < surface.points.len() {
        let widening = sphere_inflation(part.points.len());
        for point in &mut part.points {
            *point *= widening;
        }
    }
    Solid {
        mesh: surface.into_mesh(),
        convex_parts: vec![part],
        ..Solid::default()
    }
}

/// Signed power: |x|^exponent with the sign of x.
fn power(x: f32, exponent: f32) -> f32 {
    x.abs().powf(exponent).copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn superellipsoids_are_sound_and_fill_their_box(
            vertical in 0.2..1.6_f32, horizontal in 0.2..1.6_f32, n in 8..40_usize,
        ) {
            let solid = superellipsoid([0.02, 0.03, 0.05], vertical, horizontal, 4 * (n / 4));
            let found = solid.mesh.diagnostics();
            prop_assert!(found.is_sound(), "{:?}", found);
            let sides = found.extent.unwrap().sides();
            prop_assert!((sides.z - 0.1).abs() < 1e-4);
            prop_assert!(solid.mesh.signed_volume() > 0.0);
        }
    }
}
