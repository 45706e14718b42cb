//! Settings of the step.

use crate::Error;
use description::{Appearance, AxesKind};
use learning::{Calibration, CategoryIndex, Metric, UnknownRule};
use tracking::{AssociationConfig, MotionConfig};

/// How the descriptors of this version are made; only equal kinds compare.
pub const DESCRIPTOR_KIND: &str = "appearance-1-upright";

/// Settings of tracking and recognition, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    motion: MotionConfig,
    association: AssociationConfig,
    known_probability_min: f32,
}

impl Config {
    /// Settings; an object is unknown when the probability that it belongs to the
    /// nearest category is less than `known_probability_min`, 0 to 1.
    ///
    /// # Errors
    /// Names the first setting out of its range.
    pub fn new(
        motion: MotionConfig,
        association: AssociationConfig,
        known_probability_min: f32,
    ) -> Result<Self, Error> {
        if !(0.0..=1.0).contains(&known_probability_min) {
            return Err(Error::KnownProbability(known_probability_min));
        }
        Ok(Self {
            motion: motion.validated().map_err(Error::Tracking)?,
            association: association.validated().map_err(Error::Tracking)?,
            known_probability_min,
        })
    }

    pub(crate) fn motion(&self) -> &MotionConfig {
        &self.motion
    }

    pub(crate) fn association(&self) -> &AssociationConfig {
        &self.association
    }

    pub(crate) fn unknown_rule(&self) -> UnknownRule {
        UnknownRule::LessProbableThan(self.known_probability_min)
    }
}

/// Values of a descriptor.
const DESCRIPTOR_DIMENSION: usize = Appearance::DIMENSION;

/// The metric in which descriptors are compared.
pub(crate) const METRIC: Metric = Metric::Euclidean;

/// An index for the descriptions of the live system, which says how probable its
/// answers are.
pub fn category_index() -> CategoryIndex {
    let calibration = calibration(AxesKind::Upright);
    CategoryIndex::new(DESCRIPTOR_DIMENSION, METRIC).with_calibration(calibration)
}

/// From distances of descriptions with axes of this kind to probabilities. The
/// live system describes objects upright.
///
/// The figures fit views of simulated and of scanned objects, and those of the
/// Restaurant data set, with 1 to 50 taught views of each category.
pub fn calibration(kind: AxesKind) -> Calibration {
    let readings_of: fn(&[f32]) -> Vec<Vec<f32>> = match kind {
        AxesKind::Principal => |stored| Appearance::readings_of(stored, AxesKind::Principal).into(),
        AxesKind::Upright => |stored| Appearance::readings_of(stored, AxesKind::Upright).into(),
    };
    Calibration {
        readings_of,
        spread: 0.6,
        far: 1.5,
        even_novelty: 0.9,
        steepness: 4.2,
    }
}
