//! Ground-truth shape of a simulated object: whole surface, seen surface, symmetry.

use crate::upright_outline::UprightOutline;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, UnitQuaternion, UnitVector3, Vector3};
use std::collections::HashSet;
use std::f64::consts::PI;

/// Cell size of the deduplication of surface points, metres. Chosen.
const CELL_M: f32 = 0.001;
/// Change of the up direction in the object frame that rebuilds an outline, radians.
/// Chosen.
const TILT_RAD: f64 = 0.004;
/// Directional footprint: minimum growth of the bounding rectangle's area when rotated by
/// [`DIRECTIONAL_TURN_RAD`]. Chosen.
const DIRECTIONAL_GROWTH_MIN: f64 = 1.15;
const DIRECTIONAL_TURN_RAD: f64 = PI / 12.0;
/// Ratio of sides below which they count as equal. Chosen.
const EQUAL_SIDES_RATIO_MAX: f64 = 1.1;

/// Rotational symmetry of an upright bounding box about the vertical.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// Rotational symmetry of any angle: the footprint has no direction.
    Round,
    /// Fourfold symmetry: a square footprint.
    Quarter,
    /// Twofold symmetry: a rectangular footprint.
    Half,
}

impl Symmetry {
    /// Angle between two orientations of an upright box up to its symmetry, radians. For a round
    /// footprint only the angle between the vertical axes.
    pub fn deviation_rad(self, a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
        let n_turns = match self {
            Self::Round => {
                return (a * Vector3::z()).angle(&(b * Vector3::z()));
            }
            Self::Quarter => 4,
            Self::Half => 2,
        };
        let turn_rad = 2.0 * PI / f64::from(n_turns);
        let turned = (0..n_turns).map(|i| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad * f64::from(i));
            (a * turn).angle_to(b)
        });
        turned.fold(f64::INFINITY, f64::min)
    }
}

/// Whole surface of an object as points.
#[derive(Debug, Clone)]
pub struct WholeShape {
    points: Vec<Point3<f64>>,
    outline: UprightOutline,
    known: Option<(OrientedBox, Symmetry)>,
}

impl WholeShape {
    /// Object shape from surface points in the object frame.
    pub fn new(points: Vec<Point3<f64>>) -> Self {
        Self {
            points,
            outline: UprightOutline::new(&Vector3::z_axis()),
            known: None,
        }
    }

    /// Upright bounding box at a pose (world frame) and its symmetry; `None` if the points are
    /// collinear.
    pub fn upright_box(
        &mut self,
        world_from_object: &RigidTransform,
        up_in_world: &UnitVector3<f64>,
    ) -> Option<(OrientedBox, Symmetry)> {
        let up = world_from_object.rotation.inverse() * up_in_world;
        if self.known.is_none() || up.angle(&self.outline.up()) > TILT_RAD {
            self.outline = UprightOutline::new(&up);
            for point in &self.points {
                self.outline.add(point);
            }
            let upright_box = self.outline.upright_box()?;
            let growth = self.outline.growth_when_turned(DIRECTIONAL_TURN_RAD)?;
            let sides = upright_box.half_sides_m;
            let symmetry = if growth < DIRECTIONAL_GROWTH_MIN {
                Symmetry::Round
            } else if sides.x < EQUAL_SIDES_RATIO_MAX * sides.y {
                Symmetry::Quarter
            } else {
                Symmetry::Half
            };
            self.known = Some((upright_box, symmetry));
        }
        let (upright_box, symmetry) = self.known?;
        Some((upright_box.transformed(world_from_object), symmetry))
    }
}

/// True surface of an object as far as a camera has seen it.
#[derive(Debug, Clone)]
pub struct SeenSurface {
    cells: HashSet<[i16; 3]>,
    points: Vec<Point3<f32>>,
    outline: UprightOutline,
    /// Number of points already in the outline.
    n_outlined: usize,
    upright_box: Option<OrientedBox>,
}

impl Default for SeenSurface {
    fn default() -> Self {
        Self {
            cells: HashSet::new(),
            points: Vec::new(),
            outline: UprightOutline::new(&Vector3::z_axis()),
            n_outlined: 0,
            upright_box: None,
        }
    }
}

impl SeenSurface {
    /// Adds a point in the object frame. Points beyond 32 m are ignored.
    pub fn add(&mut self, point: Point3<f32>) {
        let cell = point.coords.map(|value| (value / CELL_M).floor());
        if cell.iter().all(|value| value.abs() < f32::from(i16::MAX))
            && self.cells.insert(cell.map(|value| value as i16).into())
        {
            self.points.push(point);
        }
    }

    /// Upright bounding box of the seen surface, world frame; `None` while the points
    /// are collinear.
    pub fn upright_box(
        &mut self,
        world_from_object: &RigidTransform,
        up_in_world: &UnitVector3<f64>,
    ) -> Option<OrientedBox> {
        let up = world_from_object.rotation.inverse() * up_in_world;
        if up.angle(&self.outline.up()) > TILT_RAD {
            self.outline = UprightOutline::new(&up);
            self.n_outlined = 0;
        }
        if self.n_outlined < self.points.len() {
            for point in &self.points[self.n_outlined..] {
                self.outline.add(&point.cast());
            }
            self.n_outlined = self.points.len();
            self.upright_box = self.outline.upright_box();
        }
        Some(self.upright_box?.transformed(world_from_object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn yawed(yaw_rad: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad)
    }

    proptest! {
        #[test]
        fn turns_of_the_symmetry_change_nothing(yaw in -3.0..3.0_f64, k in 0..4_i32, off in -0.7..0.7_f64) {
            let found = yawed(yaw + off + FRAC_PI_2 * f64::from(k));
            let quarter = Symmetry::Quarter.deviation_rad(&found, &yawed(yaw));
            prop_assert!((quarter - off.abs()).abs() < 1e-6);
            let half = Symmetry::Half.deviation_rad(&found, &yawed(yaw));
            let expected = if k % 2 == 0 { off.abs() } else { FRAC_PI_2 - off.abs() };
            prop_assert!((half - expected).abs() < 1e-6);
            prop_assert!(Symmetry::Round.deviation_rad(&found, &yawed(yaw)) < 1e-6);
        }
    }

    #[test]
    fn tilt_is_never_symmetric() {
        let tilted = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.2);
        for symmetry in [Symmetry::Round, Symmetry::Quarter, Symmetry::Half] {
            let deviation_rad = symmetry.deviation_rad(&tilted, &UnitQuaternion::identity());
            assert!((deviation_rad - 0.2).abs() < 1e-9);
        }
    }

    fn prism(sides_m: [f64; 3]) -> Vec<Point3<f64>> {
        let sign = |i: usize, bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        (0..8)
            .map(|i| Point3::from(std::array::from_fn(|bit| sides_m[bit] * sign(i, bit))))
            .collect()
    }

    #[test]
    fn the_symmetry_follows_from_the_shape_as_it_stands() {
        let standing = RigidTransform::identity();
        let lying = RigidTransform::rotation(Vector3::y() * FRAC_PI_2);
        let up = Vector3::z_axis();
        let mut carton = WholeShape::new(prism([0.07, 0.07, 0.2]));
        assert_eq!(
            carton.upright_box(&standing, &up).unwrap().1,
            Symmetry::Quarter
        );
        assert_eq!(carton.upright_box(&lying, &up).unwrap().1, Symmetry::Half);
        let ring = (0..60).map(|i| f64::from(i) * PI / 30.0);
        let can =
            ring.flat_map(|a| [0.0, 0.12].map(|z| Point3::new(0.03 * a.cos(), 0.03 * a.sin(), z)));
        let mut can = WholeShape::new(can.collect());
        assert_eq!(can.upright_box(&standing, &up).unwrap().1, Symmetry::Round);
        assert_eq!(can.upright_box(&lying, &up).unwrap().1, Symmetry::Half);
    }

    #[test]
    fn the_seen_box_grows_with_what_is_seen_and_moves_with_the_object() {
        let mut seen = SeenSurface::default();
        let pose = RigidTransform::new(Vector3::new(0.3, 0.1, 0.8), Vector3::z() * 0.3);
        assert!(seen.upright_box(&pose, &Vector3::z_axis()).is_none());
        let grid = |range: std::ops::RangeInclusive<i16>| {
            range.flat_map(|i| {
                (0..=20).map(move |j| Point3::new(0.01 * f32::from(i), 0.002 * j as f32, 0.0))
            })
        };
        grid(-5..=0).for_each(|p| seen.add(p));
        let half = seen.upright_box(&pose, &Vector3::z_axis()).unwrap();
        assert!((half.sides_m() - Vector3::new(0.05, 0.04, 0.0)).norm() < 1e-5);
        grid(-5..=5).for_each(|p| seen.add(p));
        let whole = seen.upright_box(&pose, &Vector3::z_axis()).unwrap();
        assert!((whole.centre() - pose * Point3::new(0.0, 0.02, 0.0)).norm() < 1e-5);
    }
}
