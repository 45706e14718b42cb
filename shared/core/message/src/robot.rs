//! State of the arm and of the people around it: joint angles and occupied volumes.

use crate::pose::WirePose;
use crate::{SCHEMA_VERSION, Text};
use bytemuck::{AnyBitPattern, Zeroable};
use geometry::Capsule;
use iceoryx2::prelude::ZeroCopySend;
use nalgebra::Point3;
use scene_document::ARM_JOINTS;

/// Maximum number of capsules of an arm or of the people in view.
pub const MAX_CAPSULES: usize = 32;

/// Capsule: all points within a radius of a line segment.
#[derive(Debug, Clone, Copy, PartialEq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Capsule.v1")]
#[repr(C)]
pub struct WireCapsule {
    /// First end of the capsule's axis, metres.
    pub from_m: [f64; 3],
    /// Second end of the capsule's axis, metres.
    pub to_m: [f64; 3],
    /// Radius of the capsule, metres.
    pub radius_m: f64,
}

const _: () = assert!(size_of::<WireCapsule>() == 56);

impl WireCapsule {
    /// Validated capsule; `None` when a number is not finite or the radius is negative.
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

coded_enum::coded_enum! {
    /// Activity of the arm, as a code in [`ArmState::activity`].
    pub enum ArmActivity: u32 {
        /// Waiting for a command; any previous command is complete.
        Idle = 1, "idle";
        /// Arm is moving its joints.
        Moving = 2, "moving";
        /// Gripper is opening its fingers.
        Opening = 3, "opening";
        /// Gripper is closing its fingers.
        Closing = 4, "closing";
        /// Arm was stopped by a command.
        Stopped = 5, "stopped";
        /// Last command failed; the reason is in `note`.
        Failed = 6, "failed";
    }
}

/// State of the arm. The payload is the capsules of its links, world frame.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ArmState.v5")]
#[repr(C)]
pub struct ArmState {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Activity of the arm: code of an [`ArmActivity`].
    pub activity: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
    /// Time of the state, nanoseconds: monotonic clock, or the source's own clock in lockstep.
    pub stamp_ns: u64,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: [f64; ARM_JOINTS],
    /// Joint velocities, radians per second.
    pub joint_velocities_rad_s: [f64; ARM_JOINTS],
    /// Gripper opening: distance between the fingers, metres.
    pub opening_m: f64,
    /// Pose of the gripper: origin between the finger tips, z forward, x along the closing
    /// direction.
    pub world_from_gripper: WirePose,
    /// Id of the current or last command; 0 before the first.
    pub command_id: u64,
    /// 1 when the fingers hold an object.
    pub is_holding: u32,
    /// Reason for the failure of the last command; empty otherwise.
    pub note: Text,
}

const _: () = assert!(size_of::<ArmState>() == 328);

impl Default for ArmState {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            activity: ArmActivity::Idle.code(),
            ..Self::zeroed()
        }
    }
}

/// Volumes occupied by people. The payload is the capsules of their bodies, world frame; empty
/// when no person is present.
#[derive(Debug, Clone, Copy, PartialEq, Eq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.PersonBody.v1")]
#[repr(C)]
pub struct PersonBody {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Padding for alignment, zero.
    pub reserved: u32,
    /// Time of the observation, nanoseconds: monotonic clock, or the source's own clock in
    /// lockstep.
    pub stamp_ns: u64,
    /// Message number of the port, from 1.
    pub sent: u64,
}

const _: () = assert!(size_of::<PersonBody>() == 24);

impl Default for PersonBody {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            ..Self::zeroed()
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
