//! Squeezes: closing directions across the middle of an object in which it turns between the pads
//! until it lies firmly, the local minima of its width (Goldberg 1993, "Orienting polygonal parts
//! without sensors").

use crate::antipodal_pairs::AntipodalPair;
use crate::contact_point::ContactEvidence;
use crate::hand_fit::{ContactsInTool, PackedContact};
use arm_kinematics::GripperModel;
use geometry::RigidTransform;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Number of closing directions over half a turn.
const N_DIRECTIONS: usize = 12;

/// Pairs across a middle at the local minima of the object's width. They face by less than a friction
/// cone: the object turns.
pub(crate) fn squeeze_pairs(
    contacts: &[PackedContact],
    middle: &Point3<f64>,
    gripper: &GripperModel,
) -> Vec<AntipodalPair> {
    let mut in_tool = ContactsInTool::default();
    let upside_down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let turned = |k: usize| {
        let turn_rad = PI * k as f64 / N_DIRECTIONS as f64;
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad)
    };
    let extents: Vec<Option<[f64; 2]>> = (0..N_DIRECTIONS)
        .map(|k| {
            let rotation = turned(k) * upside_down;
            let pose = RigidTransform::from_parts(Translation3::from(middle.coords), rotation);
            in_tool.fill(contacts, &pose, gripper);
            in_tool.extent(gripper)
        })
        .collect();
    let width_m = |k: usize| {
        let extent = extents[k % N_DIRECTIONS];
        extent.map_or(f64::INFINITY, |[low_m, high_m]| high_m - low_m)
    };
    let is_minimum = |k: &usize| {
        let (before, after) = (width_m(k + N_DIRECTIONS - 1), width_m(k + 1));
        width_m(*k) <= before && width_m(*k) <= after
    };
    let minima = (0..N_DIRECTIONS).filter(is_minimum);
    minima
        .filter_map(|k| {
            let [low_m, high_m] = extents[k]?;
            let closing = turned(k) * Vector3::x();
            Some(AntipodalPair {
                middle: middle + closing * low_m.midpoint(high_m),
                closing,
                width_m: high_m - low_m,
                facing: 0.0,
                evidence: ContactEvidence::Mirrored,
                is_squeeze: true,
            })
        })
        .collect()
}
