//! The object's points in its own frame, coordinate by coordinate.

use crate::{DescriptorFrame, ObjectPoints};
use point_cloud::Point;

/// Points of a block: some registers of single-precision numbers.
pub(crate) const LANES: usize = 8;

/// Coordinates of some points in the object's frame, metres. All three are NaN
/// where there is no finite point, which no comparison counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) x: [f32; LANES],
    pub(crate) y: [f32; LANES],
    pub(crate) z: [f32; LANES],
}

impl Block {
    /// No points.
    pub(crate) const EMPTY: Self = Self {
        x: [f32::NAN; LANES],
        y: [f32::NAN; LANES],
        z: [f32::NAN; LANES],
    };

    #[inline]
    fn new(points: &[Point; LANES], frame: &DescriptorFrame) -> Self {
        let mut block = Self::EMPTY;
        for (i, point) in points.iter().enumerate() {
            let [x, y, z] = frame.apply(point);
            // A sum is finite only if its terms are: one test for three numbers.
            let is_finite = x.abs() + y.abs() + z.abs() < f32::INFINITY;
            block.x[i] = if is_finite { x } else { f32::NAN };
            block.y[i] = if is_finite { y } else { f32::NAN };
            block.z[i] = if is_finite { z } else { f32::NAN };
        }
        block
    }
}

/// Points in the object's frame, block by block; the only copy that is made.
#[derive(Debug, Clone, Default)]
pub(crate) struct ProjectedPoints {
    blocks: Vec<Block>,
}

impl ProjectedPoints {
    /// Replaces the content by the points seen from the frame.
    pub(crate) fn fill(&mut self, points: ObjectPoints<'_>, frame: &DescriptorFrame) {
        self.blocks.clear();
        self.blocks.reserve(points.len().div_ceil(LANES));
        points.for_each_block(|block| self.blocks.push(Block::new(block, frame)));
    }

    /// The points in their order; the last block is filled up.
    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Lowest and highest coordinate along each axis, metres; `None` without points.
    pub(crate) fn ranges_m(&self) -> Option<[(f32, f32); 3]> {
        let mut low = [[f32::INFINITY; LANES]; 3];
        let mut high = [[f32::NEG_INFINITY; LANES]; 3];
        for block in &self.blocks {
            for (axis, coordinates_m) in [&block.x, &block.y, &block.z].into_iter().enumerate() {
                widen(&mut low[axis], &mut high[axis], coordinates_m);
            }
        }
        let ranges = std::array::from_fn(|axis| {
            let lowest = low[axis].into_iter().fold(f32::INFINITY, f32::min);
            let highest = high[axis].into_iter().fold(f32::NEG_INFINITY, f32::max);
            (lowest, highest)
        });
        ranges
            .iter()
            .all(|(low, high)| low <= high)
            .then_some(ranges)
    }

    /// Longest side of the box around the points, metres; `None` without points.
    /// Infinite when it overflows.
    pub(crate) fn longest_side_m(&self) -> Option<f32> {
        let ranges = self.ranges_m()?;
        Some(
            ranges
                .iter()
                .map(|(low, high)| high - low)
                .fold(0.0, f32::max),
        )
    }
}

/// Plain comparisons, which are one instruction each and leave out NaN.
#[inline]
fn widen(low: &mut [f32; LANES], high: &mut [f32; LANES], values: &[f32; LANES]) {
    for i in 0..LANES {
        let value = values[i];
        low[i] = if value < low[i] { value } else { low[i] };
        high[i] = if value > high[i] { value } else { high[i] };
    }
}
