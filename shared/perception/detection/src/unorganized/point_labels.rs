//! Transfer of candidate labels from image pixels to points.

use super::label_groups::{LabelGroups, UNLABELLED};
use crate::output::Detection;

/// Point labels set last, with buffers.
#[derive(Debug, Default)]
pub(super) struct PointLabels {
    of_pixel: Vec<u32>,
    of_point: Vec<u32>,
    groups: LabelGroups,
}

impl PointLabels {
    /// Label `n_points` points by the candidates of an image of `n_pixels`; `pixel_of`
    /// gives the pixel whose surface a point belongs to.
    pub(super) fn refill(
        &mut self,
        detection: &Detection,
        n_pixels: usize,
        n_points: usize,
        pixel_of: impl Fn(usize) -> Option<usize>,
    ) {
        self.of_pixel.clear();
        self.of_pixel.resize(n_pixels, UNLABELLED);
        for (label, candidate) in (0..).zip(&detection.candidates) {
            for &pixel in detection.points_of(candidate) {
                self.of_pixel[pixel as usize] = label;
            }
        }
        self.of_point.clear();
        let label = |i: usize| pixel_of(i).map_or(UNLABELLED, |pixel| self.of_pixel[pixel]);
        self.of_point.extend((0..n_points).map(label));
    }

    /// Per point: the number of its candidate, or [`UNLABELLED`].
    pub(super) fn of_point(&self) -> &[u32] {
        &self.of_point
    }

    /// Replace the pixels of the candidates by the labelled points, in the order of the
    /// cloud.
    pub(super) fn write_indices(&mut self, detection: &mut Detection) {
        self.groups
            .refill(&self.of_point, detection.candidates.len());
        detection.point_indices.clear();
        for (label, candidate) in detection.candidates.iter_mut().enumerate() {
            let first = detection.point_indices.len();
            detection
                .point_indices
                .extend_from_slice(self.groups.members(label));
            candidate.range = first..detection.point_indices.len();
        }
    }
}
