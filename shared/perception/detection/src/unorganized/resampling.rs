//! Resampling of depth to pixel centres.

use point_cloud::Point;

/// Greatest depth step between neighbours on one surface, metres at 1 m; grows with squared
/// depth. Chosen.
const STEP_M: f32 = 0.012;

/// Least distance of neighbours for a slope, pixels. Chosen.
const APART_PX: f32 = 0.7;

/// Pixel centres of an image: tangents of the first column and row, and the pitch of
/// columns and rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelCentres {
    pub(super) first: [f32; 2],
    pub(super) pitch: [f32; 2],
}

impl PixelCentres {
    fn of(&self, column: usize, row: usize) -> [f32; 2] {
        [
            self.first[0] + self.pitch[0] * column as f32,
            self.first[1] + self.pitch[1] * row as f32,
        ]
    }
}

/// Move the points of an image along their surface to the viewing rays of their pixels'
/// centres, which removes the jaggedness of off-centre points. `depths` is a buffer.
pub(super) fn resample(
    image: &mut [Point],
    width: usize,
    centres: &PixelCentres,
    depths: &mut Vec<f32>,
) {
    depths.clear();
    depths.extend((0..image.len()).map(|pixel| {
        let (column, row) = (pixel % width, pixel / width);
        let centre = centres.of(column, row);
        let n_rows = image.len() / width;
        let slopes = [
            slope(image, pixel, [column, width], 1, centres.pitch[0], |p| {
                p.x / p.z
            }),
            slope(image, pixel, [row, n_rows], width, centres.pitch[1], |p| {
                p.y / p.z
            }),
        ];
        let point = &image[pixel];
        let (u, v) = (point.x / point.z, point.y / point.z);
        point.z + slopes[0] * (centre[0] - u) + slopes[1] * (centre[1] - v)
    }));
    for (pixel, (point, &depth_m)) in image.iter_mut().zip(depths.iter()).enumerate() {
        let [u, v] = centres.of(pixel % width, pixel / width);
        (point.x, point.y, point.z) = (u * depth_m, v * depth_m, depth_m);
    }
}

/// Slope of depth over the tangent along an image line, from the neighbours on the same
/// surface; 0 without any. `at` is the pixel's position in the line and the line's length,
/// `stride` leads to the next pixel.
fn slope(
    image: &[Point],
    pixel: usize,
    [at, length]: [usize; 2],
    stride: usize,
    pitch: f32,
    tangent: impl Fn(&Point) -> f32,
) -> f32 {
    let own = &image[pixel];
    let step_max = STEP_M * own.z * own.z;
    let on_surface = |near: &&Point| (near.z - own.z).abs() <= step_max;
    let before = (1..=at.min(2)).map(|step| &image[pixel - step * stride]);
    let after = (1..=(length - 1 - at).min(2)).map(|step| &image[pixel + step * stride]);
    let low = before.into_iter().find(on_surface).unwrap_or(own);
    let high = after.into_iter().find(on_surface).unwrap_or(own);
    let apart = tangent(high) - tangent(low);
    if apart >= APART_PX * pitch {
        (high.z - low.z) / apart
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;
    use proptest::prelude::*;

    const WIDTH: usize = 20;

    proptest! {
        #[test]
        fn resampling_moves_points_along_their_plane_to_the_centres(
            offsets in prop::collection::vec((-0.4..0.4_f32, -0.4..0.4_f32), WIDTH * 12),
            tilt in prop::array::uniform2(-1.0..1.0_f32),
            holes in prop::collection::vec(prop::bool::weighted(0.1), WIDTH * 12),
        ) {
            let centres = PixelCentres { first: [-0.02, 0.01], pitch: [0.002, 0.002] };
            let on_plane = |[u, v]: [f32; 2]| {
                let z = 1.0 / (1.0 - tilt[0] * u - tilt[1] * v);
                Point { x: u * z, y: v * z, z, color: Rgba::default() }
            };
            let mut image: Vec<Point> = (0..offsets.len())
                .map(|i| {
                    let [u, v] = centres.of(i % WIDTH, i / WIDTH);
                    on_plane([u + 0.002 * offsets[i].0, v + 0.002 * offsets[i].1])
                })
                .collect();
            for (point, _) in image.iter_mut().zip(&holes).filter(|(_, hole)| **hole) {
                *point = Point::without_depth(Rgba::default());
            }
            let errors = |image: &[Point]| -> f32 {
                let expected = |i: usize| on_plane(centres.of(i % WIDTH, i / WIDTH));
                let error = |i: usize| (image[i].z - expected(i).z).abs();
                (0..image.len()).filter(|&i| !holes[i]).map(error).sum()
            };
            let before = errors(&image);
            resample(&mut image, WIDTH, &centres, &mut Vec::new());
            prop_assert!(errors(&image) <= 0.6 * before + 1e-4);
            for (i, point) in image.iter().enumerate() {
                prop_assert_eq!(point.z.is_nan(), holes[i]);
                let [u, v] = centres.of(i % WIDTH, i / WIDTH);
                let off = (point.x / point.z - u).abs().max((point.y / point.z - v).abs());
                prop_assert!(holes[i] || off < 1e-6);
            }
        }
    }
}
