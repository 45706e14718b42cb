//! GOOD, the Global Orthographic Object Descriptor, in the variants of its authors.
//!
//! The points are projected along the three axes of the object frame, each into a
//! histogram of n x n bins. The most informative projection comes first, the other two
//! in order of ascending variance.
//!
//! *Source*: Kasaei, Tomé, Seabra Lopes, Oliveira, "GOOD: A global orthographic object
//! descriptor for 3D object recognition and manipulation", Pattern Recognition Letters
//! 83, 2016, and the authors' implementations, whose rounding is reproduced.

mod bins;
mod part_order;
mod projections;
mod sign_rule;
mod variant;

use crate::projected_points::ProjectedPoints;
use crate::{Descriptor, DescriptorFrame, Error, ObjectPoints};
use bins::Bins;
use part_order::order_of_parts;
use projections::Projections;
pub use variant::{GoodVariant, Support};

/// GOOD descriptor with its scratch memory: 3 n² values, each third with a sum of 1.
#[derive(Debug, Clone)]
pub struct Good {
    n_bins: usize,
    variant: GoodVariant,
    points: ProjectedPoints,
    projections: Projections,
}

impl Good {
    /// GOOD descriptor with `n_bins` bins per side, 2 to 64. The paper uses 15, the
    /// published program 5, the authors' evaluations 15 and 50.
    ///
    /// # Errors
    /// When the number of bins is out of range, or a length of the variant is not
    /// finite or too small.
    pub fn new(n_bins: usize, variant: GoodVariant) -> Result<Self, Error> {
        if !(2..=64).contains(&n_bins) {
            return Err(Error::BinCount(n_bins));
        }
        variant.check()?;
        Ok(Self {
            n_bins,
            variant,
            points: ProjectedPoints::default(),
            projections: Projections::new(n_bins),
        })
    }
}

impl Descriptor for Good {
    fn dimension(&self) -> usize {
        3 * self.n_bins * self.n_bins
    }

    /// Computes GOOD in a cubic support around the frame's origin. As in the authors'
    /// programs, points outside are skipped: some points of a very asymmetric object,
    /// many of an object larger than a fixed support. A part without points is zero.
    fn compute(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<(), Error> {
        out.clear();
        self.points.fill(points, frame);
        let longest_side_m = self.points.longest_side_m().ok_or(Error::NoPoints)?;
        if !longest_side_m.is_finite() {
            return Err(Error::Extent);
        }
        let support_m = self.variant.support_m(longest_side_m);
        let bins = Bins::new(self.n_bins as u32, support_m, self.variant.rounding());
        let sign = self
            .variant
            .sign_rule(points.len())
            .shared_sign(&self.points);
        self.projections.fill(&self.points, sign, bins);
        let parts = self.projections.parts();
        for part in order_of_parts(parts, self.variant.first_part_criterion()) {
            out.extend_from_slice(parts[part]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
