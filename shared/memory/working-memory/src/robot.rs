//! State of the robot arm in the world model.

use serde::{Deserialize, Serialize};

use crate::event::Outcome;

/// State report of the robot arm.
#[derive(Debug, Clone, Copy)]
pub struct RobotSighting<'a> {
    /// Present activity of the arm.
    pub activity: &'a str,
    /// Result of the last command; `None` while it runs.
    pub outcome: Option<Outcome>,
    /// Number of the running or last command; zero before the first.
    pub command_id: u64,
    /// Failure reason of the last command; empty otherwise.
    pub note: &'a str,
    /// `true` if the gripper holds something.
    pub is_holding: bool,
    /// Opening of the gripper, metres.
    pub opening_m: f64,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: &'a [f64],
    /// Position of the gripper in the world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper: quaternion x, y, z, w.
    pub orientation_xyzw: [f64; 4],
}

/// Robot arm with its last reported state; the pose of its base is not part of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// Last reported activity of the arm.
    pub activity: String,
    /// Number of the running or last command; zero before the first.
    pub command_id: u64,
    /// Result of the last command; `None` while it runs.
    pub outcome: Option<Outcome>,
    /// Failure reason of the last command; empty otherwise.
    pub note: String,
    /// `true` if the gripper holds something.
    pub is_holding: bool,
    /// Opening of the gripper, metres.
    pub opening_m: f64,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: Vec<f64>,
    /// Position of the gripper in the world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper: quaternion x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Time of the last report, nanoseconds since 1970.
    pub last_heard_ns: u64,
    /// `true` while the robot sends reports.
    pub is_heard: bool,
    /// Value of `last_heard_ns` on disk, or about to be written.
    #[serde(skip)]
    pub(crate) noted_heard_ns: u64,
}

impl Robot {
    pub(crate) fn new(sighting: &RobotSighting<'_>, now_ns: u64) -> Self {
        Self {
            activity: sighting.activity.to_owned(),
            command_id: sighting.command_id,
            outcome: sighting.outcome,
            note: sighting.note.to_owned(),
            is_holding: sighting.is_holding,
            opening_m: sighting.opening_m,
            joint_angles_rad: sighting.joint_angles_rad.to_vec(),
            position_m: sighting.position_m,
            orientation_xyzw: sighting.orientation_xyzw,
            last_heard_ns: now_ns,
            is_heard: true,
            noted_heard_ns: now_ns,
        }
    }

    /// `true` if all discrete values are unchanged; continuous values change all the time.
    pub(crate) fn has_same_state(&self, sighting: &RobotSighting<'_>) -> bool {
        self.is_heard
            && self.activity == sighting.activity
            && self.command_id == sighting.command_id
            && self.outcome == sighting.outcome
            && self.note == sighting.note
            && self.is_holding == sighting.is_holding
    }

    /// Copies a report; allocates only for longer strings.
    pub(crate) fn update(&mut self, sighting: &RobotSighting<'_>, now_ns: u64) {
        sighting.activity.clone_into(&mut self.activity);
        sighting.note.clone_into(&mut self.note);
        self.joint_angles_rad.clear();
        self.joint_angles_rad.extend(sighting.joint_angles_rad);
        self.command_id = sighting.command_id;
        self.outcome = sighting.outcome;
        self.is_holding = sighting.is_holding;
        self.opening_m = sighting.opening_m;
        self.position_m = sighting.position_m;
        self.orientation_xyzw = sighting.orientation_xyzw;
        self.last_heard_ns = now_ns;
        self.is_heard = true;
    }
}
