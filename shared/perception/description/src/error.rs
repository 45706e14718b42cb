//! Errors of computing object descriptors.

/// Error of an invalid descriptor parameter or object.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Number of bins per side out of range.
    #[error("GOOD cannot have {0} bins a side: choose from 2 to 64, 5 or 15 usually")]
    BinCount(usize),
    /// Sign threshold that is negative or NaN.
    #[error(
        "the sign threshold of GOOD cannot be {0} m: choose a finite length >= 0, 0.0015 m usually"
    )]
    SignThreshold(f32),
    /// Side of a fixed support that is not a positive length.
    #[error(
        "the support of GOOD cannot have sides of {0} m: choose a finite length > 0, 0.2 m usually"
    )]
    SupportSide(f64),
    /// Weight of a part out of range or NaN.
    #[error(
        "a part of a description cannot have the weight {0}: choose a number from 0 to 100, \
         1 usually"
    )]
    Weight(f32),
    /// Point index outside the cloud.
    #[error(
        "the object has a point with index {index}, but its cloud has {n_points} points: \
         give the cloud that the indices were made for"
    )]
    IndexOutsideCloud {
        /// Largest point index in the request.
        index: u32,
        /// Number of points in the given cloud.
        n_points: usize,
    },
    /// Too few finite points to describe an object.
    #[error("the object has too few finite points to describe: skip this view")]
    NoPoints,
    /// Object points whose extent overflows.
    #[error(
        "the extent of the object is not a finite number: check the units and the frame of \
         its points"
    )]
    Extent,
}
