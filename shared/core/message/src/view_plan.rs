//! Plan of the next best view: the rated camera poses, best first.

use crate::SCHEMA_VERSION;
use crate::pose::WirePose;
use bytemuck::{AnyBitPattern, Zeroable};
use geometry::RigidTransform;
use iceoryx2::prelude::ZeroCopySend;

/// Maximum number of views in one plan.
pub const MAX_PLANNED_VIEWS: usize = 256;

coded_enum::coded_enum! {
    /// State of a candidate view, as a code in [`PlannedView::state`].
    pub enum ViewState: u32 {
        /// View that can be chosen.
        Open, "open";
        /// View that was taken already.
        Visited, "visited";
        /// Place of the camera within an object or at a surface.
        Blocked, "blocked";
        /// Place of the camera below the plane of the table.
        BelowTable, "below-table";
    }
}

/// Header of a plan of the next best view. The payload is the views: the chosen one first, then
/// the others by rank, then those that cannot be chosen.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ViewPlanHeader.v1")]
#[repr(C)]
pub struct ViewPlanHeader {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// 1 when poses are in the world; 0 when the camera's pose is unknown, and they are in the
    /// frame of the camera as it was.
    pub has_world_pose: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
    /// Session number of the camera.
    pub session: u64,
    /// Sequence number of the frame that the plan is made from.
    pub sequence: u64,
    /// Capture time of that frame, nanoseconds.
    pub capture_ns: u64,
    /// Pose of the camera in that frame: `world_from_camera`, the identity when it is unknown.
    pub world_from_camera: WirePose,
    /// Viewpoint entropy of the view from that pose, bit.
    pub entropy: f64,
    /// Number of candidate views; larger than the payload when they do not all fit.
    pub n_candidates: u32,
    /// Number of object hypotheses.
    pub n_objects: u32,
}

const _: () = assert!(size_of::<ViewPlanHeader>() == 112);

/// Rated camera pose of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.PlannedView.v1")]
#[repr(C)]
pub struct PlannedView {
    /// Pose of the camera, `world_from_camera`: x right, y down, z forward.
    pub world_from_camera: WirePose,
    /// Viewpoint entropy, bit.
    pub entropy: f64,
    /// Information gain: share of the unknown space that would be seen, 0 to 1.
    pub gain: f64,
    /// Weight by the distance from the present and the visited views, 0 to 1.
    pub weight: f64,
    /// Utility: the weighted entropy with the weighted gain.
    pub utility: f64,
    /// State of the view: code of a [`ViewState`].
    pub state: u32,
    /// Rank by utility, from 1; 0 for a view that cannot be chosen.
    pub rank: u32,
    /// 1 for the chosen view.
    pub is_chosen: u32,
    /// Number of objects that would be seen.
    pub n_objects_seen: u32,
}

const _: () = assert!(size_of::<PlannedView>() == 104);

impl Default for ViewPlanHeader {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            ..Self::zeroed()
        }
    }
}

/// Validated content of a planned view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckedView {
    /// Pose of the camera.
    pub world_from_camera: RigidTransform,
    /// State of the view.
    pub state: ViewState,
}

impl PlannedView {
    /// Validates the pose, the numbers and the state; `None` when one of them is impossible.
    pub fn checked(&self) -> Option<CheckedView> {
        let is_share = |share: f64| (0.0..=1.0).contains(&share);
        let is_positive = |number: f64| number.is_finite() && number >= 0.0;
        let are_possible = is_share(self.gain)
            && is_share(self.weight)
            && is_positive(self.entropy)
            && is_positive(self.utility);
        let state = ViewState::from_code(self.state)?;
        are_possible.then_some(CheckedView {
            world_from_camera: self.world_from_camera.checked()?,
            state,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_survive_the_wire_and_others_are_none() {
        for state in ViewState::ALL {
            assert_eq!(ViewState::from_code(state.code()), Some(state));
        }
        assert_eq!(ViewState::from_code(4), None);
    }

    #[test]
    fn impossible_views_are_refused() {
        let pose = RigidTransform::translation(0.1, 0.2, 0.3);
        let view = PlannedView {
            world_from_camera: WirePose::from(&pose),
            entropy: 1.5,
            gain: 0.25,
            weight: 1.0,
            utility: 2.25,
            state: ViewState::Visited.code(),
            ..PlannedView::default()
        };
        let checked = view.checked().unwrap();
        assert_eq!(
            (checked.world_from_camera, checked.state),
            (pose, ViewState::Visited)
        );
        for wrong in [
            PlannedView { gain: 1.1, ..view },
            PlannedView {
                weight: f64::NAN,
                ..view
            },
            PlannedView {
                entropy: -1.0,
                ..view
            },
            PlannedView {
                utility: f64::INFINITY,
                ..view
            },
            PlannedView { state: 9, ..view },
            PlannedView {
                world_from_camera: WirePose::default(),
                ..view
            },
        ] {
            assert_eq!(wrong.checked(), None, "{wrong:?}");
        }
    }
}
