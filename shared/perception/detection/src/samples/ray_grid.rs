//! Ray grid: the tangents of the viewing rays of a subsampled image, fitted to its points.

use super::Samples;
use nalgebra::Point3;

/// Tangent of the angle between neighbouring pixels of a Kinect v1.
const KINECT_PITCH: f32 = 1.0 / 585.0;

/// Plausible tangents of the angle between neighbouring pixels.
const PITCH: [f32; 2] = [1e-4, 2e-2];

/// Least span of two samples from which the rays are fitted, as share of a row or column.
const SPAN_MIN: f32 = 0.25;

/// Tangents of the viewing rays: `x / z` is linear in the column, `y / z` in the row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RayGrid {
    width: usize,
    height: usize,
    /// Tangents of the first sample.
    first: [f32; 2],
    /// Difference of the tangents of neighbouring samples.
    pitch: [f32; 2],
    stride: usize,
}

impl Default for RayGrid {
    fn default() -> Self {
        Self {
            width: 0,
            height: 0,
            first: [0.0; 2],
            pitch: [KINECT_PITCH; 2],
            stride: 1,
        }
    }
}

impl RayGrid {
    /// Fit the rays to the two farthest samples of a row and of a column with depth. Without
    /// enough depth the rays are those of a Kinect.
    pub(super) fn fit(samples: &Samples) -> Self {
        let (width, height) = (samples.width, samples.height);
        let stride = samples.stride.max(1);
        let pitch = KINECT_PITCH * stride as f32;
        let mut grid = Self {
            width,
            height,
            first: [-0.5 * pitch * width as f32, -0.5 * pitch * height as f32],
            pitch: [pitch; 2],
            stride,
        };
        let rows = (0..height).map(|row| (row * width, 1, width));
        let columns = (0..width).map(|column| (column, width, height));
        if let Some((first, pitch)) = fit_lines(rows, &samples.x, &samples.z) {
            (grid.first[0], grid.pitch[0]) = (first, pitch);
        }
        if let Some((first, pitch)) = fit_lines(columns, &samples.y, &samples.z) {
            (grid.first[1], grid.pitch[1]) = (first, pitch);
        }
        grid
    }

    /// Tangent of the angle between neighbouring pixels.
    pub(crate) fn pixel_pitch(&self) -> f32 {
        self.pitch[0] / self.stride as f32
    }

    /// Sample on whose ray a point is, camera frame; `None` outside of the image.
    #[inline]
    pub(crate) fn sample_at(&self, x: f32, y: f32, z: f32) -> Option<usize> {
        let [column, row] = self.place_at([x, y, z], 1)?;
        Some(row * self.width + column)
    }

    /// Column and row of the pixel on whose ray a point is, camera frame; `None` outside of the
    /// image.
    pub(crate) fn pixel_at(&self, point: &Point3<f64>) -> Option<[usize; 2]> {
        self.place_at(point.coords.cast().into(), self.stride)
    }

    /// Column and row of a point in the image with `n` pixels for each sample along a row.
    #[inline]
    fn place_at(&self, [x, y, z]: [f32; 3], n: usize) -> Option<[usize; 2]> {
        if z <= 0.0 {
            return None;
        }
        let at = |value: f32, axis: usize| {
            ((value / z - self.first[axis]) / self.pitch[axis] * n as f32 + 0.5).floor()
        };
        let (column, row) = (at(x, 0), at(y, 1));
        let is_inside = (0.0..(self.width * n) as f32).contains(&column)
            && (0.0..(self.height * n) as f32).contains(&row);
        is_inside.then_some([column as usize, row as usize])
    }
}

/// Tangent of the first sample and difference of neighbouring ones, of the line with the widest
/// span of depth; each line is the index of its first sample, its step and its length.
fn fit_lines(
    lines: impl Iterator<Item = (usize, usize, usize)>,
    coordinate: &[f32],
    z: &[f32],
) -> Option<(f32, f32)> {
    let mut widest = (0, None);
    for (start, step, n) in lines {
        let has_depth = |i: &usize| z[start + i * step] > 0.0;
        let ends = (0..n).find(has_depth).zip((0..n).rev().find(has_depth));
        if let Some((first, last)) = ends
            && last - first > widest.0
            && (last - first) as f32 >= SPAN_MIN * n as f32
        {
            let tangent = |i: usize| coordinate[start + i * step] / z[start + i * step];
            let pitch = (tangent(last) - tangent(first)) / (last - first) as f32;
            if (PITCH[0]..PITCH[1] * 16.0).contains(&pitch) {
                widest = (
                    last - first,
                    Some((tangent(first) - pitch * first as f32, pitch)),
                );
            }
        }
    }
    widest.1
}
