//! The frames in which an object is described.

use description::DescriptorFrame;
use geometry::OrientedBox;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

/// How many ways there are to read an upright box.
pub(crate) const N_READINGS: u32 = 4;

/// The frame of an object's upright box: origin in its centre, z up from the
/// table, x along one of its sides; each reading turns it by a quarter about the
/// upright. Which side is the first says nothing about the object, so all
/// readings are compared with what was taught, where the original trusts the
/// signs of its eigen-solver.
///
/// Frame: box in the camera's; the result leads from there.
pub(crate) fn box_frame(upright_box: &OrientedBox, reading: u32) -> DescriptorFrame {
    let turn = FRAC_PI_2 * f64::from(reading);
    let source_from_object =
        upright_box.frame_from_box * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
    DescriptorFrame::from(&source_from_object.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use nalgebra::Point3;
    use point_cloud::Point;

    fn turned_box(yaw_rad: f64) -> OrientedBox {
        OrientedBox {
            frame_from_box: RigidTransform::new(Vector3::new(0.1, 0.2, 0.9), Vector3::x() * -1.8)
                * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad),
            half_sides_m: Vector3::new(0.1, 0.05, 0.08),
        }
    }

    fn seen(frame: &DescriptorFrame, point: Point3<f64>) -> [f32; 3] {
        let [x, y, z] = point.coords.map(|value| value as f32).into();
        frame.apply(&Point {
            x,
            y,
            z,
            ..Point::default()
        })
    }

    #[test]
    fn whichever_side_comes_first_the_readings_are_the_same() {
        let point = Point3::new(0.13, 0.18, 0.95);
        let expected = seen(&box_frame(&turned_box(0.4), 0), point);
        for (quarter, reading) in [(1.0, 3), (2.0, 2), (3.0, 1)] {
            let frame = box_frame(&turned_box(0.4 + quarter * FRAC_PI_2), reading);
            let found = seen(&frame, point);
            assert!(
                expected
                    .iter()
                    .zip(found)
                    .all(|(a, b)| (a - b).abs() < 1e-5)
            );
        }
    }

    #[test]
    fn the_centre_is_the_origin_and_up_is_z() {
        let upright_box = turned_box(0.4);
        let top = upright_box.frame_from_box * Point3::new(0.0, 0.0, 0.08);
        for reading in 0..N_READINGS {
            let frame = box_frame(&upright_box, reading);
            assert!(
                seen(&frame, upright_box.centre())
                    .iter()
                    .all(|v| v.abs() < 1e-6)
            );
            let [x, y, z] = seen(&frame, top);
            assert!(x.abs() < 1e-6 && y.abs() < 1e-6 && (z - 0.08).abs() < 1e-6);
        }
    }
}
