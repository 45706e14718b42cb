//! The arm's body as tapered cylinders: the common measure of what is seen of
//! it and of the capsules around it.

use nalgebra::{Point3, Vector3};

use crate::ArmDimensions;

/// Number of limbs.
pub(crate) const N_LIMBS: usize = 10;

/// White shells between the joints.
const SHELL: [u8; 3] = [205, 206, 203];

/// Dark grey joint housings.
const HOUSING: [u8; 3] = [52, 54, 58];

/// A tapered cylinder that belongs to a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limb {
    /// The link: 0 is the base, `i` the one behind joint `i`.
    pub(crate) link: usize,
    /// Ends of its axis in the link's frame, metres.
    pub(crate) ends: [Point3<f64>; 2],
    /// Radius at each end, metres.
    pub(crate) radii_m: [f64; 2],
    /// sRGB.
    pub(crate) color: [u8; 3],
}

/// All limbs from the base to the wrist. Each begins inside the one before it,
/// so that the arm is connected at all angles.
pub(crate) fn limbs(dimensions: &ArmDimensions, palm_m: f64) -> [Limb; N_LIMBS] {
    let d = dimensions;
    let shoulder_m = d.base_m - d.turntable_m();
    let wrist = Vector3::new(0.0, -d.elbow_offset_m, d.forearm_m);
    let hand_m = (d.hand_m - palm_m).max(0.0);
    [
        along(0, Vector3::z() * d.turntable_m(), [0.062, 0.052], HOUSING),
        along(1, Vector3::z() * shoulder_m, [0.050, 0.046], SHELL),
        across(1, shoulder_m, 0.055, 0.048),
        along(2, Vector3::z() * d.upper_arm_m, [0.042, 0.036], SHELL),
        across(2, d.upper_arm_m, 0.050, 0.042),
        along(3, wrist, [0.036, 0.032], SHELL),
        along(4, Vector3::z() * d.first_wrist_m, [0.0325, 0.031], HOUSING),
        across(4, d.first_wrist_m, 0.038, 0.034),
        along(5, Vector3::z() * d.second_wrist_m, [0.030, 0.029], SHELL),
        along(6, Vector3::z() * hand_m, [0.031, 0.036], HOUSING),
    ]
}

/// From the link's origin to a point.
fn along(link: usize, to: Vector3<f64>, radii_m: [f64; 2], color: [u8; 3]) -> Limb {
    Limb {
        link,
        ends: [Point3::origin(), to.into()],
        radii_m,
        color,
    }
}

/// The housing of a joint that turns about y, at a height on the link before it.
fn across(link: usize, height_m: f64, half_width_m: f64, radius_m: f64) -> Limb {
    let end = |y| Point3::new(0.0, y, height_m);
    Limb {
        link,
        ends: [end(-half_width_m), end(half_width_m)],
        radii_m: [radius_m; 2],
        color: HOUSING,
    }
}
