//! Description of stored views: views of an earlier descriptor kind are described again from
//! their points.

use crate::Error;
use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
use nalgebra::Vector3;
use point_cloud::Point;

/// Describer of stored views with its scratch memory. Its descriptors are of
/// [`DESCRIPTOR_KIND`](learning::DESCRIPTOR_KIND).
#[derive(Debug, Clone)]
pub struct StoredViewDescriber {
    appearance: AppearanceDescriptor,
}

impl StoredViewDescriber {
    /// Describer without allocated scratch memory.
    ///
    /// # Errors
    /// When the descriptor weights are invalid.
    pub fn new() -> Result<Self, Error> {
        let appearance = AppearanceDescriptor::new(AppearanceWeights::default());
        Ok(Self {
            appearance: appearance.map_err(Error::Description)?,
        })
    }

    /// Descriptor of the points of a view. *Frame*: that of the object's upright box.
    ///
    /// # Errors
    /// When there are too few points.
    pub fn describe(&mut self, points: &[Point]) -> Result<Vec<f32>, Error> {
        let up = Vector3::z_axis();
        let described = self
            .appearance
            .describe(ObjectPoints::all(points), Some(&up));
        let [stored, ..] = described.map_err(Error::Description)?;
        Ok(stored.clone())
    }
}
