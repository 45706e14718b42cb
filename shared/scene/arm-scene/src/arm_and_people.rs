//! Arm and people beside the objects, as the daemon publishes them.

use arm_kinematics::{Arm, ArmDimensions, GripperModel, JointVector};
use channel::topic::{ArmStates, PersonBodies};
use channel::{Domain, Error, Received, Subscriber};
use geometry::{Capsule, RigidTransform};
use grasp_scene::{SceneBodies, placed_arm};
use grasping::PlacedArm;
use message::WireCapsule;
use scene_client::{PlanningFrame, Snapshot};
use service::Failure;
use std::time::{Duration, Instant};

/// Time for which a state of the arm is awaited: it comes a hundred times a second where there is
/// one.
const ARM_PATIENCE: Duration = Duration::from_millis(300);
const POLL_PERIOD: Duration = Duration::from_millis(5);

/// Arm and people of the daemon.
pub struct ArmAndPeople {
    arms: Subscriber<ArmStates>,
    people: Subscriber<PersonBodies>,
    arm: Option<(JointVector, RigidTransform)>,
    /// Bodies in the world.
    pub in_world: SceneBodies,
}

impl ArmAndPeople {
    /// Joins the topics.
    ///
    /// # Errors
    /// When a topic has no room for another subscriber, or shared memory fails.
    pub fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            arms: Subscriber::polled(domain)?,
            people: Subscriber::polled(domain)?,
            arm: None,
            in_world: SceneBodies::default(),
        })
    }

    /// Receives the newest states; the first one of an arm is awaited for a moment.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn receive(&mut self) -> Result<(), Failure> {
        let begun = Instant::now();
        self.receive_arm()?;
        while self.arm.is_none() && begun.elapsed() < ARM_PATIENCE {
            std::thread::sleep(POLL_PERIOD);
            self.receive_arm()?;
        }
        while let Received::Message(message) = self.people.receive()? {
            self.in_world.people = checked(message.items());
        }
        Ok(())
    }

    fn receive_arm(&mut self) -> Result<(), Failure> {
        while let Received::Message(message) = self.arms.receive()? {
            let state = message.header();
            let joints = JointVector::from(state.joint_angles_rad);
            self.arm = state
                .world_from_gripper
                .checked()
                .map(|pose| (joints, pose));
            self.in_world.robot = checked(message.items());
        }
        Ok(())
    }

    /// Arm in the frame of planning; `None`, and a note, where its place is not known.
    pub fn placed(
        &self,
        gripper: GripperModel,
        snapshot: &Snapshot,
        frame: &PlanningFrame,
        notes: &mut Vec<String>,
    ) -> Option<PlacedArm> {
        let Some((joints, world_from_gripper)) = &self.arm else {
            notes.push("no arm is there, so that nothing is said about its reach".to_owned());
            return None;
        };
        if snapshot.world_from_camera.is_none() {
            notes.push(
                "the pose of the camera is unknown, so that nothing is said about the arm's reach"
                    .to_owned(),
            );
            return None;
        }
        let arm = Arm::new(ArmDimensions::JACO_LIKE, gripper);
        Some(placed_arm(arm, *joints, world_from_gripper, frame))
    }
}

/// Valid capsules, copied out of shared memory first.
fn checked(capsules: &[WireCapsule]) -> Vec<Capsule> {
    let capsules = capsules.iter().copied();
    capsules.filter_map(|capsule| capsule.checked()).collect()
}
