//! Arm of the skeleton: motions become paths of its joints, which its motors follow.

use super::motors::{HOLD_TIME_S, Measured, Motors};
use arm_driver::{Arm as DrivenArm, ArmReading, BrakingCause, CYCLE, CyclicArm, commanded_pose};
use arm_kinematics::{
    Arm, ArmController, Command, CommandState, FingerContact, HOME, JointVector, MotionState,
    N_JOINTS, PathKind, link_capsules,
};
use control_protocol::ArmMotion;
use geometry::RigidTransform;
use message::{ArmActivity, WireCapsule, WirePose};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// Place of the arm's base, world frame, metres. Measure yours.
const BASE_M: [f64; 3] = [-0.44, -0.50, 0.70];
/// Turn of the base about the vertical, radians. Measure yours.
const BASE_YAW_RAD: f64 = 0.873;
/// Share of the joint limits' velocities at which the arm moves. Chosen.
const SPEED: f64 = 0.9;
/// Share of them for straight lines, which lead to objects. Chosen.
const LINE_SPEED: f64 = 0.45;
/// Velocity that corrects a distance from the path, 1/s. Chosen: a hundredth of it is left after
/// half a second.
const CORRECTION_PER_S: f64 = 10.0;
/// Largest distance of a joint from its path, radians: the arm has met something. Chosen.
const MAX_DISTANCE_RAD: f64 = 0.2;
/// Distances from the end of a path at which a motion has ended: radians, and metres of the fingers.
/// Chosen.
const ARRIVED_RAD: f64 = 0.005;
const ARRIVED_M: f64 = 0.001;

/// Arm whose controller makes paths, and whose motors follow them.
pub(crate) struct SkeletonArm<M> {
    motors: M,
    controller: ArmController,
    measured: Measured,
    world_from_base: RigidTransform,
    command_id: u64,
    failure: Option<String>,
    /// Time of the last cycle, monotonic, nanoseconds.
    cycled_ns: Option<u64>,
}

impl<M: Motors> SkeletonArm<M> {
    /// Arm where its motors are.
    ///
    /// # Errors
    /// A sentence when the arm does not answer, or stands beyond its limits.
    pub(crate) fn new(mut motors: M) -> Result<Self, String> {
        let measured = motors.measure(0)?;
        let controller =
            ArmController::new(Arm::jaco_like(), JointVector::from(measured.angles_rad))
                .map_err(|error| format!("the arm stands where it must not: {error}"))?;
        Ok(Self {
            motors,
            controller,
            measured,
            world_from_base: RigidTransform::from_parts(
                Translation3::from(Vector3::from(BASE_M)),
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), BASE_YAW_RAD),
            ),
            command_id: 0,
            failure: None,
            cycled_ns: None,
        })
    }

    /// Command of the controller for a motion.
    fn command(&self, motion: &ArmMotion) -> Result<Command, String> {
        let hand = self.controller.arm().gripper();
        Ok(match *motion {
            ArmMotion::MoveTo {
                position_m,
                orientation_xyzw,
                straight,
            } => Command::MoveTo {
                base_from_tool: self.world_from_base.inverse()
                    * commanded_pose(position_m, orientation_xyzw)?,
                path: if straight {
                    PathKind::Linear
                } else {
                    PathKind::Joint
                },
                speed: if straight { LINE_SPEED } else { SPEED },
            },
            ArmMotion::MoveJoints { angles_rad } => Command::MoveJoints {
                joints_rad: JointVector::from(angles_rad),
                speed: SPEED,
            },
            ArmMotion::Home => Command::MoveJoints {
                joints_rad: JointVector::from(HOME),
                speed: SPEED,
            },
            ArmMotion::Open => Command::Open {
                opening_m: hand.max_opening_m,
            },
            ArmMotion::OpenTo { opening_m } => Command::Open { opening_m },
            ArmMotion::Close => Command::Close,
        })
    }

    /// Joint that is far from its path, counted from 1.
    fn joint_off_path(&self) -> Option<usize> {
        let path = &self.controller.joints().angles_rad;
        let far = (0..N_JOINTS).find(|joint| {
            let distance_rad = path[*joint] - self.measured.angles_rad[*joint];
            distance_rad.is_nan() || distance_rad.abs() > MAX_DISTANCE_RAD
        });
        far.map(|joint| joint + 1)
    }

    /// True if joints and fingers are at the end of their path.
    fn has_arrived(&self) -> bool {
        let path = self.controller.joints().angles_rad.iter();
        let mut joints = path.zip(self.measured.angles_rad);
        let distance_m = self.controller.gripper().opening_m() - self.measured.opening_m;
        joints.all(|(path_rad, angle_rad)| (path_rad - angle_rad).abs() < ARRIVED_RAD)
            && distance_m.abs() < ARRIVED_M
    }

    fn activity(&self) -> ArmActivity {
        if self.failure.is_some() {
            return ArmActivity::Failed;
        }
        let is_accepted =
            self.controller.command_state(self.command_id) == Some(CommandState::Accepted);
        match self.controller.state() {
            // It begins with the next cycle.
            _ if is_accepted => ArmActivity::Moving,
            // A motion ends where the motors are, and not where its path is.
            MotionState::Idle if !self.has_arrived() => ArmActivity::Moving,
            MotionState::Idle => ArmActivity::Idle,
            MotionState::Moving => ArmActivity::Moving,
            MotionState::Opening => ArmActivity::Opening,
            MotionState::Closing => ArmActivity::Closing,
            MotionState::Stopped => ArmActivity::Stopped,
            MotionState::Failed(_) => ArmActivity::Failed,
        }
    }
}

impl<M: Motors> DrivenArm for SkeletonArm<M> {
    fn begin(&mut self, motion: &ArmMotion, _arrived_ns: u64) -> Result<(), String> {
        let command = self.command(motion)?;
        let id = self.command_id + 1;
        // A refused command has its number, too.
        self.command_id = id;
        let begun = self.controller.retarget(id, command);
        begun.map_err(|error| error.to_string())?;
        self.failure = None;
        Ok(())
    }

    fn brake(&mut self, _cause: BrakingCause) {
        // A stop is never refused; its number is not asked for.
        let _ = self.controller.submit(u64::MAX, Command::Stop);
    }

    fn reading(&self) -> Result<ArmReading, String> {
        let joints = JointVector::from(self.measured.angles_rad);
        let pose = self.world_from_base * self.controller.arm().tool_pose(&joints);
        Ok(ArmReading {
            activity: self.activity(),
            note: self.failure.clone().unwrap_or_default(),
            command_id: self.command_id,
            joint_angles_rad: self.measured.angles_rad,
            joint_velocities_rad_s: self.measured.velocities_rad_s,
            opening_m: self.measured.opening_m,
            world_from_gripper: WirePose {
                position_m: pose.translation.vector.into(),
                orientation_xyzw: pose.rotation.coords.into(),
            },
            // These fingers feel nothing.
            is_holding: false,
        })
    }
}

impl<M: Motors> CyclicArm for SkeletonArm<M> {
    fn cycle(&mut self, now_ns: u64) -> Result<(), String> {
        self.measured = self.motors.measure(now_ns)?;
        if self.failure.is_none()
            && let Some(joint) = self.joint_off_path()
        {
            self.failure = Some(format!(
                "the arm stopped: joint {joint} does not follow its path; look for what is in its \
                 way"
            ));
            self.brake(BrakingCause::Stop);
        }
        if self.failure.is_none()
            && let Some(CommandState::Failed(error)) =
                self.controller.command_state(self.command_id)
        {
            self.failure = Some(error.to_string());
        }
        let before_ns = self.cycled_ns.replace(now_ns).unwrap_or(now_ns);
        let step_s = (1e-9 * now_ns.saturating_sub(before_ns) as f64).min(HOLD_TIME_S);
        let opening_before_m = self.controller.gripper().opening_m();
        self.controller.step(step_s, FingerContact::Free);
        let (path, limits) = (
            self.controller.joints(),
            self.controller.arm().chain().joints,
        );
        let velocities_rad_s = std::array::from_fn(|joint| {
            let distance_rad = path.angles_rad[joint] - self.measured.angles_rad[joint];
            let velocity_rad_s = path.velocities_rad_s[joint] + CORRECTION_PER_S * distance_rad;
            let most_rad_s = limits[joint].max_velocity_rad_s;
            velocity_rad_s.clamp(-most_rad_s, most_rad_s)
        });
        let opening_m = self.controller.gripper().opening_m();
        let path_m_s = (opening_m - opening_before_m) / step_s.max(CYCLE.as_secs_f64());
        let opening_m_s = path_m_s + CORRECTION_PER_S * (opening_m - self.measured.opening_m);
        self.motors.send(velocities_rad_s, opening_m_s)
    }

    fn capsules(&self) -> Vec<WireCapsule> {
        let joints = JointVector::from(self.measured.angles_rad);
        let capsules = link_capsules(self.controller.arm(), &joints, self.measured.opening_m);
        capsules
            .iter()
            .map(|capsule| WireCapsule::from(&capsule.transformed(&self.world_from_base)))
            .collect()
    }
}
