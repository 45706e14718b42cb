//! Good continuation of two regions that an occluder may divide (Wertheimer 1923): parts of one
//! body have the same cross section, in the same place.
//!
//! Colour says little: a printed box seldom looks the same at both ends.

use super::region::Region;
use sensor_noise::DepthNoise;

/// Greatest difference between the greatest heights of both parts, metres. Chosen.
const TOP_STEP_MAX_M: f32 = 0.012;

/// Greatest distance of the middle of a part from the plane of the other one, metres. Chosen.
const PLANE_DISTANCE_MAX_M: f32 = 0.012;

/// Least cosine of the angle between the planes of both parts (20 degrees). Chosen.
const PARALLEL_COS_MIN: f32 = 0.94;

/// Greatest colour difference of both parts, CIE 1976. Chosen.
const COLOR_DISTANCE_MAX: f32 = 40.0;

/// Tolerance of lengths, in sigmas of the depth noise. Chosen.
const NOISE_SIGMAS: f32 = 2.0;

/// Greatest longest side of the common box, metres: that of most things on a table. Chosen.
const SIDE_MAX_M: f32 = 0.45;

/// Greatest difference between the widths of a part and of both, metres. Chosen.
const WIDTH_DIFFERENCE_MAX_M: f32 = 0.02;

/// True if two regions have one height, plane and, roughly, colour.
pub(super) fn are_alike(a: &Region, b: &Region, noise: &DepthNoise) -> bool {
    let tolerance_m = NOISE_SIGMAS * noise.sigma_m(a.depth_m.max(b.depth_m));
    let top_step_m = (a.height_m[1] - b.height_m[1]).abs();
    let distance_m = |from: &Region, to: &Region| (from.centroid - to.centroid).dot(&to.normal);
    let plane_m = distance_m(a, b).abs().min(distance_m(b, a).abs());
    top_step_m <= TOP_STEP_MAX_M + tolerance_m
        && plane_m <= PLANE_DISTANCE_MAX_M + tolerance_m
        && a.normal.dot(&b.normal).abs() >= PARALLEL_COS_MIN
        && a.color.delta_e(&b.color) <= COLOR_DISTANCE_MAX
}

/// True if two regions lie one after the other in a body that is no larger than things on a table:
/// their footprints and that of `both` together have a side in common, and the other sides add up.
pub(super) fn are_in_a_row(a: &Region, b: &Region, both: &Region) -> bool {
    if both.sides_m.into_iter().any(|side_m| side_m > SIDE_MAX_M) {
        return false;
    }
    let sides = |region: &Region| [region.sides_m[0], region.sides_m[1]];
    let across = |region: &Region, width_m: f32| {
        let [one, other] = sides(region);
        let [width, length] = if (one - width_m).abs() <= (other - width_m).abs() {
            [one, other]
        } else {
            [other, one]
        };
        ((width - width_m).abs() <= WIDTH_DIFFERENCE_MAX_M).then_some(length)
    };
    let [one, other] = sides(both);
    [[one, other], [other, one]]
        .iter()
        .any(|&[width_m, length_m]| {
            let lengths = across(a, width_m).zip(across(b, width_m));
            lengths.is_some_and(|(of_a, of_b)| of_a + of_b <= length_m + WIDTH_DIFFERENCE_MAX_M)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// Region of a box of a width and a length, from a place along x on.
    fn part(x_m: f32, [width_m, length_m]: [f32; 2]) -> Region {
        Region {
            n_pixels_at_1m: 2000.0,
            centroid: Vector3::new(x_m + 0.5 * length_m, 0.0, 0.05),
            normal: Vector3::y(),
            depth_m: 0.9,
            height_m: [0.005, 0.08],
            sides_m: [width_m, length_m, 0.075],
            ..Region::default()
        }
    }

    #[test]
    fn parts_of_one_height_and_plane_are_alike() {
        let (a, noise) = (part(0.0, [0.1, 0.05]), DepthNoise::KINECT_V1);
        let b = part(0.12, [0.1, 0.06]);
        assert!(are_alike(&a, &b, &noise));
        let lower = Region {
            height_m: [0.005, 0.05],
            ..b
        };
        assert!(!are_alike(&a, &lower, &noise));
        let behind = Region {
            centroid: b.centroid + Vector3::y() * 0.05,
            ..b
        };
        assert!(!are_alike(&a, &behind, &noise));
        let oblique = Region {
            normal: Vector3::new(0.6, 0.8, 0.0),
            ..b
        };
        assert!(!are_alike(&a, &oblique, &noise));
    }

    #[test]
    fn parts_in_a_row_have_one_width() {
        let a = part(0.0, [0.1, 0.05]);
        let is_row = |b: &Region, both: [f32; 2]| are_in_a_row(&a, b, &part(0.0, both));
        assert!(is_row(&part(0.12, [0.1, 0.06]), [0.1, 0.18]));
        // The order of the sides is that of their yaw.
        assert!(is_row(&part(0.12, [0.06, 0.1]), [0.18, 0.1]));
        // Shifted sideways, another width, larger than things on a table.
        assert!(!is_row(&part(0.12, [0.1, 0.06]), [0.15, 0.18]));
        assert!(!is_row(&part(0.12, [0.05, 0.04]), [0.1, 0.18]));
        assert!(!is_row(&part(0.4, [0.1, 0.1]), [0.1, 0.5]));
    }
}
