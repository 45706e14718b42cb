//! What is truly there in a frame, and what the tracker says of it.

use crate::clear_mot::Placed;
use crate::true_shape::Symmetry;
use geometry::{OrientedBox, RigidTransform};

/// One object as it truly is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueObject {
    /// Number in the scene.
    pub id: u64,
    /// Its pose.
    pub world_from_object: RigidTransform,
    /// The upright box around its whole surface, world frame.
    pub whole_box: OrientedBox,
    /// The upright box around what was seen of it so far; `None` before anything was.
    pub seen_box: Option<OrientedBox>,
    /// Turns that leave its box as it is.
    pub symmetry: Symmetry,
    /// Distance from the camera, metres.
    pub range_m: f64,
    /// Whether it shows a pixel.
    pub is_visible: bool,
    /// Whether it must be tracked: enough of it is seen.
    pub counts: bool,
}

impl TrueObject {
    /// The box that a tracker can know of.
    pub fn reference_box(&self) -> &OrientedBox {
        self.seen_box.as_ref().unwrap_or(&self.whole_box)
    }

    pub(crate) fn placed(&self) -> Placed {
        Placed {
            id: self.id,
            position: self.reference_box().centre(),
            counts: self.counts,
        }
    }
}

/// One track as it is published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackState {
    /// The track-id.
    pub id: u64,
    /// Whether it was seen in this frame and is believed; only such are compared.
    pub is_output: bool,
    /// Its box, world frame.
    pub box_in_world: OrientedBox,
}

impl TrackState {
    pub(crate) fn placed(&self) -> Placed {
        Placed {
            id: self.id,
            position: self.box_in_world.centre(),
            counts: true,
        }
    }
}

/// One frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackedFrame {
    /// Since the beginning, seconds.
    pub time_s: f64,
    /// The objects that are in the scene.
    pub objects: Vec<TrueObject>,
    /// All live tracks.
    pub tracks: Vec<TrackState>,
    /// Tracks that ended in this frame.
    pub ended: Vec<u64>,
}
