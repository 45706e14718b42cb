//! Motion of the camera from one pose to another, in words and numbers.

use geometry::RigidTransform;
use nalgebra::Vector3;

/// Parts of a motion below which they are left out, centimetres.
const PART_MIN_CM: f64 = 1.0;
/// Distance from the middle of the objects within which a camera looks at it, metres.
const AT_MIDDLE_M: f64 = 0.03;
/// Length of the horizontal part of a unit vector below which it has no direction.
const HORIZONTAL_MIN: f64 = 1e-3;

/// Motion of the camera in the frame of planning: z is up, the origin the middle of the objects.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion {
    from: RigidTransform,
    to: RigidTransform,
}

impl Motion {
    pub(crate) fn new(from: RigidTransform, to: RigidTransform) -> Self {
        Self { from, to }
    }

    /// Length of the straight way, metres.
    pub(crate) fn distance_m(&self) -> f64 {
        (self.to.translation.vector - self.from.translation.vector).norm()
    }

    /// Angle of the rotation, degrees.
    pub(crate) fn angle_deg(&self) -> f64 {
        self.from.rotation.angle_to(&self.to.rotation).to_degrees()
    }

    /// Order for a person who stands behind the camera; `target` is the thing in the origin.
    pub(crate) fn in_words(&self, target: &str) -> String {
        let way = self.to.translation.vector - self.from.translation.vector;
        let right = self.right();
        let ahead = Vector3::z().cross(&right);
        let parts = [
            (way.dot(&right), "to the right", "to the left"),
            (way.z, "up", "down"),
            (way.dot(&ahead), "ahead", "back"),
        ];
        let parts: Vec<String> = parts
            .into_iter()
            .map(|(part_m, plus, minus)| (100.0 * part_m, plus, minus))
            .filter(|(part_cm, ..)| part_cm.abs() >= PART_MIN_CM)
            .map(|(part_cm, plus, minus)| {
                let word = if part_cm > 0.0 { plus } else { minus };
                format!("{:.0} cm {word}", part_cm.abs())
            })
            .collect();
        let way = match parts.as_slice() {
            [] => "leave the camera in its place".to_owned(),
            [one] => format!("move the camera {one}"),
            [some @ .., last] => format!("move the camera {} and {last}", some.join(", ")),
        };
        format!("{way}, and {}", self.look(target))
    }

    /// Line of sight at the end.
    fn look(&self, target: &str) -> String {
        let eye = self.to.translation.vector;
        let axis = self.to.rotation * Vector3::z();
        let off_m = eye.cross(&axis).norm();
        if off_m < AT_MIDDLE_M && eye.dot(&axis) < 0.0 {
            return format!("look at {target}");
        }
        let down_deg = (-axis.z).clamp(-1.0, 1.0).asin().to_degrees();
        let way = if down_deg < 0.0 { "up" } else { "down" };
        format!(
            "turn it by {:.0}°, so that it looks {way} at {:.0}°",
            self.angle_deg(),
            down_deg.abs()
        )
    }

    /// Horizontal direction to the right of the camera at the beginning.
    fn right(&self) -> Vector3<f64> {
        let horizontal = |mut direction: Vector3<f64>| {
            direction.z = 0.0;
            direction.try_normalize(HORIZONTAL_MIN)
        };
        let rotation = self.from.rotation;
        let by_ahead = || horizontal((rotation * Vector3::z()).cross(&Vector3::z()));
        horizontal(rotation * Vector3::x())
            .or_else(by_ahead)
            .unwrap_or_else(Vector3::x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    fn looking_from(x: f64, y: f64, z: f64) -> RigidTransform {
        let eye = Point3::new(x, y, z);
        RigidTransform::face_towards(&eye, &Point3::origin(), &-Vector3::z())
    }

    #[test]
    fn motion_is_told_from_behind_the_camera() {
        // The camera stands in the south and looks north: east is right.
        let from = looking_from(0.0, -0.8, 0.5);
        let motion = Motion::new(from, looking_from(-0.32, -0.75, 0.68));
        assert_eq!(
            motion.in_words("the mug"),
            "move the camera 32 cm to the left, 18 cm up and 5 cm ahead, and look at the mug"
        );
        let back = Motion::new(from, looking_from(0.0, -0.9, 0.5));
        assert_eq!(
            back.in_words("the mug"),
            "move the camera 10 cm back, and look at the mug"
        );
        assert!((back.distance_m() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn turn_is_told_where_the_camera_looks_elsewhere() {
        let from = looking_from(0.0, -0.8, 0.0);
        let mut to = from;
        to.rotation =
            nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -0.5) * to.rotation;
        let motion = Motion::new(from, to);
        assert_eq!(
            motion.in_words("the mug"),
            "leave the camera in its place, and turn it by 29°, so that it looks down at 29°"
        );
        assert!((motion.angle_deg() - 0.5_f64.to_degrees()).abs() < 1e-9);
    }

    #[test]
    fn camera_that_looks_down_or_lies_on_its_side_has_a_right_hand() {
        let mut down = looking_from(0.0, -1e-9, 0.8);
        assert!(Motion::new(down, down).right().norm() > 0.99);
        down.rotation *= nalgebra::UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.0);
        assert!(
            Motion::new(down, looking_from(0.3, 0.0, 0.8))
                .in_words("the mug")
                .contains("cm")
        );
        let mut side = looking_from(0.0, -0.8, 0.0);
        let quarter = std::f64::consts::FRAC_PI_2;
        side.rotation *= nalgebra::UnitQuaternion::from_axis_angle(&Vector3::z_axis(), quarter);
        let right = Motion::new(side, side).right();
        assert!((right - Vector3::x()).norm() < 1e-6, "{right}");
    }
}
