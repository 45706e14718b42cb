//! Simulated arm: controller, physics bodies, collision stop, grasping and slip.

mod collision_guard;
mod grasp;
mod holding_law;
mod slip;

use crate::arm_mount::ArmMount;
use crate::object_model::compound_shape;
use crate::physics::{BodyId, Physics, STEPS_PER_SECOND};
use crate::scene_object::SimulatedObject;
use arm_kinematics::{
    Arm, ArmController, ArmDimensions, BodyPoses, Command, CommandState, FingerContact, HOME,
    JointVector, LinkMeshes, MotionState, PathKind,
};
use geometry::{Capsule, RigidTransform};
use rapier3d::prelude::SharedShape;
use std::sync::Arc;

/// Time of a step, seconds.
const STEP_S: f64 = 1.0 / STEPS_PER_SECOND as f64;
/// Speed of ordinary motion, as a share of the maximum joint velocities. Chosen.
const SPEED: f64 = 1.0;
/// Speed of straight-line motion, which leads to objects, as a share of the maximum joint
/// velocities. Chosen.
const LINE_SPEED: f64 = 0.5;

/// Command to the simulated arm; poses in the world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArmCommand {
    /// Moves the gripper of the arm to a pose.
    MoveTo {
        /// Target pose of the gripper: z forward, x in the closing direction.
        world_from_gripper: RigidTransform,
        /// True for a Cartesian straight line, false for joint-space interpolation.
        is_straight: bool,
    },
    /// Moves the joints to given angles, radians.
    MoveJoints([f64; 6]),
    /// Moves the arm to the folded home position.
    Home,
    /// Opens the gripper wide and releases the held object.
    Open,
    /// Moves the fingers to an opening, metres, and releases the held object.
    OpenTo(f64),
    /// Closes the gripper until the fingers hold an object or meet.
    Close,
    /// Brakes all joints at once and lets the fingers stand.
    Stop,
}

/// Status of the simulated arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmStatus {
    /// Motion state of the arm controller.
    pub motion: MotionState,
    /// Joint angles of the arm, radians.
    pub joint_angles_rad: [f64; 6],
    /// Joint velocities of the arm, rad/s.
    pub joint_velocities_rad_s: [f64; 6],
    /// Distance between the finger pads, metres.
    pub opening_m: f64,
    /// Pose of the gripper, world frame.
    pub world_from_gripper: RigidTransform,
    /// Number of the object that the gripper holds.
    pub holds: Option<u16>,
    /// Identity of the last accepted command; 0 before the first one.
    pub command_id: u64,
    /// Failure message of the last arm command.
    pub failure: Option<String>,
}

/// Constant geometry of the arm: meshes and collision shapes.
#[derive(Debug)]
pub(crate) struct ArmGeometry {
    pub(crate) meshes: LinkMeshes,
    shapes: Vec<SharedShape>,
}

/// Object held between the fingers.
#[derive(Debug, Clone)]
struct GraspedObject {
    object: u16,
    body: BodyId,
    gripper_from_object: RigidTransform,
    /// Pads in the frame of the gripper.
    law: holding_law::HoldingLaw,
    /// Motion of the centre of mass; `None` before the first step.
    motion: Option<slip::HeldMotion>,
}

/// Simulated arm in the running world.
#[derive(Debug, Clone)]
pub(crate) struct SimulatedArm {
    pub(crate) parts: Arc<ArmGeometry>,
    world_from_base: RigidTransform,
    controller: ArmController,
    /// Friction coefficient between pads and objects.
    pub(crate) friction: f64,
    /// Physics bodies: base and links, rail, fingers.
    bodies: Vec<BodyId>,
    grasped: Option<GraspedObject>,
    /// Number of commands so far, including rejected ones.
    n_commands: u64,
    command_id: u64,
    /// True if the newest command closes the fingers on an object.
    is_grasping: bool,
    failure: Option<String>,
    guard: collision_guard::CollisionGuard,
}

impl SimulatedArm {
    /// Adds a folded arm to the physics; `None` when a collision shape is empty.
    pub(crate) fn new(mount: &ArmMount, seed: u64, physics: &mut Physics) -> Option<Self> {
        let arm = Arm::new(ArmDimensions::JACO_LIKE, mount.gripper);
        let meshes = LinkMeshes::new(&arm);
        let solids = meshes
            .links
            .iter()
            .chain([&meshes.rail, &meshes.finger, &meshes.finger]);
        let shapes = solids.map(|solid| compound_shape(&solid.convex_parts));
        let shapes = shapes.collect::<Option<Vec<_>>>()?;
        let controller = ArmController::new(arm, JointVector::from(HOME)).ok()?;
        let world_from_base = mount.world_from_base();
        let poses = in_world(&controller.body_poses(), &world_from_base);
        let friction = grasp::drawn_friction(mount.gripper.pad_friction, seed);
        let bodies = shapes.iter().zip(&poses);
        let bodies = bodies
            .map(|(shape, pose)| physics.add_kinematic(shape, friction, pose))
            .collect();
        Some(Self {
            parts: Arc::new(ArmGeometry { meshes, shapes }),
            world_from_base,
            controller,
            friction,
            bodies,
            grasped: None,
            n_commands: 0,
            command_id: 0,
            is_grasping: false,
            failure: None,
            guard: collision_guard::CollisionGuard::default(),
        })
    }

    /// Accepts a command that replaces the current one and returns its identity. A rejected
    /// command changes nothing.
    pub(crate) fn command(&mut self, command: &ArmCommand) -> Result<u64, String> {
        self.n_commands += 1;
        let id = self.n_commands;
        let joint_command = match *command {
            ArmCommand::MoveTo {
                world_from_gripper,
                is_straight,
            } => Command::MoveTo {
                base_from_tool: self.world_from_base.inv_mul(&world_from_gripper),
                path: if is_straight {
                    PathKind::Linear
                } else {
                    PathKind::Joint
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
                opening_m: self.controller.arm().gripper().max_opening_m,
            },
            ArmCommand::OpenTo(opening_m) => Command::Open { opening_m },
            ArmCommand::Close => Command::Close,
            ArmCommand::Stop => Command::Stop,
        };
        self.controller
            .retarget(id, joint_command)
            .map_err(|error| error.to_string())?;
        self.command_id = id;
        self.is_grasping = matches!(command, ArmCommand::Close);
        self.failure = None;
        self.guard.begin();
        Ok(id)
    }

    /// Advances by one step; must be called before the physics step.
    pub(crate) fn step(&mut self, physics: &mut Physics, objects: &mut [SimulatedObject]) {
        let before = self.controller.clone();
        let touched = self.touched_by_both_fingers(physics);
        // The physics has no contacts with a held object, since it follows the hand.
        let contact = match self.grasped {
            Some(_) => FingerContact::Pressed,
            None => self.finger_contact(touched, physics),
        };
        self.controller.step(STEP_S, contact);
        self.record_failure();
        if self.controller.state() == MotionState::Opening {
            self.release(physics, objects);
        }
        if self.has_closed(&before) {
            self.try_grasp(touched, physics, objects);
        }
        if let Some(sentence) = self.collision_message(&before, physics, objects) {
            self.controller = before;
            self.halt(sentence);
            self.controller.step(STEP_S, contact);
        }
        self.slip(physics, objects);
        self.move_bodies(physics);
    }

    /// True if the fingers stopped in this step after closing and hold no object yet.
    fn has_closed(&self, before: &ArmController) -> bool {
        self.is_grasping
            && before.state() == MotionState::Closing
            && self.grasped.is_none()
            && self.controller.command_state(self.command_id) == Some(CommandState::Done)
    }

    /// Stops the arm and records the reason as its failure.
    fn halt(&mut self, sentence: String) {
        self.n_commands += 1;
        let stopping = self.n_commands;
        // A stop command is never rejected.
        let _ = self.controller.submit(stopping, Command::Stop);
        self.failure = Some(sentence);
    }

    fn record_failure(&mut self) {
        if self.failure.is_none()
            && let Some(CommandState::Failed(error)) =
                self.controller.command_state(self.command_id)
        {
            self.failure = Some(error.to_string());
        }
    }

    /// Moves the physics bodies and the held object to the current joint positions.
    fn move_bodies(&self, physics: &mut Physics) {
        for (body, pose) in self.bodies.iter().zip(self.poses()) {
            physics.move_to(*body, &pose);
        }
        if let Some(grasped) = &self.grasped {
            let pose = self.world_from_gripper() * grasped.gripper_from_object;
            physics.move_to(grasped.body, &pose);
        }
    }

    /// Poses of base and links, rail and fingers, world frame.
    pub(crate) fn poses(&self) -> [RigidTransform; 10] {
        in_world(&self.controller.body_poses(), &self.world_from_base)
    }

    pub(crate) fn world_from_gripper(&self) -> RigidTransform {
        self.world_from_base * self.controller.body_poses().base_from_tool
    }

    /// Bounding capsules of the arm, world frame.
    pub(crate) fn capsules(&self) -> Vec<Capsule> {
        let joints = &self.controller.joints().angles_rad;
        let opening_m = self.controller.gripper().opening_m();
        let capsules = arm_kinematics::link_capsules(self.controller.arm(), joints, opening_m);
        capsules
            .iter()
            .map(|capsule| capsule.transformed(&self.world_from_base))
            .collect()
    }

    pub(crate) fn status(&self) -> ArmStatus {
        let joints = self.controller.joints();
        // A newly accepted command starts with the next step.
        let is_accepted =
            self.controller.command_state(self.command_id) == Some(CommandState::Accepted);
        ArmStatus {
            motion: if is_accepted {
                MotionState::Moving
            } else {
                self.controller.state()
            },
            joint_angles_rad: joints.angles_rad.into(),
            joint_velocities_rad_s: joints.velocities_rad_s.into(),
            opening_m: self.controller.gripper().opening_m(),
            world_from_gripper: self.world_from_gripper(),
            holds: self.grasped.as_ref().map(|grasped| grasped.object),
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
