//! Variants of GOOD: the two programs of its authors.

use super::bins::Rounding;
use super::part_order::FirstPartCriterion;
use super::sign_rule::SignRule;
use crate::Error;

/// Margin added to the longest side of the object for an adaptive support, metres.
/// *Source*: the authors' programs.
const SUPPORT_MARGIN_M: f64 = 0.02;

/// Half width of the band whose points are ignored by the sign rule of the workspace
/// variant, metres. The program compares with the double 0.015; this is the largest
/// single below it, which no single-precision coordinate can distinguish from it.
const WORKSPACE_BAND_M: f32 = 0.015;

/// Majority of points that decides a sign in the workspace variant. *Source*: the
/// authors' program.
const WORKSPACE_MARGIN_POINTS: usize = 10;

/// Variant of GOOD, one per program of its authors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GoodVariant {
    /// Published program: signs by a majority of a tenth of all points, projection of
    /// largest entropy first, adaptive support.
    Published {
        /// Half width of the band whose points are ignored by the sign rule, metres;
        /// finite, at least 0, 0.0015 in the program.
        sign_threshold_m: f32,
    },
    /// Program of the authors' evaluations: signs by a majority of 10 points farther
    /// than 0.015 m from the middle, projection with most occupied bins first.
    Workspace {
        /// Support (extent) of the histograms.
        support: Support,
    },
}

/// Cubic support of the histograms around the frame's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// Cube 0.02 m longer than the longest side of the object.
    Adaptive,
    /// Cube of equal size for all objects, which preserves their size; points outside
    /// are skipped.
    Fixed {
        /// Side, metres, finite, greater than 0; 0.2 in the authors' evaluations.
        side_m: f64,
    },
}

impl Support {
    /// Side of the cube, metres, for an object with a given longest side.
    fn side_m(self, longest_side_m: f32) -> f64 {
        match self {
            Self::Adaptive => f64::from(longest_side_m) + SUPPORT_MARGIN_M,
            Self::Fixed { side_m } => side_m,
        }
    }
}

impl GoodVariant {
    /// Checks that the lengths are finite and not negative.
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

    /// Side of the support cube of the histograms, metres.
    pub(super) fn support_m(self, longest_side_m: f32) -> f64 {
        match self {
            Self::Published { .. } => Support::Adaptive.side_m(longest_side_m),
            Self::Workspace { support } => support.side_m(longest_side_m),
        }
    }

    /// Sign rule for an object of `n_points` points, including those without depth.
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

    /// Precision of a coordinate before the division by the bin width.
    pub(super) fn rounding(self) -> Rounding {
        match self {
            Self::Published { .. } => Rounding::Single,
            Self::Workspace { .. } => Rounding::Double,
        }
    }

    /// Criterion that selects the first projection.
    pub(super) fn first_part_criterion(self) -> FirstPartCriterion {
        match self {
            Self::Published { .. } => FirstPartCriterion::MostEntropy,
            Self::Workspace { .. } => FirstPartCriterion::MostOccupiedBins,
        }
    }
}
