//! Body map: samples of the image that show a person, with the age of the evidence.

use crate::depth_history::DepthHistory;
use crate::samples::Samples;
use geometry::RigidTransform;
use point_cloud::{ColorHistogram, Rgba};

/// Learning rate of the colours of bodies. Chosen.
const COLOR_LEARNING_RATE: f32 = 0.05;

/// Body map of a subsampled image, as prior of the next frame. Empty when bodies were not
/// searched.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodyMap {
    /// Number of frames since the body at a sample had evidence of its own, from 1; 0 where no
    /// body is seen.
    ages: Vec<u8>,
    is_any: bool,
    /// Colours of the bodies, averaged over frames.
    colors: Option<ColorHistogram>,
    history: DepthHistory,
}

impl BodyMap {
    /// `true` when at least one sample shows a body.
    pub fn is_any(&self) -> bool {
        self.is_any
    }

    /// Copy another map and keep the memory of this one.
    pub fn assign(&mut self, other: &Self) {
        self.ages.clone_from(&other.ages);
        self.is_any = other.is_any;
        self.colors = other.colors;
        self.history.assign(&other.history);
    }

    pub(crate) fn len(&self) -> usize {
        self.ages.len()
    }

    pub(crate) fn clear(&mut self) {
        self.reset(0);
        self.history.clear();
    }

    /// Depth history up to this image.
    pub(crate) fn history(&self) -> &DepthHistory {
        &self.history
    }

    /// Add this image to the depth history of the previous one.
    pub(crate) fn advance_history(
        &mut self,
        previous: Option<&Self>,
        samples: &Samples,
        world_from_camera: &RigidTransform,
    ) {
        let none = DepthHistory::default();
        let previous = previous.map_or(&none, |map| &map.history);
        self.history.advance(previous, samples, world_from_camera);
    }

    /// Map of an image without bodies.
    pub(crate) fn reset(&mut self, n_samples: usize) {
        self.ages.clear();
        self.ages.resize(n_samples, 0);
        self.is_any = false;
        self.colors = None;
    }

    pub(crate) fn age(&self, sample: usize) -> u8 {
        self.ages[sample]
    }

    /// Colours of the bodies; uniform when they are not known.
    pub(crate) fn colors(&self) -> Option<&ColorHistogram> {
        self.colors.as_ref()
    }

    /// Average the colours of this image's bodies with those of the previous image.
    pub(crate) fn learn_colors(
        &mut self,
        colors: impl Iterator<Item = Rgba>,
        previous: Option<&Self>,
    ) {
        let mut colors = colors.peekable();
        let known = previous.and_then(|map| map.colors.as_ref());
        let now = colors
            .peek()
            .is_some()
            .then(|| ColorHistogram::from_colors(colors));
        self.colors = match (known, now) {
            (Some(known), Some(now)) => Some(known.blended(&now, COLOR_LEARNING_RATE)),
            (known, now) => now.or(known.copied()),
        };
    }

    /// Samples of bodies.
    pub(crate) fn samples(&self) -> impl Iterator<Item = usize> {
        let ages = self.ages.iter().enumerate();
        ages.filter(|&(_, &age)| age > 0).map(|(sample, _)| sample)
    }

    /// Mark the samples of a body.
    pub(crate) fn mark(&mut self, samples: &[u32], age: u8) {
        for &sample in samples {
            self.ages[sample as usize] = age;
        }
        self.is_any |= !samples.is_empty();
    }
}
