//! Pixels of the tracks of a frame, by the objects that the mask shows there.

use super::tracking_pipeline::TrackingPipeline;
use evaluation::tracked_frame::{ObjectPixels, TrackPixels};
use std::collections::BTreeMap;

/// Pixels of the tracks that were seen in the last frame; `mask` has the object number of each
/// pixel, 0 for none.
pub(super) fn track_pixels(tracker: &TrackingPipeline, mask: &[u16]) -> Vec<TrackPixels> {
    let detection = tracker.state().detection();
    let n_visible = counts(mask.iter().copied());
    let pixels = |sighting: &pipeline::Sighting| {
        let points = detection.points_of(&detection.candidates[sighting.candidate]);
        let of_mask = points.iter().filter_map(|&point| mask.get(point as usize));
        let of_objects = counts(of_mask.copied()).into_iter();
        let of_objects = of_objects.map(|(object, n_pixels)| ObjectPixels {
            object: u64::from(object),
            n_pixels,
            share_of_object: n_pixels as f64 / n_visible[&object] as f64,
        });
        TrackPixels {
            track: sighting.track_id,
            n_pixels: points.len(),
            of_objects: of_objects.collect(),
        }
    };
    tracker.update().sightings.iter().map(pixels).collect()
}

/// Number of pixels of each object.
fn counts(objects: impl Iterator<Item = u16>) -> BTreeMap<u16, usize> {
    let mut counts = BTreeMap::new();
    for object in objects.filter(|object| *object > 0) {
        *counts.entry(object).or_insert(0) += 1;
    }
    counts
}
