//! Descriptor choice: GOOD or the appearance descriptor, with its parameters.

use crate::arguments::UpAxis;
use description::{AppearanceWeights, GoodVariant, Support};

/// Distance from the median plane below which a point does not vote on the axis signs of published
/// GOOD, metres. Value of the published program.
const SIGN_THRESHOLD_M: f32 = 0.0015;

/// Descriptor with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DescriptorChoice {
    /// GOOD in the reference frame of the published program.
    Good { variant: GoodVariant, n_bins: usize },
    /// Appearance descriptor: shape, size and colour.
    Appearance {
        weights: AppearanceWeights,
        /// Number of axis hypotheses of a query that are compared.
        n_hypotheses: usize,
        /// Upward axis that replaces the one of the data, if given.
        up: Option<UpAxis>,
    },
}

impl DescriptorChoice {
    /// GOOD descriptor as published by its authors.
    pub(super) fn published_good(n_bins: usize) -> Self {
        Self::Good {
            variant: GoodVariant::Published {
                sign_threshold_m: SIGN_THRESHOLD_M,
            },
            n_bins,
        }
    }

    /// GOOD with a bounding cube that fits the object.
    pub(super) fn workspace_good(n_bins: usize) -> Self {
        Self::Good {
            variant: GoodVariant::Workspace {
                support: Support::Adaptive,
            },
            n_bins,
        }
    }
}
