//! Scene priors: the known bodies and tracks in view before a frame is searched.

use detection::{BodyMap, ExpectedTrack, ScenePriors};
use geometry::{Capsule, Plane, RigidTransform};

/// Capsules of a body in the camera frame, or an unknown body.
#[derive(Debug, Default)]
pub(crate) struct BodyPrior {
    is_known: bool,
    capsules: Vec<Capsule>,
}

impl BodyPrior {
    pub(crate) fn set(
        &mut self,
        capsules_in_world: Option<&[Capsule]>,
        camera_from_world: Option<&RigidTransform>,
    ) {
        self.capsules.clear();
        self.is_known = capsules_in_world.is_some() && camera_from_world.is_some();
        if let (Some(capsules), Some(camera_from_world)) = (capsules_in_world, camera_from_world) {
            let in_camera = capsules
                .iter()
                .map(|capsule| capsule.transformed(camera_from_world));
            self.capsules.extend(in_camera);
        }
    }

    fn capsules(&self) -> Option<&[Capsule]> {
        self.is_known.then_some(&self.capsules)
    }
}

/// Buffers of the scene priors of a frame, camera frame; reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct PriorBuffers {
    pub(crate) robot: BodyPrior,
    pub(crate) people: BodyPrior,
    /// Bodies found in depth in the previous frame.
    pub(crate) bodies: BodyMap,
    /// Planes of the surfaces of earlier frames, predicted to the frame's capture, the table first.
    pub(crate) surfaces: Vec<Plane>,
    /// Live tracks, predicted to the frame's capture.
    pub(crate) tracks: Vec<ExpectedTrack>,
}

impl PriorBuffers {
    /// View of the priors as the input of detection.
    pub(crate) fn priors(&self) -> ScenePriors<'_> {
        ScenePriors {
            instructor: self.people.capsules(),
            robot: self.robot.capsules(),
            bodies: Some(&self.bodies),
            surfaces: &self.surfaces,
            tracks: &self.tracks,
            ..ScenePriors::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    #[test]
    fn bodies_are_in_the_camera_frame_or_unknown() {
        let at_half_metre = Point3::new(0.5, 0.0, 0.0);
        let capsules = [Capsule {
            from: at_half_metre,
            to: at_half_metre,
            radius_m: 0.1,
        }];
        let camera_from_world = RigidTransform::new(Vector3::x() * 0.25, Vector3::zeros());
        let mut priors = PriorBuffers::default();
        priors.robot.set(Some(&capsules), Some(&camera_from_world));
        priors.people.set(Some(&capsules), None);
        let given = priors.priors();
        assert_eq!(given.robot.map(|body| body[0].from.x), Some(0.75));
        assert_eq!(given.instructor, None);
        priors.robot.set(None, Some(&camera_from_world));
        assert_eq!(priors.priors().robot, None);
    }
}
