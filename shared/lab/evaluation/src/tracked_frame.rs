//! Ground truth and tracker output of one frame.

use crate::clear_mot::ScoredPosition;
use crate::true_shape::Symmetry;
use geometry::{OrientedBox, RigidTransform};

/// Ground truth of an object in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundTruthObject {
    /// Object number in the scene.
    pub id: u64,
    /// True pose of the object.
    pub world_from_object: RigidTransform,
    /// Upright bounding box of the object's whole surface, world frame.
    pub whole_box: OrientedBox,
    /// Upright bounding box of the surface seen so far, world frame; `None` before anything was
    /// seen.
    pub seen_box: Option<OrientedBox>,
    /// Rotations that leave the object's box unchanged.
    pub symmetry: Symmetry,
    /// Distance of the object from the camera, metres.
    pub range_m: f64,
    /// `true` if at least one pixel shows the object.
    pub is_visible: bool,
    /// `true` if enough is visible that it must be tracked; only then it is scored.
    pub counts: bool,
}

impl GroundTruthObject {
    /// Reference box of the comparison: of the surface seen so far, otherwise of the whole
    /// surface.
    pub fn reference_box(&self) -> &OrientedBox {
        self.seen_box.as_ref().unwrap_or(&self.whole_box)
    }

    pub(crate) fn scored_position(&self) -> ScoredPosition {
        ScoredPosition {
            id: self.id,
            position: self.reference_box().centre(),
            counts: self.counts,
        }
    }
}

/// Published state of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackState {
    /// Track-id of the estimated track.
    pub id: u64,
    /// `true` if the track is confirmed and was seen in this frame; only such tracks are scored.
    pub is_output: bool,
    /// Bounding box of the track in the world frame.
    pub box_in_world: OrientedBox,
}

impl TrackState {
    pub(crate) fn scored_position(&self) -> ScoredPosition {
        ScoredPosition {
            id: self.id,
            position: self.box_in_world.centre(),
            counts: true,
        }
    }
}

/// Pixels of a track's observation in a frame, by the objects that they show.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackPixels {
    /// Track-id of the track.
    pub track: u64,
    /// Number of pixels of the observation.
    pub n_pixels: usize,
    /// Pixels of each object in the observation.
    pub of_objects: Vec<ObjectPixels>,
}

/// Pixels of one object in a track's observation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectPixels {
    /// Object number in the scene.
    pub object: u64,
    /// Number of the observation's pixels that show the object.
    pub n_pixels: usize,
    /// Share of the object's visible pixels that the observation has, 0 to 1.
    pub share_of_object: f64,
}

/// Ground truth and tracks of one frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackedFrame {
    /// Time since the start of the run, seconds.
    pub time_s: f64,
    /// True objects in the scene.
    pub objects: Vec<GroundTruthObject>,
    /// All live tracks of the frame.
    pub tracks: Vec<TrackState>,
    /// Pixels of the tracks that were seen in this frame; empty without an object mask.
    pub pixels: Vec<TrackPixels>,
    /// Ids of the output tracks that are made of a person; empty where that is not known.
    pub tracks_of_people: Vec<u64>,
    /// Ids of the tracks that ended in this frame.
    pub ended: Vec<u64>,
}
