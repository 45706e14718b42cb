//! Profiles (radius, height) and outlines (x, y), metres.

use mesh::{Solid, lathe};
use nalgebra::{Point2, Vector2};
use std::f32::consts::TAU;

/// Points in a plane, in order.
pub(crate) type Profile = Vec<Point2<f32>>;

/// Distance of points on a body of revolution, metres.
const STEP_M: f32 = 0.009;
/// The same where something is printed.
const PRINT_STEP_M: f32 = 0.0045;

/// Straight lines between points.
pub(crate) fn corners(points: &[(f32, f32)]) -> Profile {
    points.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

/// A smooth curve through points (Catmull and Rom 1974), `n` steps each.
pub(crate) fn spline(points: &[(f32, f32)], n: usize) -> Profile {
    let points = corners(points);
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

/// From zero to `step` with these slopes at the ends.
fn hermite(step: Vector2<f32>, start: Vector2<f32>, end: Vector2<f32>, t: f32) -> Vector2<f32> {
    let (t2, t3) = (t * t, t * t * t);
    step * (3.0 * t2 - 2.0 * t3) + start * (t3 - 2.0 * t2 + t) + end * (t3 - t2)
}

/// Straight lines with all corners but the first and last rounded.
pub(crate) fn rounded(points: &[(f32, f32)], radius: f32) -> Profile {
    let points = corners(points);
    let mut curve = vec![points[0]];
    for triple in points.windows(3) {
        curve.extend(rounded_corner(triple[0], triple[1], triple[2], radius));
    }
    curve.extend(points.last());
    curve.dedup();
    curve
}

/// A closed outline with all corners rounded.
pub(crate) fn rounded_outline(points: &[(f32, f32)], radius: f32) -> Profile {
    let points = corners(points);
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

/// The same line with more points, so that it can be painted or bent.
pub(crate) fn divided(profile: &[Point2<f32>], step_m: f32) -> Profile {
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

/// A wall below an outer profile that runs from the axis to the rim: its inner
/// side is added, down to a flat floor and the axis. The rim is rounded.
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

/// A circle or ellipse around the origin.
pub(crate) fn oval(half_x: f32, half_y: f32, n: usize) -> Profile {
    (0..n)
        .map(|k| (k as f32 / n as f32 * TAU).sin_cos())
        .map(|(sin, cos)| Point2::new(half_x * cos, half_y * sin))
        .collect()
}

/// A body of revolution.
pub(crate) fn turned(profile: &[Point2<f32>]) -> Solid {
    lathe(&divided(profile, STEP_M), n_around(profile))
}

/// A body of revolution with points enough for print.
pub(crate) fn printed(profile: &[Point2<f32>]) -> Solid {
    lathe(&divided(profile, PRINT_STEP_M), 48)
}

/// Segments around: more for what is thick.
fn n_around(profile: &[Point2<f32>]) -> usize {
    let radius = profile.iter().map(|p| p.x).fold(0.0, f32::max);
    (12.0 + 560.0 * radius).min(40.0) as usize
}

/// A plain cylinder that stands on z = 0, its edges rounded.
pub(crate) fn cylinder(radius: f32, height: f32, edge: f32) -> Solid {
    let points = [(0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height)];
    turned(&rounded(&points, edge))
}
