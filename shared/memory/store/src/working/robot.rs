//! The robot as it said it was last.

use serde::{Deserialize, Serialize};

use super::event::{Happening, Outcome};
use super::fact::{Claim, Property, Subject};
use super::keys::Entry;
use super::world_model::WorldModel;

/// How the arm says it is.
#[derive(Debug, Clone, Copy)]
pub struct RobotSighting<'a> {
    /// What it is doing.
    pub activity: &'a str,
    /// How the last command ended; `None` while it is at work.
    pub outcome: Option<Outcome>,
    /// The command at work, or the last one; zero before the first.
    pub command_id: u64,
    /// Why the last command failed, empty otherwise.
    pub note: &'a str,
    /// Whether the fingers hold something.
    pub is_holding: bool,
    /// Distance between the fingers, metres.
    pub opening_m: f64,
    /// Angles from the base outwards, radians.
    pub joint_angles_rad: &'a [f64],
    /// Position of the gripper, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
}

/// The arm, heard or silent. Where its base stands is not known here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// What it is doing.
    pub activity: String,
    /// The command at work, or the last one; zero before the first.
    pub command_id: u64,
    /// How that command ended; `None` while it is at work.
    pub outcome: Option<Outcome>,
    /// Why it failed, empty otherwise.
    pub note: String,
    /// Whether the fingers hold something.
    pub is_holding: bool,
    /// Distance between the fingers, metres.
    pub opening_m: f64,
    /// Angles from the base outwards, radians.
    pub joint_angles_rad: Vec<f64>,
    /// Position of the gripper, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// When it last said so, nanoseconds since 1970.
    pub last_heard_ns: u64,
    /// Whether it still says how it is.
    pub is_heard: bool,
    /// `last_heard_ns` as it is, or is about to be, on disk.
    #[serde(skip)]
    pub(super) noted_heard_ns: u64,
}

impl Robot {
    pub(super) fn new(sighting: &RobotSighting<'_>, now_ns: u64) -> Self {
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

    /// Whether the words and flags are the same; numbers change all the time.
    pub(super) fn says(&self, sighting: &RobotSighting<'_>) -> bool {
        self.is_heard
            && self.activity == sighting.activity
            && self.command_id == sighting.command_id
            && self.outcome == sighting.outcome
            && self.note == sighting.note
            && self.is_holding == sighting.is_holding
    }

    /// Takes over what is said; allocates only for longer words.
    pub(super) fn update(&mut self, sighting: &RobotSighting<'_>, now_ns: u64) {
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

impl WorldModel {
    /// Takes in what the robot says of itself.
    pub fn observe_robot(&mut self, sighting: &RobotSighting<'_>, now_ns: u64) {
        let has_changed = match &self.robot {
            Some(robot) => !robot.says(sighting),
            None => true,
        };
        if has_changed {
            self.tell_action(sighting, now_ns);
            let (config, touched) = (&self.config, &mut self.touched);
            for claim in [
                Claim::Activity(sighting.activity),
                Claim::Holding(sighting.is_holding),
            ] {
                self.facts
                    .claim(Subject::Robot, claim, now_ns, config, touched);
            }
        }
        let robot = self
            .robot
            .get_or_insert_with(|| Robot::new(sighting, now_ns));
        robot.update(sighting, now_ns);
        let unwritten_ns = now_ns.abs_diff(robot.noted_heard_ns);
        if has_changed || unwritten_ns >= self.config.seen_period_ns {
            robot.noted_heard_ns = now_ns;
            self.touched.add(Entry::Robot);
        }
    }

    /// Tells that an action ended. What had ended when the robot was first heard
    /// is no news.
    fn tell_action(&mut self, sighting: &RobotSighting<'_>, now_ns: u64) {
        let Some(robot) = self.robot.as_ref().filter(|robot| robot.is_heard) else {
            return;
        };
        let was_over = robot.command_id == sighting.command_id && robot.outcome.is_some();
        if let Some(outcome) = sighting.outcome
            && sighting.command_id != 0
            && !was_over
        {
            let ended = Happening::ActionEnded {
                command_id: sighting.command_id,
                outcome,
                note: sighting.note.to_owned(),
            };
            self.events.add(ended, now_ns, &mut self.touched);
        }
    }

    /// Ends what holds of the robot, for it says nothing any more.
    pub fn lose_robot(&mut self) {
        let Some(robot) = self.robot.as_mut().filter(|robot| robot.is_heard) else {
            return;
        };
        robot.is_heard = false;
        for property in [Property::Activity, Property::Holding] {
            let end_ns = robot.last_heard_ns;
            self.facts
                .cease(Subject::Robot, property, end_ns, &mut self.touched);
        }
        self.touched.add(Entry::Robot);
    }
}
