//! Known objects of a scene: their recogniser and their models, by which segments are identified.

use super::bin_scene::BinScene;
use super::captured_view::LabelledImage;
use super::object_recognition::{ObjectRecogniser, RecognisedObject};
use super::object_registration::RegistrationModels;
use super::segment_matching::{MatchedSegments, SceneSegment};
use service::Failure;

/// Stride over rows and columns of the frame in registration. Chosen: neighbouring points are 3 mm
/// apart, less than a cell of the range image.
const FRAME_STRIDE: usize = 2;

/// Known objects of a scene.
#[derive(Debug)]
pub(super) struct KnownObjects {
    /// Recogniser; without one all models are alike.
    recogniser: Option<ObjectRecogniser>,
    models: RegistrationModels,
}

impl KnownObjects {
    /// Objects whose models are known, and that are recognised if they were taught.
    pub(super) fn new(
        scene: &BinScene,
        recogniser: Option<ObjectRecogniser>,
    ) -> Result<Self, Failure> {
        Ok(Self {
            recogniser,
            models: RegistrationModels::of(scene)?,
        })
    }

    /// Recognises the segments of an image, and registers the models with them.
    pub(super) fn identify(
        &self,
        scene: &BinScene,
        image: &LabelledImage<'_>,
        segments: &mut MatchedSegments,
    ) {
        let points = image.strided_points(FRAME_STRIDE);
        let frame: Vec<[f32; 3]> = points.map(|p| p.position().cast().into()).collect();
        for segment in &mut segments.segments {
            segment.recognised = self.recognised(scene, segment);
            segment.descriptors = None;
            segment.registered =
                self.models
                    .register(scene, segment, &frame, &image.world_from_camera);
        }
    }

    /// Objects that a segment may be, the most probable first; none without a recogniser.
    fn recognised(&self, scene: &BinScene, segment: &SceneSegment) -> Vec<RecognisedObject> {
        let descriptors = segment.descriptors.as_ref();
        let known = self.recogniser.as_ref().zip(descriptors);
        known.map_or_else(Vec::new, |(recogniser, descriptors)| {
            recogniser.recognise(scene, descriptors)
        })
    }
}
