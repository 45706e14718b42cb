//! Upright bounding box of a point set.

use geometry::{BoundingRectangle, ConvexPolygon, OrientedBox, RigidTransform};
use nalgebra::{Point2, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};

/// Convex outline of points seen from above, and their vertical extent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct UprightOutline {
    /// Rotation into a frame with z up.
    upright_from_object: UnitQuaternion<f64>,
    hull: ConvexPolygon,
    /// Points added since the hull was built.
    added: Vec<Point2<f64>>,
    height_m: [f64; 2],
}

impl UprightOutline {
    /// Empty outline; `up` is given in the frame of the points.
    pub(crate) fn new(up: &UnitVector3<f64>) -> Self {
        let upright_from_object = UnitQuaternion::rotation_between_axis(up, &Vector3::z_axis())
            .unwrap_or_else(|| {
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
            });
        Self {
            upright_from_object,
            hull: ConvexPolygon::default(),
            added: Vec::new(),
            height_m: [f64::INFINITY, f64::NEG_INFINITY],
        }
    }

    /// Up direction of the outline, in the frame of the points.
    pub(crate) fn up(&self) -> UnitVector3<f64> {
        self.upright_from_object.inverse() * Vector3::z_axis()
    }

    /// Adds a finite point to the outline.
    pub(crate) fn add(&mut self, point: &Point3<f64>) {
        let p = self.upright_from_object * point;
        self.height_m = [self.height_m[0].min(p.z), self.height_m[1].max(p.z)];
        if !self.hull.contains(&p.xy()) {
            self.added.push(p.xy());
        }
    }

    /// Upright bounding box in the frame of the points: z up, x along the longer side of the
    /// footprint, which is the [`BoundingRectangle`] of the outline. `None` for fewer than three
    /// points or collinear points.
    pub(crate) fn upright_box(&mut self) -> Option<OrientedBox> {
        self.join_added();
        let rectangle = BoundingRectangle::of_outline(self.hull.corners())?;
        let [low_m, high_m] = self.height_m;
        let centre = Translation3::new(
            rectangle.centre.x,
            rectangle.centre.y,
            f64::midpoint(low_m, high_m),
        );
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rectangle.yaw_rad);
        let upright_from_box = RigidTransform::from_parts(centre, yaw);
        let object_from_upright = RigidTransform::from_parts(
            Translation3::identity(),
            self.upright_from_object.inverse(),
        );
        Some(OrientedBox {
            frame_from_box: object_from_upright * upright_from_box,
            half_sides_m: rectangle.half_sides_m.push(0.5 * (high_m - low_m)),
        })
    }

    /// Relative growth of the footprint's bounding rectangle when rotated by `turn_rad`, in the
    /// direction of less growth; 1 for no growth. `None` as for
    /// [`upright_box`](Self::upright_box).
    pub(crate) fn growth_when_turned(&mut self, turn_rad: f64) -> Option<f64> {
        self.join_added();
        let corners = self.hull.corners();
        let rectangle = BoundingRectangle::of_outline(corners)?;
        let grown = [turn_rad, -turn_rad].map(|turn_rad| {
            let turned = BoundingRectangle::at_yaw(corners, rectangle.yaw_rad + turn_rad);
            turned.area_m2() / rectangle.area_m2()
        });
        Some(grown[0].min(grown[1]))
    }

    fn join_added(&mut self) {
        if !self.added.is_empty() {
            self.added.extend(self.hull.corners());
            self.hull.assign_convex_hull_of(&mut self.added);
            if !self.hull.corners().is_empty() {
                self.added.clear();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn corners(sides_m: [f64; 3]) -> impl Iterator<Item = Point3<f64>> {
        (0..8).map(move |i| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
            Point3::new(
                sides_m[0] * sign(0),
                sides_m[1] * sign(1),
                sides_m[2] * sign(2),
            )
        })
    }

    proptest! {
        #[test]
        fn a_turned_box_is_found_again(
            yaw in -3.0..3.0_f64, long in 0.1..0.3_f64, share in 0.2..0.95_f64, x in -1.0..1.0_f64,
        ) {
            let pose = RigidTransform::new(Vector3::new(x, 0.2, 0.7), Vector3::z() * yaw);
            let mut outline = UprightOutline::new(&Vector3::z_axis());
            for corner in corners([long, share * long, 0.1]) {
                outline.add(&(pose * corner));
            }
            let found = outline.upright_box().unwrap();
            prop_assert!((found.sides_m() - Vector3::new(long, share * long, 0.1)).norm() < 1e-9);
            prop_assert!((found.centre() - pose.translation.vector).coords.norm() < 1e-9);
            let turn = found.frame_from_box.rotation.inverse() * pose.rotation;
            prop_assert!((turn * Vector3::x()).y.abs() < 1e-9);
        }
    }

    #[test]
    fn box_is_upright_for_a_tipped_object() {
        let tipped = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
        let up = tipped.inverse() * Vector3::z_axis();
        let mut outline = UprightOutline::new(&up);
        corners([0.1, 0.2, 0.3]).for_each(|corner| outline.add(&corner));
        let in_world = outline
            .upright_box()
            .unwrap()
            .transformed(&RigidTransform::from_parts(
                Translation3::identity(),
                tipped,
            ));
        assert!((in_world.sides_m() - Vector3::new(0.3, 0.2, 0.1)).norm() < 1e-9);
        let z = in_world.frame_from_box.rotation * Vector3::z();
        assert!((z - Vector3::z()).norm() < 1e-9);
    }

    #[test]
    fn growth_distinguishes_a_box_from_a_cylinder() {
        let mut square = UprightOutline::new(&Vector3::z_axis());
        corners([0.1, 0.1, 0.1]).for_each(|corner| square.add(&corner));
        let mut round = UprightOutline::new(&Vector3::z_axis());
        for i in 0..360 {
            let (sin, cos) = f64::from(i).to_radians().sin_cos();
            round.add(&Point3::new(0.1 * cos, 0.1 * sin, 0.0));
        }
        let turn_rad = 15_f64.to_radians();
        // Growth is (sin 15° + cos 15°)^2 = 1.5.
        assert!((square.growth_when_turned(turn_rad).unwrap() - 1.5).abs() < 1e-9);
        assert!((round.growth_when_turned(turn_rad).unwrap() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn points_on_a_line_have_no_box() {
        let mut outline = UprightOutline::new(&Vector3::z_axis());
        assert!(outline.upright_box().is_none());
        for i in 0..5 {
            outline.add(&Point3::new(f64::from(i), 0.0, 0.0));
        }
        assert!(outline.upright_box().is_none());
        outline.add(&Point3::new(0.0, 1.0, 0.5));
        assert!((outline.upright_box().unwrap().sides_m().z - 0.5).abs() < 1e-12);
    }
}
