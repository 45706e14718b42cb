//! Segments of detection in a view, matched with the true objects.

use super::bin_scene::BinScene;
use super::captured_view::LabelledImage;
use super::object_recognition::{SegmentDescriber, ViewDescriptors};
use crate::frame_detector::FrameDetector;
use geometry::Plane;
use nalgebra::Point3;
use point_cloud::OrganizedCloud;
use service::Failure;

/// Intersection over union with the true pixels from which on a segment is the object.
const OVERLAP_MIN: f64 = 0.5;
/// Share of the points of a segment from which on it belongs to the bin or is beside it.
const MOST: f64 = 0.5;

/// Model that lies on a segment.
#[derive(Debug, Clone)]
pub(super) struct RegisteredModel {
    pub(super) name: String,
    /// `true` if it is that of the object that the segment covers, at a right pose.
    pub(super) is_right: bool,
}

/// Segment that detection found.
#[derive(Debug, Clone, Default)]
pub(super) struct SceneSegment {
    /// Points in the frame of the camera, metres.
    pub(super) in_camera: Vec<[f32; 3]>,
    /// Object whose pixels it covers.
    pub(super) object: Option<usize>,
    /// Descriptors of its axis hypotheses, until it is recognised; `None` if it has too few points.
    pub(super) descriptors: Option<ViewDescriptors>,
    /// Model that recognition takes it for; `None` for an unknown object.
    pub(super) label: Option<String>,
    /// Most probable models with their probabilities, 0 to 1.
    pub(super) categories: Vec<(String, f64)>,
    /// Model that lies on it, if one fits.
    pub(super) registered: Option<RegisteredModel>,
    /// `true` if the model of the object that it covers fits at a right pose when it is given.
    pub(super) is_true_model_right: bool,
}

impl SceneSegment {
    /// Name of the object that it covers.
    fn true_name<'a>(&self, scene: &'a BinScene) -> Option<&'a str> {
        Some(&scene.objects[self.object?].name)
    }

    /// `true` if recognition takes it for the object that it covers.
    pub(super) fn is_recognised(&self, scene: &BinScene) -> bool {
        self.object.is_some() && self.label.as_deref() == self.true_name(scene)
    }

    /// `true` if the model that lies on it, or else recognition, names the object that it covers.
    pub(super) fn is_identified(&self, scene: &BinScene) -> bool {
        let placed = self.registered.as_ref().map(|model| model.name.as_str());
        self.object.is_some() && placed.or(self.label.as_deref()) == self.true_name(scene)
    }
}

/// Segments of a view.
#[derive(Debug, Clone, Default)]
pub(super) struct MatchedSegments {
    /// Segments of each object: `true` for an object with a segment of its own.
    pub(super) is_detected: Vec<bool>,
    /// Segments, those of the bin and beside it left out.
    pub(super) segments: Vec<SceneSegment>,
    /// Table that was found, camera frame.
    pub(super) table_in_camera: Option<Plane>,
}

impl MatchedSegments {
    /// Number of detected objects.
    pub(super) fn n_detected(&self) -> usize {
        self.is_detected
            .iter()
            .filter(|&&is_detected| is_detected)
            .count()
    }

    /// F1 score of the segments over all objects of the scene, hidden ones included.
    pub(super) fn detection_f1(&self) -> f64 {
        self.f1_of(self.n_detected())
    }

    /// F1 score of the segments that are also identified.
    pub(super) fn f1(&self, scene: &BinScene) -> f64 {
        let identified = self
            .segments
            .iter()
            .filter(|segment| segment.is_identified(scene));
        let mut objects: Vec<_> = identified.map(|segment| segment.object).collect();
        objects.sort_unstable();
        objects.dedup();
        self.f1_of(objects.len())
    }

    fn f1_of(&self, n_right: usize) -> f64 {
        let n = self.segments.len() + self.is_detected.len();
        2.0 * n_right as f64 / n.max(1) as f64
    }
}

/// Detection with its buffers.
#[derive(Debug, Default)]
pub(super) struct SegmentMatcher {
    detector: FrameDetector,
    describer: SegmentDescriber,
}

impl SegmentMatcher {
    /// Detects the segments in a measured image and matches them by its true mask.
    pub(super) fn find(
        &mut self,
        scene: &BinScene,
        image: &LabelledImage<'_>,
    ) -> Result<MatchedSegments, Failure> {
        let size = (image.camera.width as usize, image.camera.height as usize);
        let cloud = OrganizedCloud::new(image.points, size.0, size.1).map_err(Failure::general)?;
        let detection = self.detector.detect(cloud, image.up_in_camera);
        let mut found = MatchedSegments {
            is_detected: vec![false; scene.objects.len()],
            segments: Vec::new(),
            table_in_camera: detection.table().map(|table| table.plane),
        };
        let n_visible = visible_pixels(scene, image);
        let candidates = detection.candidates.iter();
        for candidate in candidates.filter(|candidate| candidate.is_hypothesis()) {
            let indices = detection.points_of(candidate);
            if is_furniture(scene, image, indices) {
                continue;
            }
            let object = matched_object(scene, indices, image.mask, &n_visible);
            if let Some(object) = object {
                found.is_detected[object] = true;
            }
            let in_camera = |&index: &u32| image.points[index as usize].position().cast().into();
            let up = image.up_in_camera.as_ref();
            found.segments.push(SceneSegment {
                in_camera: indices.iter().map(in_camera).collect(),
                object,
                descriptors: self.describer.describe(image.points, indices, up),
                ..SceneSegment::default()
            });
        }
        Ok(found)
    }
}

/// Measured place of a pixel, world frame, metres.
fn in_world(image: &LabelledImage<'_>, index: u32) -> Point3<f64> {
    image.world_from_camera * image.points[index as usize].position()
}

/// `true` for a segment of the bin's walls or outside of the space around the objects. Where the
/// walls are not known, all that shows no object counts as bin.
fn is_furniture(scene: &BinScene, image: &LabelledImage<'_>, indices: &[u32]) -> bool {
    let is_object = |index: u32| {
        let id = image.mask[index as usize];
        scene.objects.iter().any(|object| object.id == id)
    };
    let is_other = |&&index: &&u32| {
        let place = in_world(image, index);
        let at_wall = scene.walls.map(|walls| walls.contain(&place));
        !scene.space.contains(&place) || at_wall.unwrap_or(!is_object(index))
    };
    let n_other = indices.iter().filter(is_other).count();
    n_other as f64 > MOST * indices.len() as f64
}

/// Number of pixels with depth of each object.
fn visible_pixels(scene: &BinScene, image: &LabelledImage<'_>) -> Vec<usize> {
    let count = |id: u16| {
        let pixels = image.mask.iter().zip(image.points);
        pixels
            .filter(|(m, point)| **m == id && point.is_finite())
            .count()
    };
    let ids = scene.objects.iter().map(|object| object.id);
    ids.map(count).collect()
}

/// Object whose pixels a segment covers by an intersection over union of at least one half.
fn matched_object(
    scene: &BinScene,
    indices: &[u32],
    mask: &[u16],
    n_visible: &[usize],
) -> Option<usize> {
    (0..scene.objects.len()).find(|&object| {
        let id = scene.objects[object].id;
        let n_common = indices
            .iter()
            .filter(|&&index| mask[index as usize] == id)
            .count();
        let n_union = indices.len() + n_visible[object] - n_common;
        n_common as f64 >= OVERLAP_MIN * n_union.max(1) as f64
    })
}
