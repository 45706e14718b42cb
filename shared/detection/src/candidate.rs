//! A cluster that can be an object.

use crate::RawConfig;
use crate::axis::Axis;
use crate::footprint::{Footprint, Rectangle};
use crate::prism::SeenRectangle;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use point_cloud::{OrganizedCloud, Point};
use std::ops::Range;

/// Share of a cluster's points that must be low for it to stand on the table.
const STANDING_SHARE: f64 = 0.005;

/// A footprint is taken from about this many points at most.
const N_FOOTPRINT_MAX: usize = 4096;

/// What a candidate stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The table: its lowest points are near the plane.
    Table,
    /// Another candidate, which it touches from above.
    Object,
    /// Something unseen: its lower border is hidden by what stands before it.
    Hidden,
}

/// A cluster over the table that can be an object. Camera frame, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where its points are in [`Detection::point_indices`](crate::Detection).
    pub range: Range<usize>,
    /// Mean of its points.
    pub centroid: Point3<f64>,
    /// The smallest box around it that stands upright on the table: z along
    /// the table's normal, x along the longer side of the footprint. Reaches
    /// down to the table when the candidate stands on it.
    pub oriented_box: OrientedBox,
    /// Mean red, green, blue; 0 to 255.
    pub mean_rgb: [f32; 3],
    /// What it stands on.
    pub support: Support,
    /// Whether it comes to the border of what the sensor sees, so that a part
    /// of it may be missing.
    pub touches_image_border: bool,
}

impl Candidate {
    /// Number of its points.
    pub fn n_points(&self) -> usize {
        self.range.len()
    }
}

/// A cluster that may be an object, while it is being judged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body {
    pub(crate) cluster: u32,
    pub(crate) summary: Summary,
    pub(crate) upright_box: UprightBox,
    /// `None` as long as nothing is known to carry it.
    pub(crate) support: Option<Support>,
}

/// Sums over a cluster.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Summary {
    pub(crate) centroid: Point3<f64>,
    pub(crate) mean_rgb: [f32; 3],
    pub(crate) seen: SeenRectangle,
    pub(crate) height_m: [f32; 2],
    pub(crate) stands: bool,
}

impl Summary {
    /// Sums over the pixels of a cluster, of which there must be at least one.
    pub(crate) fn of(
        pixels: &[u32],
        cloud: &OrganizedCloud<'_>,
        height: &Axis,
        config: &RawConfig,
    ) -> Self {
        let mut position = Vector3::<f64>::zeros();
        let (mut rgb, mut n_low) = ([0_u64; 3], 0_u32);
        let (mut seen, mut height_m) =
            (SeenRectangle::default(), [f32::INFINITY, f32::NEG_INFINITY]);
        for &pixel in pixels {
            let point = &cloud.points()[pixel as usize];
            position += point.position().coords;
            for (sum, value) in rgb.iter_mut().zip(point.color.rgb()) {
                *sum += u64::from(value);
            }
            seen.add(
                pixel as usize % cloud.width(),
                pixel as usize / cloud.width(),
            );
            let h = height.at(point.x, point.y, point.z);
            height_m = [height_m[0].min(h), height_m[1].max(h)];
            n_low += u32::from(h <= config.standing_gap_max_m as f32);
        }
        let n = pixels.len().max(1) as f64;
        Self {
            centroid: (position / n).into(),
            mean_rgb: rgb.map(|sum| (sum as f64 / n) as f32),
            seen,
            height_m,
            stands: f64::from(n_low) >= (STANDING_SHARE * n).max(3.0),
        }
    }
}

/// A box that stands upright on the table, in the table's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UprightBox {
    footprint: Rectangle,
    /// Lowest and highest point over the table.
    height_m: [f64; 2],
}

impl UprightBox {
    /// The smallest one around points; `None` without points.
    pub(crate) fn around(
        pixels: &[u32],
        points: &[Point],
        table_axes: &[Axis; 3],
        height_m: [f64; 2],
    ) -> Option<Self> {
        let [u, v, _] = table_axes;
        let mut footprint = Footprint::new();
        for &pixel in pixels
            .iter()
            .step_by(pixels.len().div_ceil(N_FOOTPRINT_MAX).max(1))
        {
            let point = &points[pixel as usize];
            footprint.add(
                u.at(point.x, point.y, point.z),
                v.at(point.x, point.y, point.z),
            );
        }
        Some(Self {
            footprint: footprint.smallest_rectangle()?,
            height_m,
        })
    }

    /// Length of the longest side, metres.
    pub(crate) fn longest_side_m(&self) -> f64 {
        (2.0 * self.footprint.half_sides_m.x).max(self.height_m[1] - self.height_m[0])
    }

    /// Area of the footprint, square metres.
    pub(crate) fn footprint_m2(&self) -> f64 {
        4.0 * self.footprint.half_sides_m.product()
    }

    /// Whether two boxes come within a distance of each other.
    pub(crate) fn touches(&self, other: &Self, distance_m: f64) -> bool {
        self.height_m[0] <= other.height_m[1] + distance_m
            && other.height_m[0] <= self.height_m[1] + distance_m
            && self.footprint.overlaps(&other.footprint, distance_m)
    }

    /// The box in the camera's frame.
    pub(crate) fn in_camera(&self, table_from_camera: &RigidTransform) -> OrientedBox {
        let Self {
            footprint,
            height_m: [low, high],
        } = self;
        let centre = Translation3::new(footprint.centre.x, footprint.centre.y, 0.5 * (low + high));
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), footprint.yaw_rad);
        let half_sides_m = Vector3::new(
            footprint.half_sides_m.x,
            footprint.half_sides_m.y,
            0.5 * (high - low),
        );
        let table_from_box = RigidTransform::from_parts(centre, yaw);
        OrientedBox {
            frame_from_box: table_from_camera.inverse() * table_from_box,
            half_sides_m,
        }
    }
}
