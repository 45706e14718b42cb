//! The object's points in its own frame, one array for each coordinate.

use crate::{DescriptorFrame, ObjectPoints};

/// Finite points in the object's frame, metres; the only copy that is made.
#[derive(Debug, Clone, Default)]
pub(super) struct ProjectedPoints {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl ProjectedPoints {
    /// Replaces the content by the points seen from the frame.
    pub(super) fn fill(&mut self, points: ObjectPoints<'_>, frame: &DescriptorFrame) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.clear();
            axis.reserve(points.len());
        }
        points.for_each(|point| {
            let [x, y, z] = frame.apply(point);
            // A sum is finite only if its terms are: one test for three numbers.
            if (x.abs() + y.abs() + z.abs()).is_finite() {
                self.x.push(x);
                self.y.push(y);
                self.z.push(z);
            }
        });
    }

    /// Longest side of the box around the points, metres; `None` without points.
    /// Infinite when it overflows.
    pub(super) fn longest_side_m(&self) -> Option<f32> {
        if self.x.is_empty() {
            return None;
        }
        Some(
            [&self.x, &self.y, &self.z]
                .map(|axis| extent(axis))
                .into_iter()
                .fold(0.0, f32::max),
        )
    }
}

/// Difference of the largest and smallest value. Several lanes, so that the
/// compiler can use vector instructions: minima do not depend on the order.
fn extent(values: &[f32]) -> f32 {
    const LANES: usize = 8;
    let mut low = [f32::INFINITY; LANES];
    let mut high = [f32::NEG_INFINITY; LANES];
    let mut chunks = values.chunks_exact(LANES);
    for chunk in &mut chunks {
        for i in 0..LANES {
            low[i] = if chunk[i] < low[i] { chunk[i] } else { low[i] };
            high[i] = if chunk[i] > high[i] {
                chunk[i]
            } else {
                high[i]
            };
        }
    }
    let rest = chunks.remainder().iter().copied();
    let lowest = low
        .into_iter()
        .chain(rest.clone())
        .fold(f32::INFINITY, f32::min);
    let highest = high
        .into_iter()
        .chain(rest)
        .fold(f32::NEG_INFINITY, f32::max);
    highest - lowest
}
