//! Variant of GOOD with warped, interpolated metric bins, as cosine coefficients.
//!
//! *Source*: Kasaei, Tomé, Seabra Lopes, Oliveira 2016 for the three projections;
//! support, bins, order and signs differ.

use super::cosine_transform::{CosineTransform, N_COEFFICIENTS, SIDE};
use super::soft_bins::{SoftBins, add, normalise_fourth_roots};
use super::warp;
use crate::projected_points::{Block, LANES, ProjectedPoints};
use crate::{Descriptor, DescriptorFrame, Error, ObjectPoints};

type Cells = [f32; SIDE * SIDE];

/// Shape descriptor from the projections of the points in the order (x, y), (x, z), (y,
/// z). Each projection is a histogram of 16 x 16 interpolated bins around the middle of
/// the bounding box. Its fourth roots, normalised to unit length, are reduced to the 78
/// lowest coefficients of the cosine transform: 234 values in all, with Euclidean
/// distances of at most `sqrt(6)`.
///
/// The bins are metric, fine in the middle, and reach half a metre to both sides.
/// Reversing an axis of the frame only changes the signs of values.
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
    /// Length of a warped GOOD descriptor, values.
    pub const DIMENSION: usize = 3 * N_COEFFICIENTS;

    /// Warped GOOD descriptor without allocated scratch memory.
    pub fn new() -> Self {
        Self {
            points: ProjectedPoints::default(),
            transform: CosineTransform::new(),
            projections: [[0.0; SIDE * SIDE]; 3],
        }
    }

    /// Points of the last description, in its frame.
    pub(super) fn points(&self) -> &ProjectedPoints {
        &self.points
    }

    /// Appends the values to `out` and returns the least and greatest coordinates of the
    /// bounding box, metres.
    pub(super) fn append(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<[(f32, f32); 3], Error> {
        self.points.fill(points, frame);
        let ranges = self.points.ranges_m().ok_or(Error::NoPoints)?;
        if !ranges.iter().all(|(low, high)| (high - low).is_finite()) {
            return Err(Error::Extent);
        }
        self.project(ranges.map(|(low, high)| low + 0.5 * (high - low)));
        for cells in &mut self.projections {
            normalise_fourth_roots(cells);
            self.transform.append(cells, out);
        }
        Ok(ranges)
    }

    fn project(&mut self, middle_m: [f32; 3]) {
        self.projections = [[0.0; SIDE * SIDE]; 3];
        for block in self.points.blocks() {
            add_block(&mut self.projections, block, middle_m);
        }
    }
}

/// Adds a block of points to all projections. The bins of all points are computed first,
/// which compiles to vector instructions.
fn add_block(projections: &mut [Cells; 3], block: &Block, middle_m: [f32; 3]) {
    let bins = SoftBins::new(SIDE);
    let place =
        |values: &[f32; LANES], middle_m: f32| values.map(|v| warp::warped_bin(v, middle_m, bins));
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
