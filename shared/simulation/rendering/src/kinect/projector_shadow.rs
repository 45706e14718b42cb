//! Projector shadow: occlusion of the infrared projector.

use super::depth_discontinuity::for_each_pair;
use value_range::{OutOfRange, check_range};

/// Search distance for an occluding surface, pixels. Chosen.
const REACH_PX: usize = 256;

/// Occlusion shadow of the projector, which is offset from the camera.
///
/// A pixel in column u with disparity d is lit through the projector's column u − d. It is in
/// shadow when a surface to its right, of greater disparity, is lit through the same column. The
/// shadow is therefore left of an object and `f·b·(1/z_near − 1/z_far)` pixels wide. It is
/// computed in whole pixels on each row of the exact depth: its borders are correct to one pixel,
/// occluders outside of the image are not known, and slits narrower than a pixel do not transmit
/// light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectorShadow {
    /// Least disparity difference between an occluder and an occluded pixel, pixels; 0.1 to 10.
    pub least_difference_px: f32,
}

impl ProjectorShadow {
    /// Difference of one pixel. Chosen.
    pub const KINECT_V1: Self = Self {
        least_difference_px: 1.0,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range(
            "projector_shadow.least_difference_px",
            self.least_difference_px,
            0.1,
            10.0,
        )
    }

    /// Clears the occluded pixels of one row: `disparity` is exact, 0 in empty pixels; `seen`
    /// becomes 0 in the shadow.
    pub(super) fn cast(&self, disparity: &[f32], seen: &mut [f32]) {
        let is_step = |left: f32, right: f32| right - left >= self.least_difference_px;
        for_each_pair(disparity, &disparity[1..], is_step, |i| {
            self.cast_left_of(i + 1, disparity, seen);
        });
    }

    /// Clears the shadow of the surface whose left end is at `near`.
    fn cast_left_of(&self, near: usize, disparity: &[f32], seen: &mut [f32]) {
        let through = |u: usize| u as f32 - disparity[u];
        let first = through(near);
        let mut blocker = last_blocker(near, disparity, through(near - 1));
        for u in (near.saturating_sub(REACH_PX)..near).rev() {
            let column = through(u);
            if column <= first {
                // Farther left, the light passes in front of the surface, unless something nearer
                // interrupts the background here.
                if disparity[u] + self.least_difference_px <= disparity[near] {
                    return;
                }
                continue;
            }
            while blocker > near && through(blocker) > column {
                blocker -= 1;
            }
            let next = (blocker + 1).min(disparity.len() - 1);
            let is_slit = disparity[blocker] - disparity[next] >= self.least_difference_px
                && through(blocker) + 1.0 < column;
            if !is_slit && disparity[blocker] - disparity[u] >= self.least_difference_px {
                seen[u] = 0.0;
            }
        }
    }
}

/// Last column from `near` on whose surface occludes light up to the projector's `column`.
fn last_blocker(near: usize, disparity: &[f32], column: f32) -> usize {
    let end = disparity.len().min(near + REACH_PX);
    (near..end)
        .take_while(|&u| u as f32 - disparity[u] <= column)
        .last()
        .unwrap_or(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Brute-force reference: a pixel is lit unless some nearer surface crosses its ray.
    fn brute_force(disparity: &[f32]) -> Vec<bool> {
        let through = |u: usize| u as f32 - disparity[u];
        (0..disparity.len())
            .map(|u| {
                (u + 1..disparity.len()).any(|v| {
                    let is_nearer = disparity[v] - disparity[u] >= 1.0;
                    is_nearer && (through(v) - through(u)).abs() <= 0.5
                })
            })
            .collect()
    }

    fn shadow(disparity: &[f32]) -> Vec<bool> {
        let mut seen = disparity.to_vec();
        ProjectorShadow::KINECT_V1.cast(disparity, &mut seen);
        seen.iter()
            .zip(disparity)
            .map(|(&seen, &exact)| seen == 0.0 && exact > 0.0)
            .collect()
    }

    /// Row of disparities with boxes (first column, last column, disparity) in front of a wall.
    fn row(boxes: &[(usize, usize, f32)]) -> Vec<f32> {
        let mut disparity = vec![20.0; 200];
        for &(first, last, d) in boxes {
            disparity[first..=last].fill(d);
        }
        disparity
    }

    #[test]
    fn shadows_agree_with_brute_force() {
        for boxes in [
            vec![(100, 140, 40.0)],
            vec![(100, 104, 40.0)],
            vec![(100, 140, 40.0), (60, 90, 30.0)],
            vec![(100, 103, 60.0), (110, 150, 35.0)],
            vec![(30, 50, 44.0), (80, 81, 70.0), (120, 160, 25.0)],
        ] {
            let disparity = row(&boxes);
            let (ours, truth) = (shadow(&disparity), brute_force(&disparity));
            let n_wrong = (0..200).filter(|&u| ours[u] != truth[u]).count();
            assert!(n_wrong <= 2 * boxes.len(), "{boxes:?}: {n_wrong}");
        }
    }

    #[test]
    fn shadow_of_a_pole_leaves_the_adjacent_wall_lit() {
        // The shadow of a pole five columns wide is twenty columns to its left.
        let shadow = shadow(&row(&[(100, 104, 40.0)]));
        assert!((81..=84).all(|u| shadow[u]));
        assert!((87..=99).all(|u| !shadow[u]));
    }
}
