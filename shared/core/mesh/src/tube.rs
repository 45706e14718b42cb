//! Tubes: elliptic sections swept along a curve.

use crate::convex_part::{circle_inflation, n_sides};
use crate::surface_builder::SurfaceBuilder;
use crate::{ConvexPart, Solid};
use nalgebra::{Point3, Vector3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Tolerance of the convex parts, metres. Chosen.
const TOLERANCE_M: f32 = 0.0025;
/// Number of rings of a rounded end.
const N_END_RINGS: usize = 4;

/// Elliptic cross-section of a tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubeSection {
    /// Centre of the cross-section, on the tube's curve.
    pub centre: Point3<f32>,
    /// Semi-axis perpendicular to the curve and to the up direction, metres.
    pub half_width: f32,
    /// Semi-axis of the cross-section along the up direction, metres.
    pub half_height: f32,
}

impl TubeSection {
    /// Circular cross-section.
    pub fn round(centre: Point3<f32>, radius: f32) -> Self {
        Self {
            centre,
            half_width: radius,
            half_height: radius,
        }
    }
}

/// Sweeps a tube through cross-sections, with flat ends. `up` is the direction of the first
/// section's height, not along the curve; it is transported without twist. `n_sides` ≥ 3. Fewer
/// than two different centres give an empty solid.
///
/// Each convex part spans the sections of a straight run of the curve.
pub fn tube(sections: &[TubeSection], up: Vector3<f32>, n_sides: usize) -> Solid {
    let mut sections = sections.to_vec();
    sections.dedup_by(|a, b| (a.centre - b.centre).norm() < 1e-7);
    if sections.len() < 2 {
        return Solid::default();
    }
    let n_sides = n_sides.max(3);
    let frames = frames(&sections, up);
    let mut surface = SurfaceBuilder::default();
    let rings: Vec<Vec<u32>> = sections
        .iter()
        .zip(&frames)
        .map(|(section, frame)| {
            let points = outline(section, frame, n_sides);
            points.map(|point| surface.point(point)).collect()
        })
        .collect();
    for pair in rings.windows(2) {
        surface.band(&pair[0], &pair[1]);
    }
    let first: Vec<u32> = rings[0].iter().rev().copied().collect();
    let start = surface.point(sections[0].centre);
    let end = surface.point(sections[sections.len() - 1].centre);
    surface.fan(&first, start);
    surface.fan(&rings[rings.len() - 1], end);
    Solid {
        mesh: surface.into_mesh(),
        convex_parts: parts(&sections, &frames),
        ..Solid::default()
    }
}

/// Tube with half ellipsoids as ends, beyond the first and last section.
pub fn rounded_tube(sections: &[TubeSection], up: Vector3<f32>, n_sides: usize) -> Solid {
    let n = sections.len();
    if n < 2 {
        return Solid::default();
    }
    let end = |last: TubeSection, before: TubeSection| {
        let outwards = (last.centre - before.centre)
            .try_normalize(0.0)
            .unwrap_or_else(Vector3::zeros);
        let length = last.half_width.min(last.half_height);
        (1..=N_END_RINGS).map(move |k| {
            // The last ring keeps a small radius, so that its cap has an area.
            let (sin, cos) = (k as f32 / N_END_RINGS as f32 * 0.97 * FRAC_PI_2).sin_cos();
            TubeSection {
                centre: last.centre + outwards * (length * sin),
                half_width: last.half_width * cos,
                half_height: last.half_height * cos,
            }
        })
    };
    let mut all: Vec<TubeSection> = end(sections[0], sections[1]).collect();
    all.reverse();
    all.extend_from_slice(sections);
    all.extend(end(sections[n - 1], sections[n - 2]));
    tube(&all, up, n_sides)
}

/// Moving frame of a cross-section along the tube's curve.
#[derive(Clone, Copy)]
struct SweepFrame {
    across: Vector3<f32>,
    up: Vector3<f32>,
}

/// Transported frames along the curve: the up direction of each is the projection of the
/// preceding one.
fn frames(sections: &[TubeSection], up: Vector3<f32>) -> Vec<SweepFrame> {
    let n = sections.len();
    let mut up = up;
    (0..n)
        .map(|i| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(n - 1));
            let (a, b, c) = (
                sections[before].centre,
                sections[i].centre,
                sections[after].centre,
            );
            // Tangent: normal of the plane that bisects the directions to both neighbours.
            let tangent = (b - a).try_normalize(0.0).unwrap_or_else(Vector3::zeros)
                + (c - b).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            let tangent = tangent.try_normalize(1e-6).unwrap_or_else(Vector3::x);
            let across = tangent
                .cross(&up)
                .try_normalize(1e-6)
                .unwrap_or_else(|| any_perpendicular(tangent));
            up = across.cross(&tangent);
            SweepFrame { across, up }
        })
        .collect()
}

fn any_perpendicular(tangent: Vector3<f32>) -> Vector3<f32> {
    let other = if tangent.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    tangent.cross(&other).normalize()
}

fn outline(
    section: &TubeSection,
    frame: &SweepFrame,
    n_sides: usize,
) -> impl Iterator<Item = Point3<f32>> + use<> {
    let (section, frame) = (*section, *frame);
    (0..n_sides).map(move |k| {
        let (sin, cos) = (k as f32 / n_sides as f32 * TAU).sin_cos();
        section.centre
            + frame.across * (cos * section.half_width)
            + frame.up * (sin * section.half_height)
    })
}

/// Convex parts: hulls around runs of sections that are close to their chord.
fn parts(sections: &[TubeSection], frames: &[SweepFrame]) -> Vec<ConvexPart> {
    let radii = sections.iter().map(|s| s.half_width.max(s.half_height));
    let n_sides = n_sides(radii.fold(0.0, f32::max));
    let widening = circle_inflation(n_sides);
    let mut parts = Vec::new();
    let mut from = 0;
    while from + 1 < sections.len() {
        let reaches = |to: &usize| is_straight(&sections[from..=*to]);
        let to = (from + 1..sections.len())
            .take_while(reaches)
            .last()
            .unwrap_or(from + 1);
        let points = (from..=to)
            .flat_map(|i| {
                let widened = TubeSection {
                    half_width: sections[i].half_width * widening,
                    half_height: sections[i].half_height * widening,
                    ..sections[i]
                };
                outline(&widened, &frames[i], n_sides)
            })
            .collect();
        parts.push(ConvexPart::around(points));
        from = to;
    }
    parts
}

/// True if centres and semi-axes change linearly from the first section to the last, within the
/// tolerance.
fn is_straight(sections: &[TubeSection]) -> bool {
    let (first, last) = (sections[0], sections[sections.len() - 1]);
    let along = last.centre - first.centre;
    sections.iter().all(|section| {
        let offset = section.centre - first.centre;
        let share = (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        let between = |a: f32, b: f32| a + (b - a) * share;
        let width = section.half_width - between(first.half_width, last.half_width);
        let height = section.half_height - between(first.half_height, last.half_height);
        (offset - along * share).norm() + width.abs().max(height.abs()) <= TOLERANCE_M
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts;

    #[test]
    fn a_straight_tube_is_a_cylinder() {
        let at = |x| TubeSection::round(Point3::new(x, 0.0, 0.0), 0.01);
        let solid = tube(&[at(0.0), at(0.05), at(0.1)], Vector3::z(), 64);
        assert!(solid.mesh.diagnostics().is_sound());
        let expected = consts::PI * 1e-4 * 0.1;
        assert!((solid.mesh.signed_volume() / expected - 1.0).abs() < 0.005);
        assert_eq!(solid.convex_parts.len(), 1);
        let rounded = rounded_tube(&[at(0.0), at(0.1)], Vector3::z(), 64).mesh;
        assert!(rounded.diagnostics().is_sound());
        let ball = 4.0 / 3.0 * consts::PI * 1e-6;
        assert!((rounded.signed_volume() / (expected + ball) - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_bent_tube_is_sound_and_followed_by_its_parts() {
        let sections: Vec<TubeSection> = (0..=16)
            .map(|i| (i as f32 / 16.0 * 4.0).sin_cos())
            .map(|(sin, cos)| TubeSection::round(Point3::new(0.03 * cos, 0.0, 0.03 * sin), 0.005))
            .collect();
        let solid = tube(&sections, Vector3::y(), 12);
        assert!(solid.mesh.diagnostics().is_sound());
        for vertex in &solid.mesh.vertices {
            let distances = solid
                .convex_parts
                .iter()
                .map(|p| p.distance(&vertex.position));
            assert!(distances.fold(f32::INFINITY, f32::min) < 0.004);
        }
        let middle = Point3::origin();
        assert!(
            solid
                .convex_parts
                .iter()
                .all(|part| part.distance(&middle) > 0.02)
        );
    }

    #[test]
    fn coincident_sections_make_no_tube() {
        let section = TubeSection::round(Point3::origin(), 0.01);
        assert_eq!(tube(&[section, section], Vector3::z(), 8), Solid::default());
    }
}
