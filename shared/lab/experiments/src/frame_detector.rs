//! Detection of single frames: without priors, as if nothing was seen before.

use detection::{Config, Detection, DetectionInput, Execution, ScenePriors, Workspace, detect};
use geometry::RigidTransform;
use nalgebra::{Unit, UnitVector3};
use point_cloud::OrganizedCloud;

/// Up direction of the world, camera frame.
pub(crate) fn up_in_camera(
    world_from_camera: &RigidTransform,
    up_in_world: &UnitVector3<f64>,
) -> UnitVector3<f64> {
    Unit::new_normalize(world_from_camera.rotation.inverse() * up_in_world.into_inner())
}

/// Detector of single frames with its buffers.
#[derive(Debug, Default)]
pub(crate) struct FrameDetector {
    config: Config,
    workspace: Workspace,
    detection: Detection,
}

impl FrameDetector {
    /// Detects the candidates of a frame; one that detection refuses has none.
    pub(crate) fn detect(
        &mut self,
        cloud: OrganizedCloud<'_>,
        up_in_camera: Option<UnitVector3<f64>>,
    ) -> &Detection {
        let frame = DetectionInput {
            cloud,
            up_in_camera,
            priors: ScenePriors::default(),
        };
        let detected = detect(
            &frame,
            &self.config,
            &mut self.workspace,
            &mut self.detection,
            Execution::default(),
        );
        if detected.is_err() {
            self.detection = Detection::default();
        }
        &self.detection
    }

    /// Result of the last frame.
    pub(crate) fn detection(&self) -> &Detection {
        &self.detection
    }
}
