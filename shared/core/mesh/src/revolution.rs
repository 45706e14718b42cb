//! Solids of revolution.

use crate::convex_part::{circle_inflation, n_sides};
use crate::surface_builder::SurfaceBuilder;
use crate::{ConvexPart, MAX_HULL_POINTS, Solid, convex_decomposition, simplify_polygon};
use nalgebra::{Point2, Point3};
use std::f32::consts::{PI, TAU};

/// Concavity tolerance of the section's convex decomposition, metres. Chosen.
const TOLERANCE_M: f32 = 0.003;
/// Largest tolerance, used to reduce the number of parts, metres. Chosen.
const TOLERANCE_MAX_M: f32 = 0.008;
/// Simplification tolerance of a section before its decomposition, metres. Chosen: less than
/// half a wall.
const SIMPLIFICATION_M: f32 = 0.0005;
/// Radius below which a gap around the axis is closed, metres. Chosen.
const AXIS_M: f32 = 0.002;
/// Maximum number of wedges of a ring. Chosen.
const N_WEDGES_MAX: usize = 10;
/// Maximum number of convex parts before the tolerance is increased. Chosen.
const N_PARTS_MAX: usize = 22;

/// Solid of revolution: rotates a closed profile about the z axis.
///
/// The profile's points are (radius, height) with radius ≥ 0. It either starts
/// and ends on the axis, or is a ring that is closed from its last point to its
/// first. It must not cross itself. Where it bends by more than 40° an edge
/// remains. `n_segments` ≥ 3 around. Fewer than three points give an empty solid.
///
/// The convex parts are slices where the section reaches the axis, and wedges
/// around it elsewhere, so that the inside of a vessel stays free.
pub fn lathe(profile: &[Point2<f32>], n_segments: usize) -> Solid {
    let n_segments = n_segments.max(3);
    if profile.len() < 3 {
        return Solid::default();
    }
    Solid {
        mesh: surface(profile, n_segments).into_mesh(),
        convex_parts: parts(profile),
        ..Solid::default()
    }
}

fn surface(profile: &[Point2<f32>], n_segments: usize) -> SurfaceBuilder {
    let mut surface = SurfaceBuilder::default();
    let rings: Vec<Vec<u32>> = profile
        .iter()
        .map(|p| ring(&mut surface, p, n_segments))
        .collect();
    let is_ring = rings[0].len() > 1;
    let n_bands = profile.len() - usize::from(!is_ring);
    for i in 0..n_bands {
        match (&rings[i][..], &rings[(i + 1) % rings.len()][..]) {
            ([_], [_]) => {}
            ([pole], upper) => {
                let reversed: Vec<u32> = upper.iter().rev().copied().collect();
                surface.fan(&reversed, *pole);
            }
            (lower, [pole]) => surface.fan(lower, *pole),
            (lower, upper) => surface.band(lower, upper),
        }
    }
    surface
}

/// Ring of points, or a single point on the axis.
fn ring(surface: &mut SurfaceBuilder, p: &Point2<f32>, n_segments: usize) -> Vec<u32> {
    if p.x <= 0.0 {
        return vec![surface.point(Point3::new(0.0, 0.0, p.y))];
    }
    (0..n_segments)
        .map(|k| surface.point(around(p, k as f32 / n_segments as f32 * TAU)))
        .collect()
}

fn around(p: &Point2<f32>, angle_rad: f32) -> Point3<f32> {
    let (sin, cos) = angle_rad.sin_cos();
    Point3::new(p.x * cos, p.x * sin, p.y)
}

fn parts(profile: &[Point2<f32>]) -> Vec<ConvexPart> {
    let section = simplify_polygon(profile, SIMPLIFICATION_M);
    let with_tolerance = |tolerance_m| -> Vec<ConvexPart> {
        convex_decomposition(&section, tolerance_m)
            .iter()
            .flat_map(|piece| turned(piece, tolerance_m))
            .collect()
    };
    let mut tolerance_m = TOLERANCE_M;
    let mut parts = with_tolerance(tolerance_m);
    while parts.len() > N_PARTS_MAX && tolerance_m < TOLERANCE_MAX_M {
        tolerance_m *= 1.4;
        parts = with_tolerance(tolerance_m);
    }
    parts
}

/// Convex parts of one convex piece of the section.
fn turned(piece: &[Point2<f32>], tolerance_m: f32) -> Vec<ConvexPart> {
    let radius = piece.iter().map(|p| p.x).fold(0.0, f32::max);
    let is_at_axis = piece.iter().any(|p| p.x < AXIS_M);
    if is_at_axis {
        return vec![slice(piece)];
    }
    // The chord of a wedge misses the circle by at most the tolerance.
    let half_angle = (1.0 - tolerance_m / radius).clamp(0.5, 1.0).acos();
    let n_wedges = ((PI / half_angle).ceil() as usize).clamp(6, N_WEDGES_MAX);
    (0..n_wedges).map(|k| wedge(piece, k, n_wedges)).collect()
}

fn slice(piece: &[Point2<f32>]) -> ConvexPart {
    let n_rings = |section: &[Point2<f32>]| section.iter().filter(|p| p.x >= AXIS_M).count();
    let radius = piece.iter().map(|p| p.x).fold(0.0, f32::max);
    // Reserves two points for the axis.
    let n_rings_max = (MAX_HULL_POINTS - 2) / n_sides(radius);
    let mut section = piece.to_vec();
    let mut tolerance_m = SIMPLIFICATION_M;
    while n_rings(&section) > n_rings_max && tolerance_m < 0.02 {
        section = simplify_polygon(piece, tolerance_m);
        tolerance_m *= 1.3;
    }
    let n_rings = n_rings(&section);
    let n_on_axis = section.len() - n_rings;
    let n_around = n_sides(radius).min((MAX_HULL_POINTS - n_on_axis) / n_rings.max(1));
    let widening = circle_inflation(n_around);
    let points = section.iter().flat_map(|p| {
        let n = if p.x >= AXIS_M { n_around } else { 1 };
        let corner = Point2::new(p.x * widening, p.y);
        // Half a step of rotation: a body lying along x or y rests on a side, not on a corner.
        (0..n).map(move |k| around(&corner, (k as f32 + 0.5) / n as f32 * TAU))
    });
    ConvexPart {
        points: points.collect(),
    }
}

fn wedge(piece: &[Point2<f32>], k: usize, n_wedges: usize) -> ConvexPart {
    let step = TAU / n_wedges as f32;
    let widening = circle_inflation(n_wedges);
    let points = piece.iter().flat_map(|p| {
        let corner = Point2::new(p.x * widening, p.y);
        [k, k + 1].map(|k| around(&corner, k as f32 * step))
    });
    ConvexPart::around(points.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts;

    fn profile(points: &[(f32, f32)]) -> Vec<Point2<f32>> {
        points.iter().map(|&(r, z)| Point2::new(r, z)).collect()
    }

    #[test]
    fn a_ring_has_the_volume_of_pappus() {
        let section = profile(&[(0.04, 0.0), (0.05, 0.0), (0.05, 0.02), (0.04, 0.02)]);
        let ring = lathe(&section, 96);
        assert!(ring.mesh.diagnostics().is_sound());
        let expected = 0.01 * 0.02 * consts::TAU * 0.045;
        assert!((ring.mesh.signed_volume() / expected - 1.0).abs() < 0.002);
        let inside = Point3::new(0.0, 0.0, 0.01);
        assert!(
            ring.convex_parts
                .iter()
                .all(|part| part.distance(&inside) > 0.03)
        );
    }

    #[test]
    fn a_cup_is_sound_and_free_inside() {
        let section = profile(&[
            (0.0, 0.0),
            (0.035, 0.0),
            (0.04, 0.09),
            (0.037, 0.09),
            (0.032, 0.004),
            (0.0, 0.004),
        ]);
        for section in [section.clone(), section.iter().rev().copied().collect()] {
            let cup = lathe(&section, 32);
            assert!(cup.mesh.diagnostics().is_sound());
            assert!(cup.mesh.signed_volume() > 0.0);
            assert!(cup.convex_parts.len() <= N_PARTS_MAX);
            let inside = Point3::new(0.0, 0.0, 0.05);
            assert!(
                cup.convex_parts
                    .iter()
                    .all(|part| part.distance(&inside) > 0.028)
            );
            for vertex in &cup.mesh.vertices {
                let distances = cup
                    .convex_parts
                    .iter()
                    .map(|p| p.distance(&vertex.position));
                assert!(distances.fold(f32::INFINITY, f32::min) < 0.004);
            }
        }
    }

    #[test]
    fn too_short_a_profile_gives_nothing() {
        assert_eq!(
            lathe(&profile(&[(0.0, 0.0), (0.1, 0.0)]), 16),
            Solid::default()
        );
    }
}
