//! Candidate views: camera poses to choose from, and those where the camera was.

use crate::error::Error;
use crate::planning_scene::is_pose_finite;
use geometry::RigidTransform;
use nalgebra::Vector3;

/// Greatest distance of a candidate from the middle of the scene, metres.
const DISTANCE_MAX_M: f64 = 100.0;

/// Camera poses of a decision: `world_from_camera`, camera x right, y down, z forward.
#[derive(Debug, Clone, Copy)]
pub struct CandidateViews<'a> {
    /// Candidates to choose from.
    pub world_from_candidates: &'a [RigidTransform],
    /// Current camera.
    pub world_from_current: RigidTransform,
    /// Earlier cameras, not to be chosen again.
    pub world_from_visited: &'a [RigidTransform],
}

impl CandidateViews<'_> {
    /// Checks the poses.
    ///
    /// # Errors
    /// No candidates, a pose that is not finite, or a candidate more than 100 m from the middle of
    /// the scene.
    pub(crate) fn check(&self, middle_in_world: &Vector3<f64>) -> Result<(), Error> {
        let index_of_bad = |poses: &[RigidTransform]| poses.iter().position(|p| !is_pose_finite(p));
        let current = [self.world_from_current];
        for (what, poses) in [
            ("candidate view", self.world_from_candidates),
            ("the current view", &current),
            ("visited view", self.world_from_visited),
        ] {
            if let Some(index) = index_of_bad(poses) {
                return Err(Error::NotFinite { what, index });
            }
        }
        if self.world_from_candidates.is_empty() {
            return Err(Error::NoCandidates);
        }
        let is_far = |pose: &RigidTransform| {
            (pose.translation.vector - middle_in_world).norm() > DISTANCE_MAX_M
        };
        match self.world_from_candidates.iter().position(is_far) {
            Some(index) => Err(Error::FarView(index)),
            None => Ok(()),
        }
    }
}
