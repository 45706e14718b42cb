//! Depth image without gaps: depth that was not measured, estimated from its surroundings.

use point_cloud::Point;

/// Depth of every pixel, row-major, metres. What was not measured of an object lies at the root
/// mean square depth of its other pixels, so that its area is scaled up by their number; what was
/// not measured elsewhere lies at the farther of the nearest measured pixels of its row beside it,
/// since a structured-light camera misses what a nearer surface shadows. Infinite where nothing
/// tells it.
pub(super) fn filled(points: &[Point], mask: &[u16], width: usize) -> Vec<f32> {
    let of_objects = object_depths_m(points, mask);
    let mut filled = Vec::with_capacity(points.len());
    for (points, mask) in points.chunks(width.max(1)).zip(mask.chunks(width.max(1))) {
        let surroundings = row_depths_m(points, mask);
        filled.extend((0..points.len()).map(|column| match points[column].z {
            z if z.is_finite() => z,
            _ if mask[column] == 0 => surroundings[column],
            _ => of_objects[usize::from(mask[column])],
        }));
    }
    filled
}

/// Root mean square depth of each object by its number, metres.
fn object_depths_m(points: &[Point], mask: &[u16]) -> Vec<f32> {
    let n = mask.iter().copied().max().map_or(0, usize::from) + 1;
    let mut sums = vec![(0.0_f64, 0.0_f64); n];
    for (point, &id) in points
        .iter()
        .zip(mask)
        .filter(|(point, _)| point.is_finite())
    {
        let (sum, n) = &mut sums[usize::from(id)];
        *sum += f64::from(point.z).powi(2);
        *n += 1.0;
    }
    let depth = |(sum, n): (f64, f64)| (n > 0.0).then(|| (sum / n).sqrt() as f32);
    let depths = sums.into_iter().map(depth);
    depths
        .map(|depth_m| depth_m.unwrap_or(f32::INFINITY))
        .collect()
}

/// Farther depth of the nearest measured pixels without an object, on both sides of each pixel of
/// a row, metres.
fn row_depths_m(points: &[Point], mask: &[u16]) -> Vec<f32> {
    let mut depths_m = vec![f32::NEG_INFINITY; points.len()];
    let mut visit = |columns: &mut dyn Iterator<Item = usize>| {
        let mut last_m = f32::NEG_INFINITY;
        for column in columns {
            if mask[column] == 0 && points[column].is_finite() {
                last_m = points[column].z;
            }
            depths_m[column] = depths_m[column].max(last_m);
        }
    };
    visit(&mut (0..points.len()));
    visit(&mut (0..points.len()).rev());
    let known = |depth_m: f32| {
        if depth_m > 0.0 {
            depth_m
        } else {
            f32::INFINITY
        }
    };
    depths_m.into_iter().map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    fn points(depths_m: &[f32]) -> Vec<Point> {
        let point = |&z: &f32| Point {
            x: 0.1 * z,
            y: 0.0,
            z,
            color: Rgba::default(),
        };
        depths_m.iter().map(point).collect()
    }

    #[test]
    fn gaps_are_filled_by_the_object_or_by_the_farther_side() {
        let gap = f32::NAN;
        // Background, object 2 with a gap, its shadow, background; then a row of gaps.
        let seen = points(&[
            1.5, gap, 0.6, gap, 0.8, gap, gap, 1.2, gap, gap, gap, gap, gap, gap, gap, gap,
        ]);
        let mask = [0, 0, 2, 2, 2, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0];
        let filled = filled(&seen, &mask, 8);
        // Root of the mean of 0.36 and 0.64.
        let object_m = 0.5_f32.sqrt();
        let row = [1.5, 1.5, 0.6, object_m, 0.8, 1.5, 1.5, 1.2];
        for (found, expected) in filled.iter().zip(row) {
            assert!((found - expected).abs() < 1e-6, "{filled:?}");
        }
        // Nothing tells the second row, but for the second object.
        assert!((filled[11] - object_m).abs() < 1e-6);
        let others = (8..16).filter(|pixel| *pixel != 11);
        assert!(
            others
                .into_iter()
                .all(|pixel| filled[pixel] == f32::INFINITY),
            "{filled:?}"
        );
    }

    #[test]
    fn image_without_gaps_stays_as_it_is() {
        let seen = points(&[1.0, 1.1, 0.9, 1.3]);
        assert_eq!(filled(&seen, &[0, 1, 1, 0], 2), [1.0, 1.1, 0.9, 1.3]);
    }
}
