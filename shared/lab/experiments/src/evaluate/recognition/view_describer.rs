//! View describer: a descriptor with its scratch memory.

use super::HypothesisDescriptors;
use super::descriptor_choice::DescriptorChoice;
use crate::arguments::UpAxis;
use description::{AppearanceDescriptor, Descriptor, Error, Good, ObjectPoints, reference_frame};
use nalgebra::UnitVector3;
use service::Failure;

/// Descriptor with its scratch memory.
#[derive(Clone)]
pub(in super::super) enum ViewDescriber {
    /// GOOD in the reference frame of the published program; it ignores gravity.
    Good(Box<Good>),
    /// Appearance descriptor: shape, size and colour.
    Appearance {
        appearance: Box<AppearanceDescriptor>,
        n_hypotheses: usize,
        /// Upward axis that replaces the one of the data, if given.
        up: Option<UpAxis>,
    },
}

impl ViewDescriber {
    pub(super) fn new(descriptor: &DescriptorChoice) -> Result<Self, Failure> {
        match *descriptor {
            DescriptorChoice::Good { variant, n_bins } => Good::new(n_bins, variant)
                .map(|good| Self::Good(Box::new(good)))
                .map_err(Failure::usage),
            DescriptorChoice::Appearance {
                weights,
                n_hypotheses,
                up,
            } => Ok(Self::Appearance {
                appearance: Box::new(AppearanceDescriptor::new(weights).map_err(Failure::general)?),
                n_hypotheses,
                up,
            }),
        }
    }

    /// Descriptors of all axis hypotheses of an object. `up` is the unit vector against gravity in
    /// the frame of the points, if known.
    ///
    /// # Errors
    /// When there are too few points.
    pub(in super::super) fn describe(
        &mut self,
        points: ObjectPoints<'_>,
        up: Option<&UnitVector3<f64>>,
    ) -> Result<HypothesisDescriptors, Error> {
        match self {
            Self::Good(good) => {
                let frame = reference_frame(points).ok_or(Error::NoPoints)?;
                let mut descriptor = Vec::new();
                good.compute(points, &frame, &mut descriptor)?;
                Ok(vec![descriptor])
            }
            Self::Appearance {
                appearance,
                n_hypotheses,
                up: given_up,
            } => {
                let direction = given_up.map(UpAxis::direction);
                let up = direction.as_ref().map_or(up, Option::as_ref);
                let descriptors = appearance.describe(points, up)?;
                Ok(descriptors[..*n_hypotheses].to_vec())
            }
        }
    }
}
