//! Planar curves: lathe profiles (radius, height) and outlines (x, y), metres.

use mesh::{Solid, lathe};
use nalgebra::{Point2, Vector2};
use std::f32::consts::TAU;

/// Profile curve: polyline in a plane.
pub(crate) type Profile = Vec<Point2<f32>>;

/// Point distance along a lathe profile, metres.
const STEP_M: f32 = 0.009;
/// Point distance along a lathe profile with a printed label, metres.
const PRINT_STEP_M: f32 = 0.0045;

/// Profile polyline through points.
pub(crate) fn polyline(points: &[(f32, f32)]) -> Profile {
    points.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

/// Catmull–Rom spline through points (1974), `n` steps per segment.
pub(crate) fn spline(points: &[(f32, f32)], n: usize) -> Profile {
    let points = polyline(points);
    let last = points.len().saturating_sub(1);
    let at = |i: usize, t: f32| {
        let (p0, p1) = (points[i.saturating_sub(1)], points[i]);
        let (p2, p3) = (points[(i + 1).min(last)], points[(i + 2).min(last)]);
        p1 + hermite(p2 - p1, (p2 - p0) * 0.5, (p3 - p1) * 0.5, t)
    };
    let mut curve: Profile = (0..last)
        .flat_map(|i| (0..n).map(move |k| (i, k as f32 / n as f32)))
        .map(|(i, t)| at(i, t))
        .collect();
    curve.extend(points.last());
    curve
}

/// Cubic Hermite curve from zero to `step` with these slopes at its ends.
fn hermite(step: Vector2<f32>, start: Vector2<f32>, end: Vector2<f32>, t: f32) -> Vector2<f32> {
    let (t2, t3) = (t * t, t * t * t);
    step * (3.0 * t2 - 2.0 * t3) + start * (t3 - 2.0 * t2 + t) + end * (t3 - t2)
}

/// Polyline with all corners but the first and last rounded.
pub(crate) fn rounded(points: &[(f32, f32)], radius: f32) -> Profile {
    let points = polyline(points);
    let mut curve = vec![points[0]];
    for triple in points.windows(3) {
        curve.extend(rounded_corner(triple[0], triple[1], triple[2], radius));
    }
    curve.extend(points.last());
    curve.dedup();
    curve
}

/// Closed outline with all corners rounded.
pub(crate) fn rounded_outline(points: &[(f32, f32)], radius: f32) -> Profile {
    let points = polyline(points);
    let n = points.len();
    let corner = |i| {
        rounded_corner(
            points[(i + n - 1) % n],
            points[i],
            points[(i + 1) % n],
            radius,
        )
    };
    let mut outline: Profile = (0..n).flat_map(corner).collect();
    outline.dedup();
    outline
}

fn rounded_corner(
    before: Point2<f32>,
    at: Point2<f32>,
    after: Point2<f32>,
    radius: f32,
) -> impl Iterator<Item = Point2<f32>> {
    let (back, ahead) = (before - at, after - at);
    let reach = radius.min(back.norm() * 0.48).min(ahead.norm() * 0.48);
    let (start, end) = (back.normalize() * reach, ahead.normalize() * reach);
    let n = if reach < 1e-5 { 1 } else { 4 };
    (0..=n).map(move |k| {
        let t = k as f32 / n as f32;
        at + start * ((1.0 - t) * (1.0 - t)) + end * (t * t)
    })
}

/// Subdivided polyline, for painting and bending.
pub(crate) fn subdivided(profile: &[Point2<f32>], step_m: f32) -> Profile {
    let mut fine = vec![profile[0]];
    for pair in profile.windows(2) {
        let n = ((pair[1] - pair[0]).norm() / step_m).ceil().max(1.0) as usize;
        fine.extend((1..=n).map(|k| pair[0] + (pair[1] - pair[0]) * (k as f32 / n as f32)));
    }
    fine
}

/// Greatest radius of a profile at a height; 0 beyond its ends.
pub(crate) fn radius_at(profile: &[Point2<f32>], height: f32) -> f32 {
    let crossing = |pair: &[Point2<f32>]| {
        let share = (height - pair[0].y) / (pair[1].y - pair[0].y);
        (0.0..=1.0)
            .contains(&share)
            .then(|| pair[0].x + (pair[1].x - pair[0].x) * share)
    };
    profile.windows(2).filter_map(crossing).fold(0.0, f32::max)
}

/// Hollow shell below an outer profile that runs from the axis to the rim: adds the inner side,
/// down to a flat floor and the axis, and rounds the rim.
pub(crate) fn shell(outer: &[Point2<f32>], wall_m: f32, floor_m: f32) -> Profile {
    let n = outer.len();
    let mut profile = outer.to_vec();
    let rim = outer[n - 1];
    let mut inner: Profile = (1..n)
        .map(|i| {
            let along = outer[(i + 1).min(n - 1)] - outer[i - 1];
            outer[i] + Vector2::new(-along.y, along.x).normalize() * wall_m
        })
        .filter(|p| p.y > floor_m + 0.3 * wall_m && p.x > wall_m)
        .collect();
    if let Some(last) = inner.last_mut() {
        last.y = last.y.max(rim.y - wall_m);
        profile.push(nalgebra::center(&rim, last) + Vector2::new(0.0, 0.35 * wall_m));
    }
    profile.extend(inner.iter().rev());
    if let Some(lowest) = inner.first() {
        profile.push(Point2::new(
            (lowest.x - 0.5 * wall_m).max(wall_m * 0.5),
            floor_m,
        ));
    }
    profile.push(Point2::new(0.0, floor_m));
    profile
}

/// Profile curve of an ellipse around the origin.
pub(crate) fn ellipse(half_x: f32, half_y: f32, n: usize) -> Profile {
    (0..n)
        .map(|k| (k as f32 / n as f32 * TAU).sin_cos())
        .map(|(sin, cos)| Point2::new(half_x * cos, half_y * sin))
        .collect()
}

/// Body of revolution of a profile.
pub(crate) fn lathed(profile: &[Point2<f32>]) -> Solid {
    lathe(&subdivided(profile, STEP_M), n_around(profile))
}

/// Body of revolution with enough points for a printed label.
pub(crate) fn lathed_for_print(profile: &[Point2<f32>]) -> Solid {
    lathe(&subdivided(profile, PRINT_STEP_M), 48)
}

/// Number of segments around a body of revolution, by its greatest radius.
fn n_around(profile: &[Point2<f32>]) -> usize {
    let radius = profile.iter().map(|p| p.x).fold(0.0, f32::max);
    (12.0 + 560.0 * radius).min(40.0) as usize
}

/// Cylinder that stands on z = 0, with rounded edges.
pub(crate) fn cylinder(radius: f32, height: f32, edge: f32) -> Solid {
    let points = [(0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height)];
    lathed(&rounded(&points, edge))
}
