//! The arm and the people around it: joint angles and the space they fill.

use crate::pose::WirePose;
use crate::{SCHEMA_VERSION, Text};
use bytemuck::AnyBitPattern;
use geometry::Capsule;
use iceoryx2::prelude::ZeroCopySend;
use nalgebra::Point3;

/// Joints of the arm.
pub const ARM_JOINTS: usize = 6;

/// Most capsules of an arm or of the people in view.
pub const MAX_CAPSULES: usize = 32;

/// All that lies within a radius of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Capsule.v1")]
#[repr(C)]
pub struct WireCapsule {
    /// One end of the segment, metres.
    pub from_m: [f64; 3],
    /// The other end.
    pub to_m: [f64; 3],
    /// Radius, metres.
    pub radius_m: f64,
}

const _: () = assert!(size_of::<WireCapsule>() == 56);

impl WireCapsule {
    /// The capsule; `None` when the numbers are not one.
    pub fn checked(&self) -> Option<Capsule> {
        let ends = self.from_m.iter().chain(&self.to_m);
        let is_sound = ends.copied().all(f64::is_finite) && self.radius_m.is_finite();
        (is_sound && self.radius_m >= 0.0).then(|| Capsule {
            from: Point3::from(self.from_m),
            to: Point3::from(self.to_m),
            radius_m: self.radius_m,
        })
    }
}

impl From<&Capsule> for WireCapsule {
    fn from(capsule: &Capsule) -> Self {
        Self {
            from_m: capsule.from.coords.into(),
            to_m: capsule.to.coords.into(),
            radius_m: capsule.radius_m,
        }
    }
}

/// What an arm is doing, as a number in [`ArmState::activity`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmActivity {
    /// Waiting for a command; the last one, if any, is done.
    Idle = 1,
    /// Moving its joints.
    Moving = 2,
    /// Opening its fingers.
    Opening = 3,
    /// Closing its fingers.
    Closing = 4,
    /// Stopped by a command.
    Stopped = 5,
    /// The last command could not be carried out; `note` says why.
    Failed = 6,
}

impl ArmActivity {
    const ALL: [Self; 6] = [
        Self::Idle,
        Self::Moving,
        Self::Opening,
        Self::Closing,
        Self::Stopped,
        Self::Failed,
    ];

    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The activity of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.code() == code)
    }

    /// The word for people and scripts.
    pub fn word(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Moving => "moving",
            Self::Opening => "opening",
            Self::Closing => "closing",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
        }
    }
}

/// State of the arm; the payload beside it is the capsules of its links, world frame.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ArmState.v5")]
#[repr(C)]
pub struct ArmState {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Number of an [`ArmActivity`].
    pub activity: u32,
    /// Counts the messages of the port.
    pub sent: u64,
    /// When this was so, monotonic, or the source's own clock in lockstep.
    pub stamp_ns: u64,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: [f64; ARM_JOINTS],
    /// Joint velocities, radians a second.
    pub joint_velocities_rad_s: [f64; ARM_JOINTS],
    /// Distance between the fingers, metres.
    pub opening_m: f64,
    /// Pose of the gripper: between the finger tips, z forward, x closing.
    pub world_from_gripper: WirePose,
    /// The command that is or was last at work; 0 before the first.
    pub command_id: u64,
    /// 1 when the fingers hold something.
    pub is_holding: u32,
    /// Why the last command failed, empty otherwise.
    pub note: Text,
}

const _: () = assert!(size_of::<ArmState>() == 328);

impl Default for ArmState {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            activity: ArmActivity::Idle.code(),
            sent: 0,
            stamp_ns: 0,
            joint_angles_rad: [0.0; ARM_JOINTS],
            joint_velocities_rad_s: [0.0; ARM_JOINTS],
            opening_m: 0.0,
            world_from_gripper: WirePose::default(),
            command_id: 0,
            is_holding: 0,
            note: Text::default(),
        }
    }
}

/// Where people are; the payload beside it is the capsules of their bodies, world
/// frame, none when nobody is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.PersonBody.v1")]
#[repr(C)]
pub struct PersonBody {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Zero.
    pub reserved: u32,
    /// When this was so, monotonic, or the source's own clock in lockstep.
    pub stamp_ns: u64,
    /// Counts the messages of the port.
    pub sent: u64,
}

const _: () = assert!(size_of::<PersonBody>() == 24);

impl Default for PersonBody {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            reserved: 0,
            stamp_ns: 0,
            sent: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_survives_the_wire_and_a_broken_one_is_refused() {
        let capsule = Capsule {
            from: Point3::new(1.0, 2.0, 3.0),
            to: Point3::new(4.0, 5.0, 6.0),
            radius_m: 0.1,
        };
        let wire = WireCapsule::from(&capsule);
        assert_eq!(wire.checked(), Some(capsule));
        let broken = |change: &dyn Fn(&mut WireCapsule)| {
            let mut broken = wire;
            change(&mut broken);
            broken.checked()
        };
        assert_eq!(broken(&|c| c.radius_m = -0.1), None);
        assert_eq!(broken(&|c| c.radius_m = f64::NAN), None);
        assert_eq!(broken(&|c| c.from_m[1] = f64::INFINITY), None);
    }

    #[test]
    fn each_activity_has_its_number() {
        for activity in ArmActivity::ALL {
            assert_eq!(ArmActivity::from_code(activity.code()), Some(activity));
        }
        assert_eq!(ArmActivity::from_code(0), None);
    }
}
