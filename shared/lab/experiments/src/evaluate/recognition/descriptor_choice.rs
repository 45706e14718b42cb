//! Descriptor choice: GOOD or the appearance descriptor, with its parameters.

use crate::arguments::UpAxis;
use description::{AppearanceWeights, GoodVariant, Support};

/// Points nearer to the middle have no say in the signs of published GOOD, metres.
const SIGN_THRESHOLD_M: f32 = 0.0015;

/// Which descriptor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DescriptorChoice {
    /// GOOD in the frame of its published program.
    Good { variant: GoodVariant, n_bins: usize },
    /// Our own.
    Appearance {
        weights: AppearanceWeights,
        /// How many descriptors of an object are compared with what is stored.
        n_hypotheses: usize,
        /// What is up, if it is not as the data tell.
        up: Option<UpAxis>,
    },
}

impl DescriptorChoice {
    /// GOOD as published by its authors.
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
