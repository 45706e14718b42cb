//! The two programs of GOOD's authors, and in what they differ.

use super::bins::Rounding;
use super::part_order::Leader;
use super::sign_rule::SignRule;
use crate::Error;

/// Added to the longest side of the object to make the side of an adaptive
/// support, metres.
const SUPPORT_MARGIN_M: f64 = 0.02;

/// Points nearer than this to the middle have no say in the signs of the
/// workspace variant, metres. The program compares with the double 0.015; this is
/// the largest single below it, which no single-precision coordinate can tell from
/// it.
const WORKSPACE_BAND_M: f32 = 0.015;

/// Points that decide about a sign in the workspace variant.
const WORKSPACE_MARGIN_POINTS: usize = 10;

/// Which of the authors' programs is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GoodVariant {
    /// The published program: signs by a majority of a tenth of all points, the
    /// projection of most entropy first, an adaptive support.
    Published {
        /// Points nearer than this to the middle have no say in the signs, metres,
        /// finite, 0 or more; 0.0015 in the program.
        sign_threshold_m: f32,
    },
    /// The program of the authors' evaluations: signs by a majority of 10 points
    /// farther than 0.015 m from the middle, the projection with most occupied bins
    /// first.
    Workspace {
        /// The cube that is divided into bins.
        support: Support,
    },
}

/// The cube around the frame's origin that is divided into bins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// 0.02 m longer than the longest side of the object.
    Adaptive,
    /// The same for all objects, so that their sizes show; points outside are left
    /// out.
    Fixed {
        /// Its side, metres, finite, more than 0; 0.2 in the authors' evaluations.
        side_m: f64,
    },
}

impl Support {
    /// Side of the cube, metres, for an object whose longest side is known.
    fn side_m(self, longest_side_m: f32) -> f64 {
        match self {
            Self::Adaptive => f64::from(longest_side_m) + SUPPORT_MARGIN_M,
            Self::Fixed { side_m } => side_m,
        }
    }
}

impl GoodVariant {
    /// Refuses lengths that are none.
    pub(super) fn check(self) -> Result<(), Error> {
        match self {
            Self::Published {
                sign_threshold_m: t,
            } if !(t.is_finite() && t >= 0.0) => Err(Error::SignThreshold(t)),
            Self::Workspace {
                support: Support::Fixed { side_m },
            } if !(side_m.is_finite() && side_m > 0.0) => Err(Error::SupportSide(side_m)),
            _ => Ok(()),
        }
    }

    /// Side of the cube that is divided into bins, metres.
    pub(super) fn support_m(self, longest_side_m: f32) -> f64 {
        match self {
            Self::Published { .. } => Support::Adaptive.side_m(longest_side_m),
            Self::Workspace { support } => support.side_m(longest_side_m),
        }
    }

    /// The rule for an object of `n_points` points, those without depth included.
    pub(super) fn sign_rule(self, n_points: usize) -> SignRule {
        match self {
            Self::Published { sign_threshold_m } => SignRule {
                band_m: sign_threshold_m,
                margin_points: n_points / 10,
            },
            Self::Workspace { .. } => SignRule {
                band_m: WORKSPACE_BAND_M,
                margin_points: WORKSPACE_MARGIN_POINTS,
            },
        }
    }

    /// Precision of a coordinate before it is divided by the bins' width.
    pub(super) fn rounding(self) -> Rounding {
        match self {
            Self::Published { .. } => Rounding::Single,
            Self::Workspace { .. } => Rounding::Double,
        }
    }

    /// What makes a projection the first.
    pub(super) fn leader(self) -> Leader {
        match self {
            Self::Published { .. } => Leader::MostEntropy,
            Self::Workspace { .. } => Leader::MostOccupiedBins,
        }
    }
}
