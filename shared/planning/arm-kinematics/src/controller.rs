//! Arm controller: command queue, trajectory execution and command states.

mod command;
mod command_log;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use crate::{
    Arm, BodyPoses, Error, FingerContact, Gripper, GripperMotion, IkConfig, JointState,
    JointTrajectory, JointVector, LineTrajectory, inverse_kinematics,
};
pub use command::{Command, CommandState, PathKind};
use command_log::CommandLog;

/// Capacity of the queue behind the running command.
const QUEUE_CAPACITY: usize = 16;

/// State of the arm controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionState {
    /// Controller is idle; the last command is done.
    Idle,
    /// Arm joints are moving.
    Moving,
    /// Gripper fingers are closing.
    Closing,
    /// Gripper fingers are opening.
    Opening,
    /// Arm brakes or stands after a stop; the next command moves the arm again.
    Stopped,
    /// Arm controller after a failed command; the next one may succeed.
    Failed(Error),
}

/// Running motion of the controller; `time_s` is the time since its start, seconds.
#[derive(Debug, Clone, PartialEq)]
enum Activity {
    Idle,
    /// Braking to rest before the command `then`, or after a failure when there is none.
    Brake {
        trajectory: JointTrajectory,
        time_s: f64,
        then: Option<(u64, Command)>,
    },
    Joint {
        id: u64,
        trajectory: JointTrajectory,
        time_s: f64,
    },
    Line {
        id: u64,
        trajectory: LineTrajectory,
        time_s: f64,
    },
    Fingers {
        id: u64,
        start_m: f64,
        target_m: f64,
    },
}

/// Controller that executes commands of an arm and its gripper one after the other.
///
/// The client gives each command an identity and queries its state with
/// [`command_state`](Self::command_state); the latest 64 are remembered. [`submit`](Self::submit)
/// appends, [`retarget`](Self::retarget) replaces all commands and continues smoothly from the
/// current velocity. A failed command cancels the ones behind it, since they assumed its result.
///
/// [`Command::Stop`] is an emergency stop: from the next step on each joint brakes as hard as its
/// [greatest acceleration](crate::Joint::max_acceleration_rad_s2) allows, the fingers stand, and the
/// queue is empty.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmController {
    arm: Arm,
    joints: JointState,
    gripper: Gripper,
    state: MotionState,
    activity: Activity,
    queue: VecDeque<(u64, Command)>,
    log: CommandLog,
}

impl ArmController {
    /// Controller of an arm at rest with open fingers.
    ///
    /// # Errors
    ///
    /// [`Error::JointLimit`] or [`Error::BadNumber`] for invalid angles.
    pub fn new(arm: Arm, joints_rad: JointVector) -> Result<Self, Error> {
        arm.chain().check(&joints_rad)?;
        Ok(Self {
            joints: JointState::at_rest(joints_rad),
            gripper: Gripper::new(*arm.gripper()),
            state: MotionState::Idle,
            activity: Activity::Idle,
            queue: VecDeque::with_capacity(QUEUE_CAPACITY),
            log: CommandLog::new(),
            arm,
        })
    }

    /// Kinematic model of the controlled arm.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Current joint angles and velocities of the arm.
    pub fn joints(&self) -> &JointState {
        &self.joints
    }

    /// State of the gripper.
    pub fn gripper(&self) -> &Gripper {
        &self.gripper
    }

    /// State of the arm controller.
    pub fn state(&self) -> MotionState {
        self.state
    }

    /// State of a command by its identity; `None` for an unknown or forgotten command.
    pub fn command_state(&self, id: u64) -> Option<CommandState> {
        self.log.state(id)
    }

    /// Poses of all bodies of the arm, base frame.
    pub fn body_poses(&self) -> BodyPoses {
        self.arm
            .body_poses(&self.joints.angles_rad, self.gripper.opening_m())
    }

    /// Poses of all bodies of the arm where it stands if it brakes now, base frame.
    pub fn stopped_body_poses(&self) -> BodyPoses {
        let chain = self.arm.chain();
        let stopped = JointTrajectory::braking(chain, &self.joints).sample(f64::INFINITY);
        let angles_rad = chain.clamped(&stopped.angles_rad);
        self.arm.body_poses(&angles_rad, self.gripper.opening_m())
    }

    /// Appends a command to the queue. [`Command::Stop`] acts at once instead, whatever its
    /// identity.
    ///
    /// # Errors
    ///
    /// Invalid numbers, a full queue, or a repeated identity. Except for the last, the command is
    /// also recorded as failed.
    pub fn submit(&mut self, id: u64, command: Command) -> Result<(), Error> {
        let is_known = self.log.state(id).is_some();
        if command == Command::Stop {
            self.stop();
            if !is_known {
                self.log.note(id, CommandState::Done);
            }
            return Ok(());
        }
        if is_known {
            return Err(Error::RepeatedId { id });
        }
        let is_full = self.queue.len() >= QUEUE_CAPACITY;
        let checked = command.check(&self.arm).and(if is_full {
            Err(Error::QueueFull {
                capacity: QUEUE_CAPACITY,
            })
        } else {
            Ok(())
        });
        if let Err(error) = checked {
            self.log.note(id, CommandState::Failed(error));
            return Err(error);
        }
        self.queue.push_back((id, command));
        self.log.note(id, CommandState::Accepted);
        Ok(())
    }

    /// Replaces all commands by one that continues from the current velocity. The replaced
    /// commands become [`CommandState::Stopped`].
    ///
    /// # Errors
    ///
    /// As for [`submit`](Self::submit); the running command then continues.
    pub fn retarget(&mut self, id: u64, command: Command) -> Result<(), Error> {
        if command == Command::Stop || self.log.state(id).is_some() {
            return self.submit(id, command);
        }
        if let Err(error) = command.check(&self.arm) {
            self.log.note(id, CommandState::Failed(error));
            return Err(error);
        }
        self.cancel_all();
        self.submit(id, command)
    }

    /// Advances the controller by `dt_s` seconds; a time that is not above 0 changes nothing.
    pub fn step(&mut self, dt_s: f64, contact: FingerContact) {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            return;
        }
        if matches!(self.activity, Activity::Idle)
            && let Some((id, command)) = self.queue.pop_front()
        {
            self.begin(id, command);
        }
        self.advance(dt_s, contact);
    }

    fn stop(&mut self) {
        self.cancel_all();
        if !self.joints.is_at_rest() {
            self.brake(None);
        }
        self.state = MotionState::Stopped;
    }

    /// Cancels all commands; the joints keep their velocity.
    fn cancel_all(&mut self) {
        if let Some(id) = self.running_id() {
            self.log.note(id, CommandState::Stopped);
        }
        self.activity = Activity::Idle;
        self.state = MotionState::Idle;
        self.gripper.halt();
        self.cancel_queue();
    }

    fn cancel_queue(&mut self) {
        for (id, _) in self.queue.drain(..) {
            self.log.note(id, CommandState::Stopped);
        }
    }

    fn running_id(&self) -> Option<u64> {
        match &self.activity {
            Activity::Idle => None,
            Activity::Brake { then, .. } => then.map(|(id, _)| id),
            Activity::Joint { id, .. }
            | Activity::Line { id, .. }
            | Activity::Fingers { id, .. } => Some(*id),
        }
    }

    /// Starts a command: plans it from the current state.
    fn begin(&mut self, id: u64, command: Command) {
        self.log.note(id, CommandState::Running { progress: 0.0 });
        let needs_rest = !matches!(
            command,
            Command::MoveJoints { .. }
                | Command::MoveTo {
                    path: PathKind::Joint,
                    ..
                }
        );
        if needs_rest && !self.joints.is_at_rest() {
            self.brake(Some((id, command)));
            self.state = MotionState::Moving;
            return;
        }
        match self.plan(id, command) {
            Ok(activity) => {
                self.activity = activity;
                self.state = match self.gripper.motion() {
                    GripperMotion::Still => MotionState::Moving,
                    GripperMotion::Opening => MotionState::Opening,
                    GripperMotion::Closing => MotionState::Closing,
                };
            }
            Err(error) => self.fail(id, error),
        }
    }

    fn plan(&mut self, id: u64, command: Command) -> Result<Activity, Error> {
        let chain = self.arm.chain();
        let to_joints = |joints_rad: &JointVector, speed| Activity::Joint {
            id,
            trajectory: JointTrajectory::new(chain, &self.joints, joints_rad, speed),
            time_s: 0.0,
        };
        let target_m = match command {
            Command::MoveTo {
                base_from_tool,
                path: PathKind::Joint,
                speed,
            } => {
                let near = &self.joints.angles_rad;
                let config = IkConfig::default();
                let found = inverse_kinematics(&self.arm, &base_from_tool, near, &config)?;
                return Ok(to_joints(&found.joints_rad, speed));
            }
            Command::MoveTo {
                base_from_tool,
                path: PathKind::Linear,
                speed,
            } => {
                let start = &self.joints.angles_rad;
                let trajectory = LineTrajectory::plan(&self.arm, start, &base_from_tool, speed)?;
                return Ok(Activity::Line {
                    id,
                    trajectory,
                    time_s: 0.0,
                });
            }
            Command::MoveJoints { joints_rad, speed } => return Ok(to_joints(&joints_rad, speed)),
            Command::Open { opening_m } => opening_m,
            Command::Close => 0.0,
            // `Stop` acts when it is submitted and is never queued.
            Command::Stop => return Ok(Activity::Idle),
        };
        let start_m = self.gripper.opening_m();
        self.gripper.move_to(target_m)?;
        Ok(Activity::Fingers {
            id,
            start_m,
            target_m,
        })
    }

    fn brake(&mut self, then: Option<(u64, Command)>) {
        let trajectory = JointTrajectory::braking(self.arm.chain(), &self.joints);
        self.activity = Activity::Brake {
            trajectory,
            time_s: 0.0,
            then,
        };
    }

    fn fail(&mut self, id: u64, error: Error) {
        self.log.note(id, CommandState::Failed(error));
        self.cancel_queue();
        self.state = MotionState::Failed(error);
        self.activity = Activity::Idle;
        if !self.joints.is_at_rest() {
            self.brake(None);
        }
    }

    /// Advances the running motion by a time step.
    fn advance(&mut self, dt_s: f64, contact: FingerContact) {
        let (joints, passed_s, duration_s) = match &mut self.activity {
            Activity::Idle => return,
            Activity::Fingers { .. } => return self.advance_fingers(dt_s, contact),
            Activity::Brake {
                trajectory, time_s, ..
            }
            | Activity::Joint {
                trajectory, time_s, ..
            } => {
                *time_s += dt_s;
                (trajectory.sample(*time_s), *time_s, trajectory.duration_s())
            }
            Activity::Line {
                trajectory, time_s, ..
            } => {
                *time_s += dt_s;
                (trajectory.sample(*time_s), *time_s, trajectory.duration_s())
            }
        };
        // A cubic curve close to a limit may exceed it by a rounding error.
        let angles_rad = self.arm.chain().clamped(&joints.angles_rad);
        self.joints = JointState {
            angles_rad,
            ..joints
        };
        if passed_s >= duration_s {
            self.finish();
        } else if !matches!(self.activity, Activity::Brake { .. })
            && let Some(id) = self.running_id()
        {
            self.log.note(
                id,
                CommandState::Running {
                    progress: passed_s / duration_s,
                },
            );
        }
    }

    fn advance_fingers(&mut self, dt_s: f64, contact: FingerContact) {
        self.gripper.step(dt_s, contact);
        if self.gripper.motion() == GripperMotion::Still {
            return self.finish();
        }
        if let Activity::Fingers {
            id,
            start_m,
            target_m,
        } = self.activity
        {
            let progress = (self.gripper.opening_m() - start_m) / (target_m - start_m);
            self.log.note(id, CommandState::Running { progress });
        }
    }

    /// Ends the running motion; the next command starts with the next step.
    fn finish(&mut self) {
        match std::mem::replace(&mut self.activity, Activity::Idle) {
            Activity::Brake {
                then: Some((id, command)),
                ..
            } => return self.begin(id, command),
            // The preceding failure stays visible.
            Activity::Idle | Activity::Brake { then: None, .. } => return,
            Activity::Joint { id, .. }
            | Activity::Line { id, .. }
            | Activity::Fingers { id, .. } => self.log.note(id, CommandState::Done),
        }
        if self.queue.is_empty() {
            self.state = MotionState::Idle;
        }
    }
}
