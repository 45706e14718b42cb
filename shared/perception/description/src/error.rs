//! Why an object can not be described.

use std::fmt;

/// Why a descriptor could not be made or computed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The number of bins a side is out of range.
    BinCount(usize),
    /// The sign threshold is negative or not a number.
    SignThreshold(f32),
    /// The side of a fixed support is not a length.
    SupportSide(f64),
    /// The weight of a part is negative, too large or not a number.
    Weight(f32),
    /// An index points behind the cloud.
    IndexOutsideCloud {
        /// The largest index.
        index: u32,
        /// Number of points in the cloud.
        n_points: usize,
    },
    /// Too few points have finite coordinates in the frame.
    NoPoints,
    /// The points are so far apart that their extent overflows.
    Extent,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BinCount(n) => {
                write!(
                    f,
                    "GOOD can not have {n} bins a side: choose from 2 to 64, 5 or 15 usually"
                )
            }
            Self::SignThreshold(t) => write!(
                f,
                "the sign threshold of GOOD can not be {t} m: choose a finite length >= 0, \
                 0.0015 m usually"
            ),
            Self::SupportSide(side) => write!(
                f,
                "the support of GOOD can not have sides of {side} m: choose a finite length > 0, \
                 0.2 m usually"
            ),
            Self::Weight(weight) => write!(
                f,
                "a part of a description can not have the weight {weight}: choose a number from 0 \
                 to 100, 1 usually"
            ),
            Self::IndexOutsideCloud { index, n_points } => write!(
                f,
                "the object has a point with index {index}, but its cloud has {n_points} points: \
                 give the cloud that the indices were made for"
            ),
            Self::NoPoints => {
                f.write_str("the object has too few finite points to describe: skip this view")
            }
            Self::Extent => f.write_str(
                "the extent of the object is not a finite number: check the units and the frame \
                 of its points",
            ),
        }
    }
}

impl std::error::Error for Error {}
