//! The arm that carries out commands, step by step.

mod command;
mod command_log;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use crate::{
    Arm, BodyPoses, Error, Gripper, GripperMotion, IkConfig, JointState, JointTrajectory,
    JointVector, LineTrajectory, inverse_kinematics,
};
pub use command::{Command, CommandState, Path};
use command_log::CommandLog;

/// Most commands that may wait behind the running one.
const QUEUE_CAPACITY: usize = 16;

/// What the arm does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionState {
    /// It waits for a command; the last one is done.
    Idle,
    /// Joints move.
    Moving,
    /// Fingers close.
    Closing,
    /// Fingers open.
    Opening,
    /// It stands where it was stopped; the next command moves it again.
    Stopped,
    /// The last command could not be carried out; the next one may.
    Failed(Error),
}

/// Where a motion comes from: `time_s` of it has passed.
#[derive(Debug, Clone, PartialEq)]
enum Activity {
    Rest,
    /// Coming to rest before `then`, or before nothing after a failure.
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

/// An arm and its fingers that carry out commands one after the other.
///
/// The client gives each command an identity and asks what became of it with
/// [`command_state`](Self::command_state); the latest 64 are remembered.
/// [`submit`](Self::submit) appends, [`retarget`](Self::retarget) replaces
/// everything and goes on smoothly from the present velocity. A command that
/// fails takes those behind it along, for they were meant for its end.
///
/// [`Command::Stop`] acts at once and is an emergency stop: from the moment it
/// is submitted all velocities are zero, without a braking ramp (a kinematic arm
/// has no inertia), and the queue is empty.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmMotion {
    arm: Arm,
    joints: JointState,
    gripper: Gripper,
    state: MotionState,
    activity: Activity,
    queue: VecDeque<(u64, Command)>,
    log: CommandLog,
}

impl ArmMotion {
    /// An arm at rest, fingers open.
    ///
    /// # Errors
    ///
    /// [`Error::JointLimit`] or [`Error::BadNumber`] for angles it can not have.
    pub fn new(arm: Arm, joints_rad: JointVector) -> Result<Self, Error> {
        arm.chain().check(&joints_rad)?;
        Ok(Self {
            joints: JointState::at_rest(joints_rad),
            gripper: Gripper::new(*arm.gripper()),
            state: MotionState::Idle,
            activity: Activity::Rest,
            queue: VecDeque::with_capacity(QUEUE_CAPACITY),
            log: CommandLog::new(),
            arm,
        })
    }

    /// The arm itself.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Angles and velocities of the joints.
    pub fn joints(&self) -> &JointState {
        &self.joints
    }

    /// The fingers.
    pub fn gripper(&self) -> &Gripper {
        &self.gripper
    }

    /// What the arm does.
    pub fn state(&self) -> MotionState {
        self.state
    }

    /// What became of a command; `None` when it was never given or is forgotten.
    pub fn command_state(&self, id: u64) -> Option<CommandState> {
        self.log.state(id)
    }

    /// Poses of all bodies in the base frame.
    pub fn body_poses(&self) -> BodyPoses {
        self.arm
            .body_poses(&self.joints.angles_rad, self.gripper.opening_m())
    }

    /// Appends a command; [`Command::Stop`] acts at once instead, whatever its identity.
    ///
    /// # Errors
    ///
    /// Numbers that can not be, a full queue, an identity used before. But for
    /// the last, the command is also remembered as failed.
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

    /// Replaces all commands by one, which goes on from the present velocity.
    /// The replaced ones count as stopped.
    ///
    /// # Errors
    ///
    /// As [`submit`](Self::submit); the arm then goes on as before.
    pub fn retarget(&mut self, id: u64, command: Command) -> Result<(), Error> {
        if command == Command::Stop || self.log.state(id).is_some() {
            return self.submit(id, command);
        }
        if let Err(error) = command.check(&self.arm) {
            self.log.note(id, CommandState::Failed(error));
            return Err(error);
        }
        self.drop_all();
        self.submit(id, command)
    }

    /// Moves on by a time, seconds; a time that is not above 0 changes nothing.
    /// `both_pads_touch`: whether each pad touches something it can hold.
    pub fn step(&mut self, dt_s: f64, both_pads_touch: bool) {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            return;
        }
        if matches!(self.activity, Activity::Rest)
            && let Some((id, command)) = self.queue.pop_front()
        {
            self.begin(id, command);
        }
        self.advance(dt_s, both_pads_touch);
    }

    fn stop(&mut self) {
        self.drop_all();
        self.joints.velocities_rad_s.fill(0.0);
        self.state = MotionState::Stopped;
    }

    /// Gives up all commands; the joints keep their velocity.
    fn drop_all(&mut self) {
        if let Some(id) = self.running_id() {
            self.log.note(id, CommandState::Stopped);
        }
        self.activity = Activity::Rest;
        self.state = MotionState::Idle;
        self.gripper.halt();
        self.drop_queue();
    }

    fn drop_queue(&mut self) {
        for (id, _) in self.queue.drain(..) {
            self.log.note(id, CommandState::Stopped);
        }
    }

    fn running_id(&self) -> Option<u64> {
        match &self.activity {
            Activity::Rest => None,
            Activity::Brake { then, .. } => then.map(|(id, _)| id),
            Activity::Joint { id, .. }
            | Activity::Line { id, .. }
            | Activity::Fingers { id, .. } => Some(*id),
        }
    }

    /// Plans a command from the present state.
    fn begin(&mut self, id: u64, command: Command) {
        self.log.note(id, CommandState::Running { progress: 0.0 });
        let needs_rest = !matches!(
            command,
            Command::MoveJoints { .. }
                | Command::MoveTo {
                    path: Path::Joint,
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
                path: Path::Joint,
                speed,
            } => {
                let near = &self.joints.angles_rad;
                let config = IkConfig::default();
                let found = inverse_kinematics(&self.arm, &base_from_tool, near, &config)?;
                return Ok(to_joints(&found.joints_rad, speed));
            }
            Command::MoveTo {
                base_from_tool,
                path: Path::Straight,
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
            // Acts when it is submitted and never waits.
            Command::Stop => return Ok(Activity::Rest),
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
        self.drop_queue();
        self.state = MotionState::Failed(error);
        self.activity = Activity::Rest;
        if !self.joints.is_at_rest() {
            self.brake(None);
        }
    }

    /// Carries on with what is being done.
    fn advance(&mut self, dt_s: f64, both_pads_touch: bool) {
        let (joints, passed_s, duration_s) = match &mut self.activity {
            Activity::Rest => return,
            Activity::Fingers { .. } => return self.advance_fingers(dt_s, both_pads_touch),
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
        // A cubic curve beside a limit may pass it by a hair.
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

    fn advance_fingers(&mut self, dt_s: f64, both_pads_touch: bool) {
        self.gripper.step(dt_s, both_pads_touch);
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

    /// Ends what was being done; the next command begins with the next step.
    fn finish(&mut self) {
        match std::mem::replace(&mut self.activity, Activity::Rest) {
            Activity::Brake {
                then: Some((id, command)),
                ..
            } => return self.begin(id, command),
            // The failure before it stays visible.
            Activity::Rest | Activity::Brake { then: None, .. } => return,
            Activity::Joint { id, .. }
            | Activity::Line { id, .. }
            | Activity::Fingers { id, .. } => self.log.note(id, CommandState::Done),
        }
        if self.queue.is_empty() {
            self.state = MotionState::Idle;
        }
    }
}
