//! Tapered cylinders: common geometry of the arm's meshes and capsules.

use nalgebra::{Point3, Vector3};

use crate::ArmDimensions;

/// Number of tapered cylinders that model the arm.
pub(crate) const N_CYLINDERS: usize = 10;

/// Colour of the shells between the joints (white), sRGB.
const SHELL: [u8; 3] = [205, 206, 203];

/// Colour of the joint housings (dark grey), sRGB.
const HOUSING: [u8; 3] = [52, 54, 58];

/// Tapered cylinder that belongs to a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TaperedCylinder {
    /// Index of the link: 0 is the base, `i` the link behind joint `i`.
    pub(crate) link: usize,
    /// Ends of the axis, link frame, metres.
    pub(crate) ends: [Point3<f64>; 2],
    /// Radius of the cylinder at each end, metres.
    pub(crate) radii_m: [f64; 2],
    /// Colour of the cylinder, sRGB.
    pub(crate) color: [u8; 3],
}

/// All tapered cylinders from the base to the wrist. Each begins inside the one before it, so
/// that the arm is connected at all angles.
pub(crate) fn tapered_cylinders(
    dimensions: &ArmDimensions,
    palm_m: f64,
) -> [TaperedCylinder; N_CYLINDERS] {
    let d = dimensions;
    let shoulder_m = d.base_m - d.base_joint_height_m();
    let wrist = Vector3::new(0.0, -d.elbow_offset_m, d.forearm_m);
    let hand_m = (d.hand_m - palm_m).max(0.0);
    [
        along_link(
            0,
            Vector3::z() * d.base_joint_height_m(),
            [0.062, 0.052],
            HOUSING,
        ),
        along_link(1, Vector3::z() * shoulder_m, [0.050, 0.046], SHELL),
        joint_housing(1, shoulder_m, 0.055, 0.048),
        along_link(2, Vector3::z() * d.upper_arm_m, [0.042, 0.036], SHELL),
        joint_housing(2, d.upper_arm_m, 0.050, 0.042),
        along_link(3, wrist, [0.036, 0.032], SHELL),
        along_link(4, Vector3::z() * d.first_wrist_m, [0.0325, 0.031], HOUSING),
        joint_housing(4, d.first_wrist_m, 0.038, 0.034),
        along_link(5, Vector3::z() * d.second_wrist_m, [0.030, 0.029], SHELL),
        along_link(6, Vector3::z() * hand_m, [0.031, 0.036], HOUSING),
    ]
}

/// Tapered cylinder from the link's origin to a point.
fn along_link(link: usize, to: Vector3<f64>, radii_m: [f64; 2], color: [u8; 3]) -> TaperedCylinder {
    TaperedCylinder {
        link,
        ends: [Point3::origin(), to.into()],
        radii_m,
        color,
    }
}

/// Housing of a joint that rotates about y, at a height on the link before it.
fn joint_housing(link: usize, height_m: f64, half_width_m: f64, radius_m: f64) -> TaperedCylinder {
    let end = |y| Point3::new(0.0, y, height_m);
    TaperedCylinder {
        link,
        ends: [end(-half_width_m), end(half_width_m)],
        radii_m: [radius_m; 2],
        color: HOUSING,
    }
}
