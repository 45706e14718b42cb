//! The frame in which an object is described.

use description::DescriptorFrame;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// The long side of a box has two ends, and the one farther from the viewer is
/// taken. Where both are equally far, noise would decide; seen from ahead, many
/// boxes stand so. The direction that decides is therefore turned about the
/// upright by this angle, to where few objects stand.
const TURN_RAD: f64 = 0.61;

/// The frame of an object's upright box: origin in its centre, z up from the
/// table, x along its long side, away from the viewer. Principal axes are not
/// used: those of round objects turn freely.
///
/// Frame: box and result in the camera's.
pub(crate) fn box_frame(upright_box: &OrientedBox) -> DescriptorFrame {
    let rotation = upright_box.frame_from_box.rotation;
    let (up, side) = (rotation * Vector3::z(), rotation * Vector3::x());
    let turn = UnitQuaternion::from_axis_angle(&(rotation * Vector3::z_axis()), TURN_RAD);
    let away = turn * upright_box.centre().coords;
    let x = if side.dot(&away) < 0.0 { -side } else { side };
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, up.cross(&x), up]));
    let source_from_object = RigidTransform::from_parts(
        upright_box.frame_from_box.translation,
        UnitQuaternion::from_rotation_matrix(&axes),
    );
    DescriptorFrame::from(&source_from_object.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Point;

    fn box_at(distance_m: f64, yaw_rad: f64) -> OrientedBox {
        OrientedBox {
            frame_from_box: RigidTransform::new(Vector3::z() * distance_m, Vector3::zeros())
                * UnitQuaternion::from_euler_angles(-1.8, 0.0, 0.0)
                * UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_rad),
            half_sides_m: Vector3::new(0.1, 0.05, 0.08),
        }
    }

    fn seen(frame: &DescriptorFrame, point: [f64; 3]) -> [f32; 3] {
        let [x, y, z] = point.map(|value| value as f32);
        frame.apply(&Point {
            x,
            y,
            z,
            ..Point::default()
        })
    }

    #[test]
    fn a_box_reads_the_same_from_both_of_its_ends() {
        for yaw_rad in [-2.0, 0.0, 0.3, 1.4] {
            let (one, other) = (
                box_at(1.0, yaw_rad),
                box_at(1.0, yaw_rad + std::f64::consts::PI),
            );
            let point = [0.03, -0.02, 1.05];
            let (a, b) = (
                seen(&box_frame(&one), point),
                seen(&box_frame(&other), point),
            );
            assert!(
                a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5),
                "{a:?} {b:?}"
            );
        }
    }

    #[test]
    fn the_centre_is_the_origin_and_up_is_z() {
        let upright_box = box_at(0.8, 0.4);
        let frame = box_frame(&upright_box);
        let top = upright_box.frame_from_box * nalgebra::Point3::new(0.0, 0.0, 0.08);
        assert!(
            seen(&frame, upright_box.centre().coords.into())
                .iter()
                .all(|v| v.abs() < 1e-6)
        );
        let [x, y, z] = seen(&frame, top.coords.into());
        assert!(x.abs() < 1e-6 && y.abs() < 1e-6 && (z - 0.08).abs() < 1e-6);
    }
}
