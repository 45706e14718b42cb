//! Configuration of tracking and recognition.

use crate::Error;
use description::{AppearanceDescriptor, AxesKind};
use learning::{Calibration, CategoryIndex, DescriptorSymmetries, Metric, UnknownRule};
use tracking::{AssociationConfig, MotionConfig};

/// Validated settings of tracking and recognition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    motion: MotionConfig,
    association: AssociationConfig,
    known_probability_min: f32,
}

impl Config {
    /// Default of `known_probability_min`. With the probabilities of [`calibration`] it rejects
    /// about nine in ten unknown objects, and one in fifty that were taught from several sides.
    pub const KNOWN_PROBABILITY_MIN: f32 = 0.75;

    /// Validates the settings against their ranges. An object whose probability of belonging to the
    /// nearest category is below `known_probability_min`, 0 to 1, is unknown.
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

    /// Rejection rule of recognition.
    pub fn unknown_rule(&self) -> UnknownRule {
        UnknownRule::LessProbableThan(self.known_probability_min)
    }
}

/// Length of an object descriptor, values.
const DESCRIPTOR_DIMENSION: usize = AppearanceDescriptor::DIMENSION;

/// Metric of descriptor distances.
pub(crate) const METRIC: Metric = Metric::Euclidean;

/// Empty category index for the descriptors of the live system, with probability
/// calibration.
pub fn category_index() -> CategoryIndex {
    let calibration = calibration(AxesKind::Upright);
    CategoryIndex::new(DESCRIPTOR_DIMENSION, METRIC).with_calibration(calibration)
}

/// Calibration of recognition for descriptors with axes of this kind; the live system uses
/// upright axes.
///
/// The parameters are fitted by maximum likelihood to views of simulated, of mesh and of
/// scanned objects (upright) and to the Restaurant data set (principal), with 1 to 100
/// taught views per object and one to six sides of a question, where none, 30 % or half of the
/// categories are untaught. Probabilities are thus those of a table on which one object in four
/// is unknown.
pub fn calibration(kind: AxesKind) -> Calibration {
    let upright = Calibration {
        symmetries: DescriptorSymmetries {
            turns_of: |stored| turns_of(stored, AxesKind::Upright),
            half_turn_odd_values: AppearanceDescriptor::half_turn_odd_values,
            mirror_odd_values: AppearanceDescriptor::mirror_odd_values,
        },
        kernel_width: 2.5,
        ridge: 0.03,
        background_distance: 2.2,
        spread_prior: 0.75,
        score_weight: 7.7,
        unknown_bias: 2.1,
        unknown_slope: 3.1,
    };
    match kind {
        AxesKind::Upright => upright,
        AxesKind::Principal => Calibration {
            symmetries: DescriptorSymmetries {
                turns_of: |stored| turns_of(stored, AxesKind::Principal),
                ..upright.symmetries
            },
            score_weight: 6.3,
            unknown_bias: 2.2,
            unknown_slope: 3.9,
            ..upright
        },
    }
}

/// Axis hypotheses of a stored descriptor without their half turns.
fn turns_of(stored: &[f32], kind: AxesKind) -> Vec<Vec<f32>> {
    let turned = AppearanceDescriptor::axis_hypothesis_of(stored, kind, 1);
    vec![stored.to_vec(), turned]
}
