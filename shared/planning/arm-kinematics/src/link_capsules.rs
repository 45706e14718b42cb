//! Bounding capsules of the arm's links.

use geometry::{Capsule, OrientedBox};
use nalgebra::{Point3, Vector3};

use crate::tapered_cylinder::{N_CYLINDERS, tapered_cylinders};
use crate::{Arm, JointVector};

/// Number of capsules: tapered cylinders, the gripper's rail and two fingers.
pub const N_CAPSULES: usize = N_CYLINDERS + 3;

/// Bounding capsules of the whole arm, base frame, from the base to the fingers. The last three
/// are the gripper's rail and the fingers at +x and -x.
pub fn link_capsules(arm: &Arm, joints_rad: &JointVector, opening_m: f64) -> [Capsule; N_CAPSULES] {
    let poses = arm.body_poses(joints_rad, opening_m);
    let cylinders = tapered_cylinders(arm.dimensions(), arm.gripper().palm_m);
    std::array::from_fn(|i| match i.checked_sub(N_CYLINDERS) {
        None => {
            let cylinder = &cylinders[i];
            Capsule {
                from: cylinder.ends[0],
                to: cylinder.ends[1],
                radius_m: cylinder.radii_m[0].max(cylinder.radii_m[1]),
            }
            .transformed(&poses.base_from_link[cylinder.link])
        }
        Some(0) => {
            bounding_capsule(&arm.gripper().rail_in_tool()).transformed(&poses.base_from_tool)
        }
        Some(finger) => bounding_capsule(&arm.gripper().finger_and_pad_in_finger())
            .transformed(&poses.base_from_finger[finger - 1]),
    })
}

/// Smallest capsule around a box whose segment is on the box's longest axis and ends on its
/// faces.
fn bounding_capsule(body: &OrientedBox) -> Capsule {
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
    use crate::{LinkMeshes, test_joint_angles};
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
        fn capsules_contain_the_meshes(
            joints in test_joint_angles(),
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
    fn capsules_leave_the_space_between_the_pads_free() {
        let arm = Arm::jaco_like();
        let joints = JointVector::from(crate::HOME);
        let grasped = arm.tool_pose(&joints) * Point3::origin();
        for capsule in link_capsules(&arm, &joints, 0.08) {
            // A round finger bulges by 5 mm beyond the flat pad at 40 mm.
            assert!(capsule.distance_m(&grasped) > 0.034);
        }
    }
}
