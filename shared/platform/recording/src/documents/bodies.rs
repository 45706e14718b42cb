//! Documents of the arm and of people, from which the messages can be made again.

use crate::Number;
use message::{ARM_JOINTS, ArmState, PersonBody, Text, WireCapsule, WirePose};
use scene_document::Document;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Capsule: all points within a radius of a line segment, world frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CapsuleDocument {
    /// First end of the axis, metres.
    pub from_m: [Number; 3],
    /// Second end of the axis, metres.
    pub to_m: [Number; 3],
    /// Radius, metres.
    pub radius_m: Number,
}

/// State of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArmDocument {
    /// Time of the state on the clock of the frames' capture, nanoseconds.
    pub stamp_ns: u64,
    /// Activity of the arm: 1 idle, 2 moving, 3 opening, 4 closing, 5 stopped, 6 failed.
    pub activity: u32,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: [Number; ARM_JOINTS],
    /// Joint velocities, radians per second.
    pub joint_velocities_rad_s: [Number; ARM_JOINTS],
    /// Distance between the fingers, metres.
    pub opening_m: Number,
    /// Position of the gripper, world frame, metres.
    pub gripper_position_m: [Number; 3],
    /// Orientation of the gripper, quaternion x, y, z, w.
    pub gripper_orientation_xyzw: [Number; 4],
    /// Id of the current or last command; 0 before the first.
    pub command_id: u64,
    /// 1 when the fingers hold an object.
    pub is_holding: u32,
    /// Reason for the failure of the last command; empty otherwise.
    pub note: String,
    /// Volumes of the links, world frame.
    pub capsules: Vec<CapsuleDocument>,
}

/// Volumes occupied by people; none when nobody is there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PersonDocument {
    /// Time of the observation on the clock of the frames' capture, nanoseconds.
    pub stamp_ns: u64,
    /// Volumes of the bodies, world frame.
    pub capsules: Vec<CapsuleDocument>,
}

impl From<&WireCapsule> for CapsuleDocument {
    fn from(capsule: &WireCapsule) -> Self {
        Self {
            from_m: capsule.from_m.map(Number),
            to_m: capsule.to_m.map(Number),
            radius_m: Number(capsule.radius_m),
        }
    }
}

impl CapsuleDocument {
    fn to_wire(&self) -> WireCapsule {
        WireCapsule {
            from_m: self.from_m.map(|number| number.0),
            to_m: self.to_m.map(|number| number.0),
            radius_m: self.radius_m.0,
        }
    }
}

fn capsules(documents: &[CapsuleDocument]) -> Vec<WireCapsule> {
    documents.iter().map(CapsuleDocument::to_wire).collect()
}

impl ArmDocument {
    /// Document of a state and its capsules.
    pub fn new(state: &ArmState, capsules: &[WireCapsule]) -> Self {
        Self {
            stamp_ns: state.stamp_ns,
            activity: state.activity,
            joint_angles_rad: state.joint_angles_rad.map(Number),
            joint_velocities_rad_s: state.joint_velocities_rad_s.map(Number),
            opening_m: Number(state.opening_m),
            gripper_position_m: state.world_from_gripper.position_m.map(Number),
            gripper_orientation_xyzw: state.world_from_gripper.orientation_xyzw.map(Number),
            command_id: state.command_id,
            is_holding: state.is_holding,
            note: super::text(&state.note),
            capsules: capsules.iter().map(CapsuleDocument::from).collect(),
        }
    }

    /// State and capsules of the document, to the bit.
    pub fn to_wire(&self) -> (ArmState, Vec<WireCapsule>) {
        let state = ArmState {
            stamp_ns: self.stamp_ns,
            activity: self.activity,
            joint_angles_rad: self.joint_angles_rad.map(|number| number.0),
            joint_velocities_rad_s: self.joint_velocities_rad_s.map(|number| number.0),
            opening_m: self.opening_m.0,
            world_from_gripper: WirePose {
                position_m: self.gripper_position_m.map(|number| number.0),
                orientation_xyzw: self.gripper_orientation_xyzw.map(|number| number.0),
            },
            command_id: self.command_id,
            is_holding: self.is_holding,
            note: Text::truncated(&self.note),
            ..ArmState::default()
        };
        (state, capsules(&self.capsules))
    }
}

impl PersonDocument {
    /// Document of an observation and its capsules.
    pub fn new(body: &PersonBody, capsules: &[WireCapsule]) -> Self {
        Self {
            stamp_ns: body.stamp_ns,
            capsules: capsules.iter().map(CapsuleDocument::from).collect(),
        }
    }

    /// Observation and capsules of the document, to the bit.
    pub fn to_wire(&self) -> (PersonBody, Vec<WireCapsule>) {
        let body = PersonBody {
            stamp_ns: self.stamp_ns,
            ..PersonBody::default()
        };
        (body, capsules(&self.capsules))
    }
}

impl Document for ArmDocument {
    const NAME: &'static str = "tabula.ArmState";
}

impl Document for PersonDocument {
    const NAME: &'static str = "tabula.PersonBody";
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capsule() -> WireCapsule {
        WireCapsule {
            from_m: [0.1, -1e-300, 3.0],
            to_m: [f64::INFINITY, 0.0, -0.0],
            radius_m: 0.1 + 0.2,
        }
    }

    #[test]
    fn arm_state_comes_back_to_the_bit() {
        let state = ArmState {
            stamp_ns: u64::MAX,
            joint_angles_rad: [0.1, 0.2, 0.3, 1e-17, -0.0, 2.0 / 3.0],
            opening_m: f64::NEG_INFINITY,
            command_id: 7,
            is_holding: 1,
            note: Text::truncated("out of reach"),
            ..ArmState::default()
        };
        let json = serde_json::to_vec(&ArmDocument::new(&state, &[capsule()])).unwrap();
        let read: ArmDocument = serde_json::from_slice(&json).unwrap();
        assert_eq!(read.to_wire(), (state, vec![capsule()]));
    }

    #[test]
    fn person_without_volumes_is_not_an_unknown_one() {
        let body = PersonBody {
            stamp_ns: 5,
            ..PersonBody::default()
        };
        let json = serde_json::to_vec(&PersonDocument::new(&body, &[])).unwrap();
        let read: PersonDocument = serde_json::from_slice(&json).unwrap();
        assert_eq!(read.to_wire(), (body, vec![]));
    }
}
