//! Settings of the step.

use crate::Error;
use description::Appearance;
use learning::Metric;
use tracking::{AssociationConfig, MotionConfig};

/// How the descriptors of this version are made; only equal kinds compare.
pub const DESCRIPTOR_KIND: &str = "appearance-1-upright";

/// Larger than any distance of two descriptors of things that fit on a table.
const MAX_DISTANCE: f32 = 10.0;

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
pub const DESCRIPTOR_DIMENSION: usize = Appearance::DIMENSION;

/// The metric in which descriptors are compared.
pub const METRIC: Metric = Metric::Euclidean;
