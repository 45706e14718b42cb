//! Scene motion: the frames since something last moved in front of the camera, or the camera itself.
//!
//! A new candidate in a scene at rest is probably another cut through the objects that were there
//! before.

use crate::candidate_measurement::is_handled;
use crate::frame_pose::FramePose;
use crate::track::Track;
use detection::Detection;
use geometry::RigidTransform;
use tracking::{ArrivalPrior, OcclusionState};

/// Number of frames without motion after which the scene is at rest: those of the existence test
/// beside a larger cluster, and some more. Chosen.
const N_FRAMES_AT_REST: u32 = 18;

/// Shift of the camera that counts as motion, metres. Chosen.
const CAMERA_SHIFT_M: f64 = 0.002;

/// Turn of the camera that counts as motion, radians: 2 mm at 1 m. Chosen.
const CAMERA_TURN_RAD: f64 = 0.002;

/// Camera pose of the last motion, and the number of frames since.
#[derive(Debug, Clone, Copy)]
struct LastMotion {
    n_frames_since: u32,
    world_from_camera: RigidTransform,
}

/// Watch on motion in the scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct SceneMotion(Option<LastMotion>);

impl SceneMotion {
    /// Takes account of a frame: its bodies, the pose of the camera, and the tracks after
    /// association. The first frame counts as motion, and one of another scene: without the table
    /// of the tracks.
    pub(crate) fn update(
        &mut self,
        detection: &Detection,
        frame: &FramePose,
        tracks: &[Track],
        is_another_scene: bool,
    ) {
        let is_elsewhere = self.0.is_none_or(|last| last.is_seen_from_elsewhere(frame));
        let has_changed = is_another_scene || is_elsewhere;
        if has_changed || detection.candidates.iter().any(is_handled) || tracks.iter().any(has_left)
        {
            self.0 = Some(LastMotion {
                n_frames_since: 0,
                world_from_camera: frame.world_from_camera,
            });
        } else if let Some(last) = &mut self.0 {
            last.n_frames_since = last.n_frames_since.saturating_add(1);
        }
    }

    /// Prior probability that something arrives in the last frame.
    pub(crate) fn arrival_prior(&self) -> ArrivalPrior {
        let is_at_rest = |last: LastMotion| last.n_frames_since >= N_FRAMES_AT_REST;
        if self.0.is_some_and(is_at_rest) {
            ArrivalPrior::SceneAtRest
        } else {
            ArrivalPrior::Even
        }
    }

    /// Begins anew: the next frame is the first of a scene.
    pub(crate) fn clear(&mut self) {
        self.0 = None;
    }
}

impl LastMotion {
    fn is_seen_from_elsewhere(&self, frame: &FramePose) -> bool {
        let now_from_then = frame.world_from_camera.inverse() * self.world_from_camera;
        now_from_then.translation.vector.norm() > CAMERA_SHIFT_M
            || now_from_then.rotation.angle() > CAMERA_TURN_RAD
    }
}

/// True if a track's object is not in its place any more.
fn has_left(track: &Track) -> bool {
    track.unmatched == Some(OcclusionState::Empty)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ArrivalPrior::{Even, SceneAtRest};

    #[test]
    fn scene_is_at_rest_until_the_camera_moves_or_the_table_is_another() {
        let mut motion = SceneMotion::default();
        let mut prior_after = |n_frames: u32, x_m: f64, is_another_scene: bool| {
            let frame = FramePose {
                capture_ns: 1,
                world_from_camera: RigidTransform::translation(x_m, 0.0, 0.0),
                up_in_camera: None,
                camera: None,
            };
            for _ in 0..n_frames {
                motion.update(&Detection::default(), &frame, &[], is_another_scene);
            }
            motion.arrival_prior()
        };
        assert_eq!(prior_after(18, 0.0, false), Even);
        assert_eq!(prior_after(1, 0.001, false), SceneAtRest);
        assert_eq!(prior_after(18, 0.01, false), Even);
        assert_eq!(prior_after(1, 0.01, false), SceneAtRest);
        assert_eq!(prior_after(1, 0.01, true), Even);
    }
}
