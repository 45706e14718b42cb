//! Perturbations of a picture that must not matter: depth noise drawn anew, and a shift of the image
//! against the grid of the subsampling.

use point_cloud::Point;
use random::Random;
use sensor_noise::DepthNoise;

/// Number of shifts along a row before the next row of shifts.
const N_SHIFTS_IN_ROW: usize = 6;

/// Draws the depth of all points anew along their rays, by the noise law of a Kinect.
pub(super) fn add_noise(points: &[Point], random: &mut Random, noisy: &mut [Point]) {
    for (point, noisy) in points.iter().zip(noisy) {
        *noisy = *point;
        if point.is_finite() && point.z > 0.0 {
            let sigma_m = DepthNoise::KINECT_V1.sigma_m(point.z);
            let scale = 1.0 + sigma_m * random.normal_f32() / point.z;
            [noisy.x, noisy.y, noisy.z] = [scale * point.x, scale * point.y, scale * point.z];
        }
    }
}

/// Shifts an image by a few columns and rows, another number for each `shift`; what enters it has
/// the value `outside`.
pub(super) fn shifted<T: Copy>(image: &[T], width: usize, shift: usize, outside: T) -> Vec<T> {
    let (columns, rows) = (shift % N_SHIFTS_IN_ROW, shift / N_SHIFTS_IN_ROW);
    let at = |pixel: usize| {
        let source = pixel + rows * width + columns;
        let is_inside = pixel % width + columns < width;
        image.get(source).copied().filter(|_| is_inside)
    };
    (0..image.len())
        .map(|pixel| at(pixel).unwrap_or(outside))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    #[test]
    fn shifted_images_move_by_columns_and_rows() {
        let image: Vec<usize> = (0..12).collect();
        assert_eq!(shifted(&image, 4, 0, 99), image);
        let by_one = [1, 2, 3, 99, 5, 6, 7, 99, 9, 10, 11, 99];
        assert_eq!(shifted(&image, 4, 1, 99), by_one);
        let by_row = [4, 5, 6, 7, 8, 9, 10, 11, 99, 99, 99, 99];
        assert_eq!(shifted(&image, 4, N_SHIFTS_IN_ROW, 99), by_row);
    }

    #[test]
    fn noise_moves_points_along_their_rays_by_the_law() {
        let point = Point {
            x: 0.2,
            y: -0.1,
            z: 1.0,
            color: Rgba::opaque(0, 0, 0),
        };
        let (clean, mut noisy) = (vec![point; 10_000], vec![point; 10_000]);
        add_noise(&clean, &mut Random::from_seed(1), &mut noisy);
        let on_ray = |p: &Point| (p.x - 0.2 * p.z).abs() < 1e-6 && (p.y + 0.1 * p.z).abs() < 1e-6;
        assert!(noisy.iter().all(on_ray));
        let variance = noisy.iter().map(|p| (p.z - 1.0).powi(2)).sum::<f32>() / 10_000.0;
        let ratio = variance.sqrt() / DepthNoise::KINECT_V1.sigma_m(1.0);
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }
}
