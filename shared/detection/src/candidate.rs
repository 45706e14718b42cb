//! A cluster that can be an object.

use crate::RawConfig;
use crate::axis::Axis;
use crate::footprint::Footprint;
use crate::prism::SeenRectangle;
use crate::table_plane::Table;
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
        let (mut seen, mut height_m) = (SeenRectangle::default(), [f32::INFINITY, f32::NEG_INFINITY]);
        for &pixel in pixels {
            let point = &cloud.points()[pixel as usize];
            position += point.position().coords;
            for (sum, value) in rgb.iter_mut().zip(point.color.rgb()) {
                *sum += u64::from(value);
            }
            seen.add(pixel as usize % cloud.width(), pixel as usize / cloud.width());
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

/// The smallest upright box around points; `None` without points.
pub(crate) fn upright_box(
    pixels: &[u32],
    points: &[Point],
    table: &Table,
    height_m: [f64; 2],
) -> Option<OrientedBox> {
    let [u, v, _] = Axis::of_transform(&table.table_from_camera);
    let mut footprint = Footprint::new();
    for &pixel in pixels.iter().step_by(pixels.len().div_ceil(N_FOOTPRINT_MAX).max(1)) {
        let point = &points[pixel as usize];
        footprint.add(u.at(point.x, point.y, point.z), v.at(point.x, point.y, point.z));
    }
    let rectangle = footprint.smallest_rectangle()?;
    let centre = Translation3::new(
        rectangle.centre.x,
        rectangle.centre.y,
        0.5 * (height_m[0] + height_m[1]),
    );
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rectangle.yaw_rad);
    let table_from_box = RigidTransform::from_parts(centre, yaw);
    Some(OrientedBox {
        frame_from_box: table.table_from_camera.inverse() * table_from_box,
        half_sides_m: Vector3::new(
            rectangle.half_sides_m.x,
            rectangle.half_sides_m.y,
            0.5 * (height_m[1] - height_m[0]),
        ),
    })
}
