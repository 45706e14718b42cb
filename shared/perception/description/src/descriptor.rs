//! What every descriptor can do.

use crate::{DescriptorFrame, Error, ObjectPoints};

/// Turns the visible points of an object into a vector of fixed length.
///
/// A value owns its scratch memory, which grows to the largest object seen and
/// is then reused: keep one for each worker.
pub trait Descriptor {
    /// Number of values of a descriptor.
    fn dimension(&self) -> usize;

    /// Replaces the content of `out` by the descriptor of the points.
    ///
    /// Points whose coordinates are not finite are left out.
    ///
    /// # Errors
    /// When no finite point is there, or the extent is not finite; `out` is empty
    /// then.
    fn compute(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<(), Error>;
}
