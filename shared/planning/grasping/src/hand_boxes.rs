//! Boxes of the open hand, and of the space that it passes through on its way to a grasp.

use arm_kinematics::{GripperModel, tool_from_fingers};
use geometry::OrientedBox;
use nalgebra::{Isometry3, Vector3};

/// Half width of the hand behind the palm, metres, and its length: the wrist of the JACO.
const HAND_HALF_M: f64 = 0.040;
const HAND_LENGTH_M: f64 = 0.12;

/// Boxes of the hand at an opening between the pads, tool frame: both fingers, the rail with the
/// palm, the hand behind it.
pub fn hand_boxes(gripper: &GripperModel, opening_m: f64) -> [OrientedBox; 4] {
    let finger = gripper.finger_and_pad_in_finger();
    let [right, left] = tool_from_fingers(opening_m).map(|pose| finger.transformed(&pose));
    let rail = gripper.rail_in_tool();
    let rail_back_m = rail.frame_from_box.translation.z - rail.half_sides_m.z;
    let hand = OrientedBox {
        frame_from_box: Isometry3::translation(0.0, 0.0, rail_back_m - 0.5 * HAND_LENGTH_M),
        half_sides_m: Vector3::new(HAND_HALF_M, HAND_HALF_M, 0.5 * HAND_LENGTH_M),
    };
    [right, left, rail, hand]
}

/// Box swept along the tool's approach: a straight way of `back_m` that ends at the box. The sweep
/// of a box along one of its axes is a longer box.
pub fn swept_back(body: &OrientedBox, back_m: f64) -> OrientedBox {
    let mut swept = *body;
    swept.half_sides_m.z += 0.5 * back_m;
    swept.frame_from_box.translation.z -= 0.5 * back_m;
    swept
}

/// Boxes between the open and the closed pads, tool frame.
pub(crate) fn closing_boxes(
    gripper: &GripperModel,
    opening_m: f64,
    width_m: f64,
) -> [OrientedBox; 2] {
    let way_m = 0.5 * (opening_m - width_m).max(0.0);
    let half = Vector3::new(way_m, gripper.pad_width_m, gripper.pad_length_m) / 2.0;
    [-1.0, 1.0].map(|side| OrientedBox {
        frame_from_box: Isometry3::translation(side * (0.5 * width_m + half.x), 0.0, 0.0),
        half_sides_m: half,
    })
}

/// Height of the lowest corner of a box over a plane, metres.
pub fn lowest_m(body: &OrientedBox, plane: &geometry::Plane) -> f64 {
    let normal_in_box = body.frame_from_box.rotation.inverse() * plane.normal.into_inner();
    let below_m = normal_in_box.abs().dot(&body.half_sides_m);
    plane.height_m(&body.centre()) - below_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Plane, RigidTransform};
    use nalgebra::{Point3, UnitQuaternion};

    #[test]
    fn sweep_contains_the_box_at_every_place_of_its_way() {
        let boxes = hand_boxes(&GripperModel::JACO_LIKE, 0.08);
        for body in &boxes {
            let swept = swept_back(body, 0.1);
            for step in 0..=10 {
                let back = Isometry3::translation(0.0, 0.0, -0.01 * f64::from(step));
                let corner = back * body.frame_from_box * Point3::from(body.half_sides_m);
                assert!(swept.contains(&corner, 1e-12));
            }
            let beyond = body.centre() - Vector3::z() * (body.half_sides_m.z + 0.101);
            assert!(!swept.contains(&beyond, 0.0));
        }
    }

    #[test]
    fn lowest_corner_of_a_turned_box_is_its_true_one() {
        let plane = Plane::through(&Point3::new(0.0, 0.0, 0.2), Vector3::z_axis());
        let body = OrientedBox {
            frame_from_box: RigidTransform::from_parts(
                [0.1, 0.2, 1.0].into(),
                UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
            ),
            half_sides_m: Vector3::new(0.1, 0.02, 0.3),
        };
        let corners = (0..8).map(|i| {
            let sign = |bit: i32| if i & bit == 0 { -1.0 } else { 1.0 };
            let signs = Vector3::new(sign(1), sign(2), sign(4));
            let corner = Point3::from(body.half_sides_m.component_mul(&signs));
            (body.frame_from_box * corner).z - 0.2
        });
        let lowest = corners.fold(f64::INFINITY, f64::min);
        assert!((lowest_m(&body, &plane) - lowest).abs() < 1e-12);
    }
}
