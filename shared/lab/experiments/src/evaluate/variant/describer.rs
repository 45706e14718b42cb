//! Describes one view after the other.

use super::Readings;
use super::method::{Kind, Method};
use crate::arguments::Up;
use crate::evaluate::failed;
use description::{AppearanceDescriptor, Descriptor, Error, Good, ObjectPoints, reference_frame};
use nalgebra::UnitVector3;
use service::{Failure, exit_code};

/// A descriptor with its scratch memory.
#[derive(Clone)]
pub(in super::super) enum Describer {
    /// GOOD in the frame of its published program; it knows no direction of gravity.
    Good(Box<Good>),
    /// Our own.
    AppearanceDescriptor {
        appearance: Box<AppearanceDescriptor>,
        n_readings: usize,
        /// What is up, if it is not as the data tell.
        up: Option<Up>,
    },
}

impl Describer {
    pub(super) fn new(method: &Method) -> Result<Self, Failure> {
        match method.kind {
            Kind::Good { variant, n_bins } => Good::new(n_bins, variant)
                .map(|good| Self::Good(Box::new(good)))
                .map_err(|error| Failure::new(exit_code::USAGE, error)),
            Kind::Appearance {
                weights,
                n_readings,
                up,
            } => Ok(Self::AppearanceDescriptor {
                appearance: Box::new(AppearanceDescriptor::new(weights).map_err(failed)?),
                n_readings,
                up,
            }),
        }
    }

    /// All readings of an object; `up` is the direction against gravity in the frame of
    /// its points, where it is known.
    ///
    /// # Errors
    /// When there are too few points.
    pub(in super::super) fn describe(
        &mut self,
        points: ObjectPoints<'_>,
        up: Option<&UnitVector3<f64>>,
    ) -> Result<Readings, Error> {
        match self {
            Self::Good(good) => {
                let frame = reference_frame(points).ok_or(Error::NoPoints)?;
                let mut descriptor = Vec::new();
                good.compute(points, &frame, &mut descriptor)?;
                Ok(vec![descriptor])
            }
            Self::AppearanceDescriptor {
                appearance,
                n_readings,
                up: told,
            } => {
                let direction = told.map(Up::direction);
                let up = direction.as_ref().map_or(up, Option::as_ref);
                let readings = appearance.describe(points, up)?;
                Ok(readings[..*n_readings].to_vec())
            }
        }
    }
}
