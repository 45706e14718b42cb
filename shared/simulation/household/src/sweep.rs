//! Sweeps along space curves: rods, handles and tubes, metres.

use crate::profile::radius_at;
use mesh::{Solid, TubeSection, rounded_tube, tube};
use nalgebra::{Point2, Point3, Vector3};

/// Number of steps per spline segment.
const N_STEPS: usize = 6;
/// Number of sides of a section: fewer for wire.
fn n_sides(radius: f32) -> usize {
    match radius {
        r if r < 0.002 => 8,
        r if r < 0.006 => 10,
        _ => 14,
    }
}

/// Catmull–Rom spline through points in space.
pub(crate) fn spline(points: &[[f32; 3]]) -> Vec<Point3<f32>> {
    let last = points.len().saturating_sub(1);
    let point = |i: usize| Vector3::from(points[i.min(last)]);
    let at = |i: usize, t: f32| {
        let (p0, p1, p2, p3) = (
            point(i.saturating_sub(1)),
            point(i),
            point(i + 1),
            point(i + 2),
        );
        let (t2, t3) = (t * t, t * t * t);
        let ends = p1 * (2.0 * t3 - 3.0 * t2 + 1.0) + p2 * (3.0 * t2 - 2.0 * t3);
        ends + (p2 - p0) * (0.5 * (t3 - 2.0 * t2 + t)) + (p3 - p1) * (0.5 * (t3 - t2))
    };
    let mut curve: Vec<Point3<f32>> = (0..last)
        .flat_map(|i| (0..N_STEPS).map(move |k| (i, k as f32 / N_STEPS as f32)))
        .map(|(i, t)| at(i, t).into())
        .collect();
    curve.extend(points.last().map(|p| Point3::from(*p)));
    curve
}

/// Smooth interpolation between evenly spaced values; `t` from 0 to 1.
pub(crate) fn interpolate(values: &[f32], t: f32) -> f32 {
    let last = values.len().saturating_sub(1);
    let x = t.clamp(0.0, 1.0) * last as f32;
    let i = (x as usize).min(last.saturating_sub(1));
    let share = x - i as f32;
    let share = share * share * (3.0 - 2.0 * share);
    values[i] + (values[(i + 1).min(last)] - values[i]) * share
}

/// Sweep of an elliptic section along a curve, with rounded ends: `section` gives half its width
/// and half its height (along `up`) from start 0 to end 1.
pub(crate) fn swept(
    points: &[[f32; 3]],
    up: Vector3<f32>,
    section: impl Fn(f32) -> (f32, f32),
) -> Solid {
    let curve = spline(points);
    let last = curve.len().saturating_sub(1).max(1) as f32;
    let sections: Vec<TubeSection> = curve
        .into_iter()
        .enumerate()
        .map(|(i, centre)| {
            let (half_width, half_height) = section(i as f32 / last);
            TubeSection {
                centre,
                half_width,
                half_height,
            }
        })
        .collect();
    let radius = sections.iter().map(|s| s.half_width.max(s.half_height));
    let n_sides = n_sides(radius.fold(0.0, f32::max));
    rounded_tube(&sections, up, n_sides)
}

/// Round rod along a curve.
pub(crate) fn rod(points: &[[f32; 3]], radius: f32) -> Solid {
    let up = if points.iter().all(|p| p[1] == points[0][1]) {
        Vector3::y()
    } else {
        Vector3::z()
    };
    swept(points, up, |_| (radius, radius))
}

/// Handle of a vessel in the xz plane, attached to the wall below a profile between two heights,
/// top first, extending by `reach`. `thickness` is the size in side view, `breadth` in front
/// view.
pub(crate) fn vessel_handle(
    outer: &[Point2<f32>],
    (top, bottom): (f32, f32),
    reach: f32,
    thickness: f32,
    breadth: f32,
) -> Solid {
    // The flat ends are hidden in the wall.
    let root = |height| radius_at(outer, height) - 0.0015;
    let (r_top, r_bottom) = (root(top), root(bottom));
    let height = top - bottom;
    let out = r_top.max(r_bottom) + reach;
    let points = [
        [r_top, 0.0, top],
        [r_top + 0.6 * (out - r_top), 0.0, top + 0.04 * height],
        [out, 0.0, top - 0.3 * height],
        [out - 0.12 * reach, 0.0, bottom + 0.3 * height],
        [r_bottom + 0.5 * reach, 0.0, bottom + 0.05 * height],
        [r_bottom, 0.0, bottom],
    ];
    let sections: Vec<TubeSection> = spline(&points)
        .into_iter()
        .map(|centre| TubeSection {
            centre,
            half_width: thickness / 2.0,
            half_height: breadth / 2.0,
        })
        .collect();
    tube(&sections, Vector3::y(), n_sides(breadth))
}

/// Rotates a solid that stands along z so that it lies along x.
pub(crate) fn lying(solid: Solid) -> Solid {
    solid.rotated(Vector3::y(), std::f32::consts::FRAC_PI_2)
}

/// Stable resting pose: tilts a solid about y so that it rests on the two lowest points of its
/// parts on either side of its centre of mass. An object with one thick end lies at an angle.
pub(crate) fn resting_on_two_points(solid: Solid) -> Solid {
    let middle = middle_along_x(&solid);
    let points = || solid.convex_parts.iter().flat_map(|part| &part.points);
    let pairs = points()
        .filter(|p| p.x < middle)
        .flat_map(|p| points().filter(|q| q.x > middle).map(move |q| (p, q)));
    // Of all lines between points behind and ahead of the middle, the one that passes the middle
    // lowest has no point below it.
    let slope_and_height = pairs.map(|(p, q)| {
        let slope = (q.z - p.z) / (q.x - p.x);
        (slope, p.z + slope * (middle - p.x))
    });
    let lowest = slope_and_height.min_by(|a, b| a.1.total_cmp(&b.1));
    let slope = lowest.map_or(0.0, |(slope, _)| slope);
    solid.rotated(Vector3::y(), slope.atan())
}

/// x coordinate of the centre of mass.
fn middle_along_x(solid: &Solid) -> f32 {
    let at = |i: u32| solid.mesh.vertices[i as usize].position.coords;
    let (mut volume, mut moment) = (0.0, 0.0);
    for triangle in &solid.mesh.triangles {
        let [a, b, c] = triangle.vertices.map(at);
        let part = a.dot(&b.cross(&c));
        volume += part;
        moment += part * (a.x + b.x + c.x) / 4.0;
    }
    moment / volume
}
