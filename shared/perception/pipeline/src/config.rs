//! Configuration of tracking and recognition.

use crate::Error;
use description::{AppearanceDescriptor, AxesKind, LearnedMetric};
use learning::{
    Calibration, CategoryIndex, DescriptorSymmetries, MemoryTerm, Metric, NoveltyPrior, UnknownRule,
};
use tracking::{AssociationConfig, MotionConfig};

/// Validated settings of tracking and recognition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    motion: MotionConfig,
    association: AssociationConfig,
    known_probability_min: f32,
    novelty_prior: NoveltyPrior,
}

impl Config {
    /// Default of `known_probability_min`. Chosen with the risk-coverage curve of mesh categories.
    pub const KNOWN_PROBABILITY_MIN: f32 = 0.5;

    /// Validates the settings against their ranges. An object whose best category is less probable
    /// than `known_probability_min`, 0 to 1, is unknown.
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
            novelty_prior: NoveltyPrior::default(),
        })
    }

    /// The same settings with another prior of novelty.
    #[must_use]
    pub fn with_novelty_prior(self, novelty_prior: NoveltyPrior) -> Self {
        Self {
            novelty_prior,
            ..self
        }
    }

    pub(crate) fn motion(&self) -> &MotionConfig {
        &self.motion
    }

    pub(crate) fn association(&self) -> &AssociationConfig {
        &self.association
    }

    /// Rejection rule of recognition.
    pub fn unknown_rule(&self) -> UnknownRule {
        UnknownRule::LessProbableThan {
            probability: self.known_probability_min,
            novelty_prior: self.novelty_prior.probability(),
        }
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
/// The parameters are fitted by maximum likelihood: upright to views of generated objects and of 13
/// mesh categories, with new objects of taught categories as well as one or three lessons of each of
/// 1 to 50 objects, one or three sides of a question, and none or half of the categories untaught;
/// principal to the Restaurant data set.
pub fn calibration(kind: AxesKind) -> Calibration {
    let upright = Calibration {
        symmetries: DescriptorSymmetries {
            turns_of: |mapped| vec![mapped.to_vec(), LearnedMetric::quarter_turn(mapped)],
            half_turn_odd_values: LearnedMetric::half_turn_odd_values,
            mirror_odd_values: LearnedMetric::mirror_odd_values,
        },
        learned_metric: Some(learning::DescriptorMap {
            dimension: LearnedMetric::DIMENSION,
            map: LearnedMetric::map,
        }),
        kernel_width: 2.5,
        ridge: 0.03,
        background_distance: 2.2,
        spread_prior: 0.75,
        score_weight: MemoryTerm {
            of_one_view: 8.58,
            per_log_view: -0.99,
            per_log_category: 0.97,
        },
        unknown_bias: MemoryTerm {
            of_one_view: 2.72,
            per_log_view: -0.42,
            per_log_category: 0.1,
        },
        unknown_slope: 2.59,
    };
    match kind {
        AxesKind::Upright => upright,
        AxesKind::Principal => Calibration {
            symmetries: DescriptorSymmetries {
                turns_of: principal_turns_of,
                half_turn_odd_values: AppearanceDescriptor::half_turn_odd_values,
                mirror_odd_values: AppearanceDescriptor::mirror_odd_values,
            },
            learned_metric: None,
            score_weight: MemoryTerm::constant(6.3),
            unknown_bias: MemoryTerm::constant(2.2),
            unknown_slope: 3.9,
            ..upright
        },
    }
}

/// Axis hypotheses of a stored descriptor with principal axes, without their half turns.
fn principal_turns_of(stored: &[f32]) -> Vec<Vec<f32>> {
    let turned = AppearanceDescriptor::axis_hypothesis_of(stored, AxesKind::Principal, 1);
    vec![stored.to_vec(), turned]
}
