//! Trait of object descriptors.

use crate::{DescriptorFrame, Error, ObjectPoints};

/// Descriptor of fixed length for the visible points of an object.
///
/// An implementation owns its scratch memory, which grows to the largest object and is
/// then reused: keep one per worker.
pub trait Descriptor {
    /// Length of the descriptor vector, values.
    fn dimension(&self) -> usize;

    /// Computes the descriptor of the points into `out`, replacing its content.
    ///
    /// Points with a coordinate that is not finite are skipped.
    ///
    /// # Errors
    /// When no point is finite, or the extent is not finite; `out` is then empty.
    fn compute(
        &mut self,
        points: ObjectPoints<'_>,
        frame: &DescriptorFrame,
        out: &mut Vec<f32>,
    ) -> Result<(), Error>;
}
