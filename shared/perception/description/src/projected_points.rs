//! Points in the object frame, as a structure of arrays.

use crate::{DescriptorFrame, ObjectPoints};
use point_cloud::Point;

/// Points per block: a few vector registers of single precision.
pub(crate) const LANES: usize = 8;

/// Coordinates of a block of points in the object frame, metres. All three are NaN for a
/// point that is not finite, which comparisons ignore.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) x: [f32; LANES],
    pub(crate) y: [f32; LANES],
    pub(crate) z: [f32; LANES],
}

impl Block {
    /// Point block without points.
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
            // A sum of magnitudes is finite only if its terms are: one test for three
            // numbers.
            let is_finite = x.abs() + y.abs() + z.abs() < f32::INFINITY;
            block.x[i] = if is_finite { x } else { f32::NAN };
            block.y[i] = if is_finite { y } else { f32::NAN };
            block.z[i] = if is_finite { z } else { f32::NAN };
        }
        block
    }
}

/// Points in the object frame, block by block; the only copy of the points.
#[derive(Debug, Clone, Default)]
pub(crate) struct ProjectedPoints {
    blocks: Vec<Block>,
}

impl ProjectedPoints {
    /// Replaces the content by points transformed into a frame.
    pub(crate) fn fill(&mut self, points: ObjectPoints<'_>, frame: &DescriptorFrame) {
        self.blocks.clear();
        self.blocks.reserve(points.len().div_ceil(LANES));
        points.for_each_block(|block| self.blocks.push(Block::new(block, frame)));
    }

    /// Blocks in the order of the points; the last one is padded.
    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Minimum and maximum coordinate along each axis, metres; `None` without points.
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

    /// Longest side of the axis-aligned bounding box, metres; `None` without points,
    /// infinite on overflow.
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

/// Updates minimum and maximum per lane. Plain comparisons compile to one instruction
/// each and ignore NaN.
#[inline]
fn widen(low: &mut [f32; LANES], high: &mut [f32; LANES], values: &[f32; LANES]) {
    for i in 0..LANES {
        let value = values[i];
        low[i] = if value < low[i] { value } else { low[i] };
        high[i] = if value > high[i] { value } else { high[i] };
    }
}
