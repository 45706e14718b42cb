//! GOOD on metric, soft bins, as low frequencies.
//!
//! *Source*: Kasaei, Tomé, Seabra Lopes, Oliveira 2016 for the three projections;
//! support, bins, order and signs are ours.

use super::cosine_transform::{CosineTransform, N_COEFFICIENTS, SIDE};
use super::soft_bins::{SoftBins, add, tame};
use super::warp;
use crate::projected_points::{Block, LANES, ProjectedPoints};
use crate::{Descriptor, DescriptorFrame, Error, ObjectPoints};

type Cells = [f32; SIDE * SIDE];

/// The projections of the points along the axes of a frame, in the order (x, y),
/// (x, z), (y, z). Each is a histogram of 16 x 16 soft bins around the middle of
/// the points' box, its fourth roots brought to unit length, kept as its 78 lowest
/// coefficients of the cosine transform: 234 values, whose Euclidean distances are
/// at most `sqrt(6)`.
///
/// The bins are metric, fine in the middle, and reach half a metre to both sides. Turning an axis of
/// the frame round changes nothing but the signs of values.
#[derive(Debug, Clone)]
pub struct WarpedGood {
    points: ProjectedPoints,
    transform: CosineTransform,
    projections: [Cells; 3],
}

impl Default for WarpedGood {
    fn default() -> Self {
        Self::new()
    }
}

impl Descriptor for WarpedGood {
    fn dimension(&self) -> usize {
        Self::DIMENSION
    }

    fn compute(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<(), Error> {
        out.clear();
        self.append(points, frame, out).map(|_| ())
    }
}

impl WarpedGood {
    /// Values of a descriptor.
    pub const DIMENSION: usize = 3 * N_COEFFICIENTS;

    /// A descriptor without scratch memory yet.
    pub fn new() -> Self {
        Self {
            points: ProjectedPoints::default(),
            transform: CosineTransform::new(),
            projections: [[0.0; SIDE * SIDE]; 3],
        }
    }

    /// Appends the values to `out` and returns the sides of the box around the
    /// points, metres.
    pub(super) fn append(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<[f32; 3], Error> {
        self.points.fill(points, frame);
        let ranges = self.points.ranges_m().ok_or(Error::NoPoints)?;
        let sides_m = ranges.map(|(low, high)| high - low);
        if !sides_m.iter().all(|side| side.is_finite()) {
            return Err(Error::Extent);
        }
        self.project(ranges.map(|(low, high)| low + 0.5 * (high - low)));
        for cells in &mut self.projections {
            tame(cells);
            self.transform.append(cells, out);
        }
        Ok(sides_m)
    }

    fn project(&mut self, middle_m: [f32; 3]) {
        self.projections = [[0.0; SIDE * SIDE]; 3];
        for block in self.points.blocks() {
            add_block(&mut self.projections, block, middle_m);
        }
    }
}

/// Adds the points of a block to all projections. Where they lie is worked out for
/// all together, which the compiler turns into vector instructions.
fn add_block(projections: &mut [Cells; 3], block: &Block, middle_m: [f32; 3]) {
    let bins = SoftBins::new(SIDE);
    let place =
        |values: &[f32; LANES], middle_m: f32| values.map(|v| warp::place(v, middle_m, bins));
    let x = place(&block.x, middle_m[0]);
    let y = place(&block.y, middle_m[1]);
    let z = place(&block.z, middle_m[2]);
    let [xy, xz, yz] = projections;
    for i in (0..LANES).filter(|&i| !block.x[i].is_nan()) {
        add(xy, SIDE, x[i], y[i]);
        add(xz, SIDE, x[i], z[i]);
        add(yz, SIDE, y[i], z[i]);
    }
}
