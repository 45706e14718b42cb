//! The arm in the physics: it pushes what it meets, stops when it meets too
//! much, and holds what its fingers close on well enough.

mod grip;
mod protection;

use crate::object_model::compound;
use crate::physics::{BodyId, Physics, STEPS_PER_SECOND};
use crate::world::SceneObject;
use arm_kinematics::{
    Arm, ArmMotion, BodyPoses, Command, CommandState, HOME, JointVector, LinkMeshes, MotionState,
    Path,
};
use geometry::{Capsule, RigidTransform};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rapier3d::prelude::SharedShape;
use std::sync::Arc;

/// Share of the joints' greatest velocities in ordinary motion.
const SPEED: f64 = 1.0;
/// Share along straight lines, which lead to objects.
const LINE_SPEED: f64 = 0.5;

/// Where the arm stands: its mounting plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmMount {
    /// World frame, metres.
    pub position_m: [f64; 3],
    /// Direction it faces, degrees from world x.
    pub yaw_deg: f64,
}

impl Default for ArmMount {
    /// At the near left corner of the default table, facing its middle; folded,
    /// the arm is out of the default camera's view.
    fn default() -> Self {
        Self {
            position_m: [-0.44, -0.50, 0.70],
            yaw_deg: 50.0,
        }
    }
}

impl ArmMount {
    /// Pose of the base frame.
    pub fn world_from_base(&self) -> RigidTransform {
        RigidTransform::from_parts(
            Translation3::from(Vector3::from(self.position_m)),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians()),
        )
    }
}

/// What an arm can be told; poses in the world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArmCommand {
    /// Bring the gripper to a pose.
    MoveTo {
        /// The gripper's pose: z forward, x closing.
        world_from_gripper: RigidTransform,
        /// Whether on a straight line.
        is_straight: bool,
    },
    /// Bring the joints to angles, radians.
    MoveJoints([f64; 6]),
    /// Fold away.
    Home,
    /// Open wide and let go.
    Open,
    /// Close until the fingers hold something or meet.
    Close,
    /// Stand still at once.
    Stop,
}

/// How the arm is.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmStatus {
    /// What it does.
    pub motion: MotionState,
    /// Joint angles, radians.
    pub joint_angles_rad: [f64; 6],
    /// Joint velocities, radians a second.
    pub joint_velocities_rad_s: [f64; 6],
    /// Distance between the pads, metres.
    pub opening_m: f64,
    /// Pose of the gripper.
    pub world_from_gripper: RigidTransform,
    /// The object it holds.
    pub holds: Option<u16>,
    /// The command that was given last; 0 before the first.
    pub command_id: u64,
    /// Why the last command failed.
    pub failure: Option<String>,
}

/// What never changes of an arm.
#[derive(Debug)]
pub(crate) struct ArmParts {
    pub(crate) meshes: LinkMeshes,
    shapes: Vec<SharedShape>,
}

/// An object between the fingers.
#[derive(Debug, Clone)]
struct Gripped {
    object: u16,
    body: BodyId,
    gripper_from_object: RigidTransform,
}

/// The arm while the world runs.
#[derive(Debug, Clone)]
pub(crate) struct SimulatedArm {
    pub(crate) parts: Arc<ArmParts>,
    world_from_base: RigidTransform,
    motion: ArmMotion,
    /// Base and links, rail, fingers.
    bodies: Vec<BodyId>,
    gripped: Option<Gripped>,
    /// Commands so far, refused ones too.
    n_commands: u64,
    command_id: u64,
    failure: Option<String>,
    guard: protection::Guard,
}

impl SimulatedArm {
    /// Puts an arm into the physics, folded; `None` when its model is broken.
    pub(crate) fn new(mount: &ArmMount, physics: &mut Physics) -> Option<Self> {
        let arm = Arm::jaco_like();
        let meshes = LinkMeshes::new(&arm);
        let solids = meshes
            .links
            .iter()
            .chain([&meshes.rail, &meshes.finger, &meshes.finger]);
        let shapes = solids.map(|solid| compound(&solid.convex_parts));
        let shapes = shapes.collect::<Option<Vec<_>>>()?;
        let motion = ArmMotion::new(arm, JointVector::from(HOME)).ok()?;
        let world_from_base = mount.world_from_base();
        let poses = in_world(&motion.body_poses(), &world_from_base);
        let bodies = shapes.iter().zip(&poses);
        let bodies = bodies
            .map(|(shape, pose)| physics.add_moved(shape, pose))
            .collect();
        Some(Self {
            parts: Arc::new(ArmParts { meshes, shapes }),
            world_from_base,
            motion,
            bodies,
            gripped: None,
            n_commands: 0,
            command_id: 0,
            failure: None,
            guard: protection::Guard::default(),
        })
    }

    /// Gives the arm a command, which replaces what is still being done; its
    /// number is returned. One that is refused changes nothing.
    pub(crate) fn command(&mut self, command: &ArmCommand) -> Result<u64, String> {
        self.n_commands += 1;
        let id = self.n_commands;
        let told = match *command {
            ArmCommand::MoveTo {
                world_from_gripper,
                is_straight,
            } => Command::MoveTo {
                base_from_tool: self.world_from_base.inv_mul(&world_from_gripper),
                path: if is_straight {
                    Path::Straight
                } else {
                    Path::Joint
                },
                speed: if is_straight { LINE_SPEED } else { SPEED },
            },
            ArmCommand::MoveJoints(angles_rad) => Command::MoveJoints {
                joints_rad: JointVector::from(angles_rad),
                speed: SPEED,
            },
            ArmCommand::Home => Command::MoveJoints {
                joints_rad: JointVector::from(HOME),
                speed: SPEED,
            },
            ArmCommand::Open => Command::Open {
                opening_m: self.motion.arm().gripper().max_opening_m,
            },
            ArmCommand::Close => Command::Close,
            ArmCommand::Stop => Command::Stop,
        };
        self.motion
            .retarget(id, told)
            .map_err(|error| error.to_string())?;
        self.command_id = id;
        self.failure = None;
        self.guard.begin();
        Ok(id)
    }

    /// Goes on for one step, before the physics does.
    pub(crate) fn step(&mut self, physics: &mut Physics, objects: &mut [SceneObject]) {
        let before = self.motion.clone();
        let touched = self.touched_by_both(physics);
        // The physics sees no contact with what is held: it follows the hand.
        let is_stopped = touched.is_some() || self.gripped.is_some();
        self.motion
            .step(1.0 / f64::from(STEPS_PER_SECOND), is_stopped);
        self.take_over_failure();
        if self.motion.state() == MotionState::Opening {
            self.release(physics, objects);
        }
        if self.has_closed(&before) {
            self.try_to_hold(touched, physics, objects);
        }
        if let Some(sentence) = self.obstacle(&before, physics, objects) {
            self.motion = before;
            self.halt(sentence);
        }
        self.follow(physics);
    }

    /// Whether the fingers came to rest in this step after closing, with nothing
    /// between them yet.
    fn has_closed(&self, before: &ArmMotion) -> bool {
        before.state() == MotionState::Closing
            && self.gripped.is_none()
            && self.motion.command_state(self.command_id) == Some(CommandState::Done)
    }

    /// Stops for a reason that is told.
    fn halt(&mut self, sentence: String) {
        self.n_commands += 1;
        let stopping = self.n_commands;
        // Stopping can not be refused.
        let _ = self.motion.submit(stopping, Command::Stop);
        self.failure = Some(sentence);
    }

    fn take_over_failure(&mut self) {
        if self.failure.is_none()
            && let Some(CommandState::Failed(error)) = self.motion.command_state(self.command_id)
        {
            self.failure = Some(error.to_string());
        }
    }

    /// Sends the bodies, and what is held, to where the joints are.
    fn follow(&self, physics: &mut Physics) {
        for (body, pose) in self.bodies.iter().zip(self.poses()) {
            physics.move_to(*body, &pose);
        }
        if let Some(gripped) = &self.gripped {
            let pose = self.world_from_gripper() * gripped.gripper_from_object;
            physics.move_to(gripped.body, &pose);
        }
    }

    /// Poses of base and links, rail and fingers, world frame.
    pub(crate) fn poses(&self) -> [RigidTransform; 10] {
        in_world(&self.motion.body_poses(), &self.world_from_base)
    }

    pub(crate) fn world_from_gripper(&self) -> RigidTransform {
        self.world_from_base * self.motion.body_poses().base_from_tool
    }

    /// Capsules that contain the arm, world frame.
    pub(crate) fn capsules(&self) -> Vec<Capsule> {
        let joints = &self.motion.joints().angles_rad;
        let opening_m = self.motion.gripper().opening_m();
        let capsules = arm_kinematics::link_capsules(self.motion.arm(), joints, opening_m);
        capsules
            .iter()
            .map(|capsule| capsule.transformed(&self.world_from_base))
            .collect()
    }

    pub(crate) fn status(&self) -> ArmStatus {
        let joints = self.motion.joints();
        // A command that was just given begins with the next step.
        let is_accepted =
            self.motion.command_state(self.command_id) == Some(CommandState::Accepted);
        ArmStatus {
            motion: if is_accepted {
                MotionState::Moving
            } else {
                self.motion.state()
            },
            joint_angles_rad: joints.angles_rad.into(),
            joint_velocities_rad_s: joints.velocities_rad_s.into(),
            opening_m: self.motion.gripper().opening_m(),
            world_from_gripper: self.world_from_gripper(),
            holds: self.gripped.as_ref().map(|gripped| gripped.object),
            command_id: self.command_id,
            failure: self.failure.clone(),
        }
    }
}

fn in_world(poses: &BodyPoses, world_from_base: &RigidTransform) -> [RigidTransform; 10] {
    let [l0, l1, l2, l3, l4, l5, l6] = poses.base_from_link;
    let [f0, f1] = poses.base_from_finger;
    [l0, l1, l2, l3, l4, l5, l6, poses.base_from_tool, f0, f1]
        .map(|base_from_body| world_from_base * base_from_body)
}
