//! GOOD, the global orthographic object descriptor, as published.
//!
//! The points are projected along the three axes of the object's frame; each
//! projection is a histogram of n x n bins. The most informative projection
//! comes first, the other two by ascending variance.
//!
//! *Source*: Kasaei, Tomé, Seabra Lopes, Oliveira, "GOOD: A global orthographic
//! object descriptor for 3D object recognition and manipulation", Pattern
//! Recognition Letters 83, 2016, and the authors' implementation, whose rounding
//! is kept.

mod part_order;
mod projected_points;
mod projections;
mod sign_rule;

use crate::{Descriptor, DescriptorFrame, Error, ObjectPoints};
use part_order::order_of_parts;
use projected_points::ProjectedPoints;
use projections::Projections;
use sign_rule::shared_sign;

/// Added to the longest side of the object to make the side of the cube that is
/// divided into bins, metres.
const SUPPORT_MARGIN_M: f64 = 0.02;

/// The published GOOD descriptor: 3 n² values, each third sums to 1.
#[derive(Debug, Clone)]
pub struct Good {
    n_bins: usize,
    sign_threshold_m: f32,
    points: ProjectedPoints,
    projections: Projections,
}

impl Good {
    /// A descriptor with `n_bins` bins a side, 2 to 64; the paper has 15, the
    /// published program 5. Points nearer than `sign_threshold_m` to the middle
    /// have no say in the signs; the published program has 0.0015 m.
    ///
    /// # Errors
    /// When the number of bins is out of range, or the threshold is negative or not
    /// finite.
    pub fn new(n_bins: usize, sign_threshold_m: f32) -> Result<Self, Error> {
        if !(2..=64).contains(&n_bins) {
            return Err(Error::BinCount(n_bins));
        }
        if !(sign_threshold_m.is_finite() && sign_threshold_m >= 0.0) {
            return Err(Error::SignThreshold(sign_threshold_m));
        }
        Ok(Self {
            n_bins,
            sign_threshold_m,
            points: ProjectedPoints::default(),
            projections: Projections::new(n_bins),
        })
    }
}

impl Descriptor for Good {
    fn dimension(&self) -> usize {
        3 * self.n_bins * self.n_bins
    }

    /// The support is a cube around the frame's origin; on a very asymmetric object
    /// points fall outside and are left out, as published. When all points of a
    /// projection do, which needs a frame far from the centroid, its part is zero.
    fn compute(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<(), Error> {
        out.clear();
        self.points.fill(points, frame);
        let longest_side = self.points.longest_side_m().ok_or(Error::NoPoints)?;
        let support_m = f64::from(longest_side) + SUPPORT_MARGIN_M;
        if !support_m.is_finite() {
            return Err(Error::Extent);
        }
        let sign = shared_sign(&self.points, points.len(), self.sign_threshold_m);
        self.projections.fill(&self.points, sign, support_m);
        for part in order_of_parts(self.projections.parts()) {
            out.extend_from_slice(self.projections.parts()[part]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
