//! Polygon triangulation by ear clipping.

use nalgebra::Point2;

/// Maximum number of edge-flip passes over all pairs of triangles.
const N_FLIP_PASSES: usize = 12;

/// Orientation test: twice the signed area of a triangle, positive for counter-clockwise.
pub(crate) fn orient2d(a: Point2<f32>, b: Point2<f32>, c: Point2<f32>) -> f32 {
    (b - a).perp(&(c - a))
}

/// Twice the signed area of a polygon: positive for counter-clockwise.
pub(crate) fn doubled_signed_area(polygon: &[Point2<f32>]) -> f32 {
    let next = polygon.iter().cycle().skip(1);
    polygon
        .iter()
        .zip(next)
        .map(|(a, b)| a.coords.perp(&b.coords))
        .sum()
}

/// Triangulation of a simple polygon, convex or concave, as corner indices in the polygon's own
/// orientation. Fewer than three corners give no triangles.
///
/// Ear clipping (Meisters 1975), the roundest ear first, O(n³); then edges are
/// flipped as long as triangles become rounder. A polygon that
/// crosses itself still gives n − 2 triangles.
pub fn triangulate(polygon: &[Point2<f32>]) -> Vec<[usize; 3]> {
    let sign = doubled_signed_area(polygon).signum();
    let mut left: Vec<usize> = (0..polygon.len()).collect();
    let mut triangles = Vec::with_capacity(polygon.len());
    while left.len() > 3 {
        let quality = |&k: &usize| ear_quality(polygon, &left, k, sign);
        let ear = (0..left.len())
            .max_by(|a, b| quality(a).total_cmp(&quality(b)))
            .unwrap_or(0);
        triangles.push(corners(&left, ear));
        left.remove(ear);
    }
    if left.len() == 3 {
        triangles.push([left[0], left[1], left[2]]);
    }
    flip_edges(polygon, &mut triangles, sign);
    triangles
}

fn corners(left: &[usize], k: usize) -> [usize; 3] {
    let n = left.len();
    [left[(k + n - 1) % n], left[k], left[(k + 1) % n]]
}

/// Quality of clipping the ear at a corner; not positive for an invalid ear, and lower the
/// worse it is.
fn ear_quality(polygon: &[Point2<f32>], left: &[usize], k: usize, sign: f32) -> f32 {
    let ear = corners(left, k);
    let [a, b, c] = ear.map(|i| polygon[i]);
    let quality = triangle_quality([a, b, c]) * sign;
    if quality < -1e-6 {
        return quality - 3.0;
    }
    // Points on the cut are not allowed; points on the outline are.
    let is_inside = |p: Point2<f32>| {
        orient2d(a, b, p) * sign > 0.0
            && orient2d(b, c, p) * sign > 0.0
            && orient2d(c, a, p) * sign >= 0.0
    };
    match left
        .iter()
        .any(|i| !ear.contains(i) && is_inside(polygon[*i]))
    {
        true => quality - 2.0,
        false if quality < 1e-6 => quality - 1.0,
        false => quality,
    }
}

/// Shape quality of a triangle: twice the signed area over the squared longest side.
fn triangle_quality([a, b, c]: [Point2<f32>; 3]) -> f32 {
    let longest2 = (b - a)
        .norm_squared()
        .max((c - b).norm_squared())
        .max((a - c).norm_squared());
    orient2d(a, b, c) / longest2.max(f32::MIN_POSITIVE)
}

/// Edge flips: replaces the common edge of two triangles where that improves the worse one, so
/// that no degenerate triangle remains.
fn flip_edges(polygon: &[Point2<f32>], triangles: &mut [[usize; 3]], sign: f32) {
    let quality = |t: [usize; 3]| triangle_quality(t.map(|i| polygon[i])) * sign;
    for _ in 0..N_FLIP_PASSES {
        let mut n_flips = 0;
        for i in 1..triangles.len() {
            for k in 0..i {
                let Some((first, second)) = flipped(triangles[i], triangles[k]) else {
                    continue;
                };
                let before = quality(triangles[i]).min(quality(triangles[k]));
                if quality(first).min(quality(second)) > before + 1e-6 {
                    (triangles[i], triangles[k]) = (first, second);
                    n_flips += 1;
                }
            }
        }
        if n_flips == 0 {
            return;
        }
    }
}

/// Triangles after flipping the common edge of two triangles; `None` without a common edge.
fn flipped(a: [usize; 3], b: [usize; 3]) -> Option<([usize; 3], [usize; 3])> {
    let i = (0..3).find(|&i| !b.contains(&a[i]))?;
    let (p, q) = (a[(i + 1) % 3], a[(i + 2) % 3]);
    let k = (0..3).find(|&k| b[k] == q && b[(k + 1) % 3] == p)?;
    let (own, other) = (a[i], b[(k + 2) % 3]);
    Some(([own, p, other], [own, other, q]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_triangles_of_a_star_have_its_area(
            radii in prop::collection::vec(0.3..1.0_f32, 3..40)
        ) {
            let n = radii.len() as f32;
            let at = |(i, r): (usize, &f32)| {
                let (sin, cos) = (i as f32 / n * std::f32::consts::TAU).sin_cos();
                Point2::new(r * cos, r * sin)
            };
            let polygon: Vec<_> = radii.iter().enumerate().map(at).collect();
            let triangles = triangulate(&polygon);
            prop_assert_eq!(triangles.len(), polygon.len() - 2);
            let areas: Vec<f32> = triangles
                .iter()
                .map(|t| orient2d(polygon[t[0]], polygon[t[1]], polygon[t[2]]))
                .collect();
            prop_assert!(areas.iter().all(|area| *area > -1e-6));
            let sum: f32 = areas.iter().sum();
            prop_assert!((sum - doubled_signed_area(&polygon)).abs() < 1e-4);
        }
    }

    #[test]
    fn a_comb_is_cut_and_a_line_is_not() {
        let mut comb = vec![Point2::new(9.0, 2.0), Point2::new(0.0, 2.0)];
        for i in 0..5 {
            let x = i as f32 * 2.0;
            comb.push(Point2::new(x, 0.0));
            comb.push(Point2::new(x + 1.0, 0.0));
            comb.push(Point2::new(x + 1.0, 1.5));
            comb.push(Point2::new(x + 2.0, 1.5));
        }
        comb.truncate(comb.len() - 2);
        let sum: f32 = triangulate(&comb)
            .iter()
            .map(|t| orient2d(comb[t[0]], comb[t[1]], comb[t[2]]))
            .inspect(|area| assert!(*area > 0.0))
            .sum();
        assert!((sum - doubled_signed_area(&comb)).abs() < 1e-4);
        assert!(triangulate(&comb[..2]).is_empty());
    }
}
