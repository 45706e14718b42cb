//! Capsules around the arm.

use geometry::{Capsule, OrientedBox};
use nalgebra::{Point3, Vector3};

use crate::limb::{N_LIMBS, limbs};
use crate::{Arm, JointVector};

/// Number of capsules: limbs, the hand's rail, two fingers.
pub const N_CAPSULES: usize = N_LIMBS + 3;

/// Capsules in the base frame that contain the whole arm, from the base to the
/// fingers; the last three are the hand's rail and the fingers at +x and -x.
pub fn link_capsules(arm: &Arm, joints_rad: &JointVector, opening_m: f64) -> [Capsule; N_CAPSULES] {
    let poses = arm.body_poses(joints_rad, opening_m);
    let limbs = limbs(arm.dimensions(), arm.gripper().palm_m);
    std::array::from_fn(|i| match i.checked_sub(N_LIMBS) {
        None => {
            let limb = &limbs[i];
            Capsule {
                from: limb.ends[0],
                to: limb.ends[1],
                radius_m: limb.radii_m[0].max(limb.radii_m[1]),
            }
            .transformed(&poses.base_from_link[limb.link])
        }
        Some(0) => around(&arm.gripper().rail_in_tool()).transformed(&poses.base_from_tool),
        Some(finger) => around(&arm.gripper().finger_with_pad())
            .transformed(&poses.base_from_finger[finger - 1]),
    })
}

/// The least capsule around a box whose segment lies on the box's longest axis
/// and ends on its faces.
fn around(body: &OrientedBox) -> Capsule {
    let longest = body.half_sides_m.imax();
    let mut across = body.half_sides_m;
    across[longest] = 0.0;
    let mut end = Vector3::zeros();
    end[longest] = body.half_sides_m[longest];
    Capsule {
        from: Point3::from(-end),
        to: Point3::from(end),
        radius_m: across.norm(),
    }
    .transformed(&body.frame_from_box)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LinkMeshes, test_angles};
    use geometry::RigidTransform;
    use mesh::Solid;
    use proptest::prelude::*;

    fn check_covered(capsules: &[Capsule], solid: &Solid, base_from_body: &RigidTransform) {
        for vertex in &solid.mesh.vertices {
            let point = base_from_body * vertex.position.cast::<f64>();
            let outside = capsules
                .iter()
                .map(|capsule| capsule.distance_m(&point))
                .fold(f64::INFINITY, f64::min);
            assert!(outside < 0.001, "{point} is {outside} m outside");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn the_capsules_contain_all_that_is_seen(
            joints in test_angles(),
            opening in 0.0..0.15_f64,
        ) {
            let arm = Arm::jaco_like();
            let meshes = LinkMeshes::new(&arm);
            let capsules = link_capsules(&arm, &joints, opening);
            let poses = arm.body_poses(&joints, opening);
            for (solid, pose) in meshes.links.iter().zip(&poses.base_from_link) {
                check_covered(&capsules, solid, pose);
            }
            check_covered(&capsules, &meshes.rail, &poses.base_from_tool);
            for pose in &poses.base_from_finger {
                check_covered(&capsules, &meshes.finger, pose);
            }
        }
    }

    #[test]
    fn the_capsules_leave_free_what_is_between_the_pads() {
        let arm = Arm::jaco_like();
        let joints = JointVector::from(crate::HOME);
        let grasped = arm.tool_pose(&joints) * Point3::origin();
        for capsule in link_capsules(&arm, &joints, 0.08) {
            // A round finger bulges by 5 mm beyond the flat pad at 40 mm.
            assert!(capsule.distance_m(&grasped) > 0.034);
        }
    }
}
