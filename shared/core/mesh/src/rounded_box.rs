//! Box with rounded edges.

use crate::surface_builder::SurfaceBuilder;
use crate::{ConvexPart, Solid};
use nalgebra::{Point3, Vector3};
use std::f32::consts::FRAC_PI_4;

/// Number of segments of half a rounded edge; the finest edges are only chamfered.
fn n_round(radius_m: f32) -> usize {
    match radius_m {
        r if r < 0.0015 => 1,
        r if r < 0.004 => 2,
        _ => 3,
    }
}

/// Box around the origin with sides `sides_m` and edges rounded by `radius_m` (at most half the
/// shortest side; 0 for sharp edges). Its faces are divided into cells no longer than `cell_m`.
pub fn rounded_box(sides_m: [f32; 3], radius_m: f32, cell_m: f32) -> Solid {
    let half = Vector3::from(sides_m) / 2.0;
    let radius = radius_m.clamp(0.0, half.min());
    let inner = half.add_scalar(-radius);
    let ticks = [0, 1, 2].map(|axis| ticks(inner[axis], radius, cell_m));
    let mut surface = SurfaceBuilder::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            face(&mut surface, &ticks, axis, side);
        }
    }
    for point in &mut surface.points {
        *point = rounded(*point, inner, radius);
    }
    Solid {
        mesh: surface.into_mesh(),
        convex_parts: vec![ConvexPart {
            points: corners(half, radius),
        }],
        ..Solid::default()
    }
}

/// Grid coordinates along an axis: even between the edges, at equal angles around them.
fn ticks(inner: f32, radius: f32, cell: f32) -> Vec<f32> {
    let n_cells = ((2.0 * inner / cell.max(1e-4)).ceil() as usize).max(1);
    // Exactly symmetric, so that neighbouring faces meet.
    let at = |i: usize| inner * ((2 * i) as f32 - n_cells as f32) / n_cells as f32;
    let mut ticks: Vec<f32> = (0..=n_cells).map(at).collect();
    if radius > 0.0 {
        let n = n_round(radius);
        for k in 1..=n {
            let beyond = inner + radius * (k as f32 / n as f32 * FRAC_PI_4).tan();
            ticks.insert(0, -beyond);
            ticks.push(beyond);
        }
    }
    ticks.dedup();
    ticks
}

/// Adds a face of the sharp box, on the negative or positive side of an axis.
fn face(surface: &mut SurfaceBuilder, ticks: &[Vec<f32>; 3], axis: usize, side: f32) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let end = side * ticks[axis].last().copied().unwrap_or(0.0);
    let first = surface.points.len() as u32;
    for y in &ticks[v] {
        for x in &ticks[u] {
            let mut point = Point3::origin();
            (point[axis], point[u], point[v]) = (end, *x, *y);
            surface.point(point);
        }
    }
    let n = ticks[u].len() as u32;
    for row in 0..ticks[v].len() as u32 - 1 {
        for column in 0..n - 1 {
            let a = first + row * n + column;
            if side > 0.0 {
                surface.quad(a, a + 1, a + n + 1, a + n);
            } else {
                surface.quad(a, a + n, a + n + 1, a + 1);
            }
        }
    }
}

/// Projects a point of the sharp box onto the rounded box.
fn rounded(point: Point3<f32>, inner: Vector3<f32>, radius: f32) -> Point3<f32> {
    let nearest = Point3::from(
        point
            .coords
            .zip_map(&inner, |x, limit| x.clamp(-limit, limit)),
    );
    match (point - nearest).try_normalize(0.0) {
        Some(outwards) => nearest + outwards * radius,
        None => point,
    }
}

/// Corners of the box, each chamfered by a triangle.
fn corners(half: Vector3<f32>, radius: f32) -> Vec<Point3<f32>> {
    let n_per_corner = if radius > 0.0 { 3 } else { 1 };
    (0..8)
        .flat_map(|i| {
            let sign = Vector3::from_fn(|axis, _| if i >> axis & 1 == 0 { -1.0 } else { 1.0 });
            (0..n_per_corner).map(move |kept| {
                let cut = Vector3::from_fn(|axis, _| if axis == kept { 0.0 } else { radius });
                Point3::from((half - cut).component_mul(&sign))
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_volume_is_that_of_a_box_swept_by_a_ball() {
        let (a, b, c, r) = (0.04_f64, 0.06, 0.09, 0.01);
        let sides = [a, b, c].map(|side| (side + 2.0 * r) as f32);
        let solid = rounded_box(sides, r as f32, 0.01);
        let found = solid.mesh.diagnostics();
        assert!(found.is_sound(), "{found:?}");
        let expected = a * b * c
            + 2.0 * r * (a * b + b * c + c * a)
            + PI * r * r * (a + b + c)
            + 4.0 / 3.0 * PI * r * r * r;
        assert!((solid.mesh.signed_volume() / expected - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_sphere_is_a_fully_rounded_box() {
        let found = rounded_box([0.02, 0.02, 0.02], 1.0, 0.01)
            .mesh
            .diagnostics();
        assert!(found.is_sound(), "{found:?}");
    }
}
