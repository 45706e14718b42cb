//! Object frame of the published GOOD implementation.

use crate::symmetric_eigen::{Matrix, symmetric_eigen};
use crate::{DescriptorFrame, ObjectPoints};
use point_cloud::Point;

/// Principal axes as the published program computes them: x along the largest variance,
/// y along the middle one, signs as returned by its eigen solver, origin at the
/// centroid.
///
/// Sums are sequential and in single precision, in the order of the points, because
/// their rounding decides the bins. The signs change when the object turns: for anything
/// but reproducing published numbers use [`AppearanceDescriptor`](crate::AppearanceDescriptor).
///
/// Returns `None` when no point is finite or the sums overflow.
///
/// *Source*: Kasaei, Lopes, Tomé, Seabra Lopes, "GOOD: a global orthographic object
/// descriptor", 2016, and its implementation.
pub fn reference_frame(points: ObjectPoints<'_>) -> Option<DescriptorFrame> {
    let (centroid, n) = centroid(points)?;
    let eigen = symmetric_eigen(&covariance(points, centroid, n))?;
    let x = cross(eigen.vectors[0], eigen.vectors[1]);
    let y = eigen.vectors[1];
    let z = cross(x, y);
    let row = |axis: [f32; 3]| [axis[0], axis[1], axis[2], -dot(axis, centroid)];
    Some(DescriptorFrame {
        object_from_source: [row(x), row(y), row(z)],
    })
}

/// Centroid and number of the finite points.
fn centroid(points: ObjectPoints<'_>) -> Option<([f32; 3], f32)> {
    let mut sum = [0.0_f32; 3];
    let mut n = 0_usize;
    for_each_finite(points, |[x, y, z]| {
        sum = [sum[0] + x, sum[1] + y, sum[2] + z];
        n += 1;
    });
    (n > 0).then(|| (sum.map(|s| s / n as f32), n as f32))
}

/// Population covariance about the centroid.
fn covariance(points: ObjectPoints<'_>, c: [f32; 3], n: f32) -> Matrix {
    let mut sums = [0.0_f32; 6];
    for_each_finite(points, |p| {
        let [x, y, z] = [p[0] - c[0], p[1] - c[1], p[2] - c[2]];
        for (sum, product) in sums
            .iter_mut()
            .zip([x * x, y * x, z * x, y * y, y * z, z * z])
        {
            *sum += product;
        }
    });
    let [xx, xy, xz, yy, yz, zz] = sums.map(|s| s / n);
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

#[inline]
fn for_each_finite(points: ObjectPoints<'_>, mut visit: impl FnMut([f32; 3])) {
    points.for_each(|p: &Point| {
        if p.is_finite() {
            visit([p.x, p.y, p.z]);
        }
    });
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Dot product in the order of the reference's additions.
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + (a[1] * b[1] + a[2] * b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_without_finite_coordinates_have_no_frame() {
        assert_eq!(reference_frame(ObjectPoints::all(&[])), None);
        let hole = [Point::without_depth(point_cloud::Rgba(0)); 4];
        assert_eq!(reference_frame(ObjectPoints::all(&hole)), None);
        let huge = [Point {
            x: f32::MAX,
            ..Point::default()
        }; 4];
        assert_eq!(reference_frame(ObjectPoints::all(&huge)), None);
    }

    #[test]
    fn points_without_depth_do_not_move_the_frame() {
        let mut cloud: Vec<Point> = (0..300_u16)
            .map(|i| {
                let t = f32::from(i);
                Point {
                    x: (t * 0.7).sin(),
                    y: 0.3 * (t * 1.9).cos(),
                    z: 0.1 * t.sin(),
                    ..Point::default()
                }
            })
            .collect();
        let whole = reference_frame(ObjectPoints::all(&cloud)).unwrap();
        cloud.insert(100, Point::without_depth(point_cloud::Rgba(0)));
        assert_eq!(reference_frame(ObjectPoints::all(&cloud)), Some(whole));
    }
}
