//! Segments of detection in a view, matched with the true objects.

use super::bin_scene::BinScene;
use super::captured_view::{CAMERA, up_in_camera};
use crate::frame_detector::FrameDetector;
use geometry::RigidTransform;
use nalgebra::Point3;
use point_cloud::{OrganizedCloud, Point};
use service::Failure;

/// Intersection over union with the true pixels from which on a segment is the object.
const OVERLAP_MIN: f64 = 0.5;
/// Share of the points of a segment from which on it belongs to the bin or is beside it.
const MOST: f64 = 0.5;

/// Segments of a view.
#[derive(Debug, Clone, Default)]
pub(super) struct MatchedSegments {
    /// Segments of each object: `true` for an object with a segment of its own.
    pub(super) is_detected: Vec<bool>,
    /// Number of segments, those of the bin and beside it left out.
    pub(super) n_segments: usize,
    /// Points of the segments that are no object of their own, world frame, metres.
    pub(super) fragments: Vec<Vec<[f32; 3]>>,
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
    pub(super) fn f1(&self) -> f64 {
        let n = self.n_segments + self.is_detected.len();
        2.0 * self.n_detected() as f64 / n.max(1) as f64
    }
}

/// Detection with its buffers.
#[derive(Debug, Default)]
pub(super) struct SegmentMatcher {
    detector: FrameDetector,
}

impl SegmentMatcher {
    /// Detects the segments in a measured image and matches them by their true mask.
    pub(super) fn find(
        &mut self,
        scene: &BinScene,
        (points, mask): (&[Point], &[u16]),
        world_from_camera: &RigidTransform,
        seed: usize,
    ) -> Result<MatchedSegments, Failure> {
        let size = (CAMERA.width as usize, CAMERA.height as usize);
        let cloud = OrganizedCloud::new(points, size.0, size.1).map_err(Failure::general)?;
        let up_in_camera = Some(up_in_camera(world_from_camera));
        let detection = self.detector.detect(cloud, up_in_camera, seed as u64);
        let mut found = MatchedSegments {
            is_detected: vec![false; scene.objects.len()],
            ..MatchedSegments::default()
        };
        let n_visible = visible_pixels(scene, points, mask);
        let candidates = detection.candidates.iter();
        for candidate in candidates.filter(|candidate| candidate.is_hypothesis()) {
            let indices = detection.points_of(candidate);
            let in_world = |&index: &u32| world_from_camera * points[index as usize].position();
            let places: Vec<Point3<f64>> = indices.iter().map(in_world).collect();
            if is_furniture(scene, &places) {
                continue;
            }
            found.n_segments += 1;
            if let Some(object) = matched_object(scene, indices, mask, &n_visible) {
                found.is_detected[object] = true;
            } else {
                let fragment = places.iter().map(|place| place.cast::<f32>().into());
                found.fragments.push(fragment.collect());
            }
        }
        Ok(found)
    }
}

/// `true` for a segment of the bin's walls or outside of the workspace.
fn is_furniture(scene: &BinScene, places: &[Point3<f64>]) -> bool {
    let is_other = |place: &&Point3<f64>| {
        !scene.workspace.contains(place) || scene.workspace.is_at_wall(place)
    };
    let n_other = places.iter().filter(is_other).count();
    n_other as f64 > MOST * places.len() as f64
}

/// Number of pixels with depth of each object.
fn visible_pixels(scene: &BinScene, points: &[Point], mask: &[u16]) -> Vec<usize> {
    let count = |id: u16| {
        let pixels = mask.iter().zip(points);
        pixels
            .filter(|(m, point)| **m == id && point.is_finite())
            .count()
    };
    scene
        .objects
        .iter()
        .map(|object| count(object.id))
        .collect()
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
