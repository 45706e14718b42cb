//! Settings of the step.

use crate::Error;
use learning::Metric;
use tracking::{AssociationConfig, MotionConfig};

/// How the descriptors of this version are made; only equal kinds compare.
pub const DESCRIPTOR_KIND: &str = "good-published-15-box-frame";

/// Bins a side of the descriptor, as in the paper.
const N_BINS: usize = 15;

/// Points nearer than this to an axis have no say in its sign, metres. Larger
/// than any object: all readings of the box are compared, which leaves no sign
/// to decide, and a rule that turns at ten points in a hundred turns with noise.
const SIGN_THRESHOLD_M: f32 = 100.0;

/// A little more than the largest distance of the metric, the square root of 3,
/// at which two descriptors have no bin in common.
const MAX_DISTANCE: f32 = 1.75;

/// Settings of tracking and recognition, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    motion: MotionConfig,
    association: AssociationConfig,
    unknown_distance: f32,
}

impl Config {
    /// Settings; an object farther than `unknown_distance` from every stored
    /// view is unknown (0 to 1.75; the paper has 0.75).
    ///
    /// # Errors
    /// Names the first setting out of its range.
    pub fn new(
        motion: MotionConfig,
        association: AssociationConfig,
        unknown_distance: f32,
    ) -> Result<Self, Error> {
        if !(0.0..=MAX_DISTANCE).contains(&unknown_distance) {
            return Err(Error::UnknownDistance(unknown_distance));
        }
        Ok(Self {
            motion: motion.validated().map_err(Error::Tracking)?,
            association: association.validated().map_err(Error::Tracking)?,
            unknown_distance,
        })
    }

    pub(crate) fn motion(&self) -> &MotionConfig {
        &self.motion
    }

    pub(crate) fn association(&self) -> &AssociationConfig {
        &self.association
    }

    pub(crate) fn unknown_distance(&self) -> f32 {
        self.unknown_distance
    }
}

/// Values of a descriptor.
pub const DESCRIPTOR_DIMENSION: usize = 3 * N_BINS * N_BINS;

/// The metric in which descriptors are compared.
pub const METRIC: Metric = Metric::HalfChiSquaredRoot;

pub(crate) fn descriptor() -> Result<description::Good, Error> {
    let variant = description::GoodVariant::Published {
        sign_threshold_m: SIGN_THRESHOLD_M,
    };
    description::Good::new(N_BINS, variant).map_err(Error::Description)
}
