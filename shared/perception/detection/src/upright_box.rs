//! Upright bounding box in the frame of the table.

use crate::affine_form::AffineForm;
use crate::footprint::Footprint;
use geometry::{BoundingRectangle, OrientedBox, RigidTransform};
use nalgebra::{Point2, Translation3, UnitQuaternion, Vector3};
use point_cloud::Point;

/// Greatest number of points of which a footprint is taken.
const N_FOOTPRINT_MAX: usize = 4096;

/// Upright bounding box in the table's frame: bounding rectangle of the footprint and height range.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UprightBox {
    footprint: BoundingRectangle,
    /// Least and greatest height over the table, metres.
    height_m: [f64; 2],
}

impl UprightBox {
    /// Upright bounding box of points; `None` without points.
    pub(crate) fn around(
        pixels: &[u32],
        points: &[Point],
        table_axes: &[AffineForm; 3],
        height_m: [f64; 2],
    ) -> Option<Self> {
        let [u, v, _] = table_axes;
        let mut footprint = Footprint::new();
        let step = pixels.len().div_ceil(N_FOOTPRINT_MAX).max(1);
        footprint.add_all(pixels.len().div_ceil(step), |i| {
            let point = &points[pixels[i * step] as usize];
            [u, v].map(|axis| axis.at(point.x, point.y, point.z))
        });
        Some(Self {
            footprint: footprint.bounding_rectangle()?,
            height_m,
        })
    }

    /// Longer and shorter side of the footprint, and height, metres.
    pub(crate) fn sides_m(&self) -> [f64; 3] {
        let [long, short] = (2.0 * self.footprint.half_sides_m).into();
        [long, short, self.height_m[1] - self.height_m[0]]
    }

    /// Length of the box's longest side, metres.
    pub(crate) fn longest_side_m(&self) -> f64 {
        let [long, _, height] = self.sides_m();
        long.max(height)
    }

    /// Area of the box's footprint, square metres.
    pub(crate) fn footprint_m2(&self) -> f64 {
        self.footprint.area_m2()
    }

    /// Disc around the footprint: centre in the table's frame, and radius, metres.
    pub(crate) fn disc(&self) -> (Point2<f64>, f64) {
        (self.footprint.centre, self.footprint.half_sides_m.norm())
    }

    /// Contact test: `true` when two boxes are within a horizontal and a vertical distance
    /// of each other, metres.
    pub(crate) fn touches(&self, other: &Self, horizontal_m: f64, vertical_m: f64) -> bool {
        self.height_m[0] <= other.height_m[1] + vertical_m
            && other.height_m[0] <= self.height_m[1] + vertical_m
            && self.footprint.overlaps(&other.footprint, horizontal_m)
    }

    /// Oriented box in the camera's frame.
    pub(crate) fn in_camera(&self, table_from_camera: &RigidTransform) -> OrientedBox {
        let Self {
            footprint,
            height_m: [low, high],
        } = self;
        let centre = Translation3::new(footprint.centre.x, footprint.centre.y, 0.5 * (low + high));
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), footprint.yaw_rad);
        let half_sides_m = footprint.half_sides_m.push(0.5 * (high - low));
        let table_from_box = RigidTransform::from_parts(centre, yaw);
        OrientedBox {
            frame_from_box: table_from_camera.inverse() * table_from_box,
            half_sides_m,
        }
    }
}
