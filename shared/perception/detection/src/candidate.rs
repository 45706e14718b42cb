//! A cluster that can be an object.

use crate::RawConfig;
use crate::axis::Axis;
use crate::footprint::{Footprint, Rectangle};
use crate::prism::SeenRectangle;
use constraint::{Constraint, ConstraintSet, Findings, Truth};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use point_cloud::{OrganizedCloud, Point};
use std::ops::Range;

/// Share of a cluster's points that must be low for it to stand on the table.
const STANDING_SHARE: f64 = 0.005;

/// A ball hides the place it stands on from a camera above it: what begins below
/// this share of its own height, and below this height, metres, may stand, too.
const ROUND_GAP_SHARE: f32 = 0.2;
const ROUND_GAP_MAX_M: f32 = 0.05;

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
    /// Lower part of the box's height in which nothing was seen, because what is
    /// round hides the place it stands on, metres.
    pub unseen_foot_m: f64,
    /// Mean red, green, blue; 0 to 255.
    pub mean_rgb: [f32; 3],
    /// What it stands on; `None` when nothing is known to carry it.
    pub support: Option<Support>,
    /// Whether it comes to the border of what the sensor sees, so that a part
    /// of it may be missing.
    pub touches_image_border: bool,
    /// Whether it is as large as objects are: its longest side lies between the
    /// `side_min_m` and `side_max_m` of the settings.
    pub is_object_sized: bool,
    /// What every constraint says of it.
    pub findings: Findings,
    /// What the rule says of it; false for what is no object by its size,
    /// whatever the rule says. Only what is true begins a track.
    pub verdict: Truth,
    /// The constraints that made the verdict what it is.
    pub decisive: ConstraintSet,
}

impl Candidate {
    /// Number of its points.
    pub fn n_points(&self) -> usize {
        self.range.len()
    }

    /// Whether it can be an object by its size and by what carries it, before
    /// any rule is asked.
    pub fn is_hypothesis(&self) -> bool {
        self.is_object_sized && self.support.is_some() && !self.findings.is_limb()
    }

    /// Whether a person or the robot may touch it, so that a part of it may be
    /// missing.
    pub fn is_touched(&self) -> bool {
        let limbs = [Constraint::Instructor, Constraint::Robot];
        let mut truths = limbs.map(|limb| self.findings.of(limb).truth).into_iter();
        truths.any(|truth| truth == Truth::Unknown)
    }

    /// Whether it can be what a live track sees now, whatever the rule says:
    /// everything of an object's size but a person and the robot.
    pub fn can_continue_track(&self) -> bool {
        self.is_object_sized && !self.findings.is_limb()
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
    /// Whether there is no depth where it should stand.
    pub(crate) is_lower_end_unseen: bool,
    /// Whether its longest side is as long as an object's.
    pub(crate) is_object_sized: bool,
    /// Whether its points were told apart as those of a person or the robot; its
    /// cluster is then one of those.
    pub(crate) is_limb: bool,
}

impl Body {
    /// The body of some points of a cloud, of which nothing is known yet but
    /// whether it stands on the table; `None` without points.
    pub(crate) fn of(
        cluster: u32,
        indices: &[u32],
        cloud: &OrganizedCloud<'_>,
        table_axes: &[Axis; 3],
        config: &RawConfig,
    ) -> Option<Self> {
        if indices.is_empty() {
            return None;
        }
        let summary = Summary::of(indices, cloud, &table_axes[2], config);
        let [lowest_m, highest_m] = summary.height_m.map(f64::from);
        let heights_m = [if summary.stands { 0.0 } else { lowest_m }, highest_m];
        let upright_box = UprightBox::around(indices, cloud.points(), table_axes, heights_m)?;
        let sides = config.side_min_m..=config.side_max_m;
        Some(Self {
            cluster,
            summary,
            upright_box,
            support: summary.stands.then_some(Support::Table),
            is_lower_end_unseen: false,
            is_object_sized: sides.contains(&upright_box.longest_side_m()),
            is_limb: false,
        })
    }
}

impl Body {
    /// Lower part of its box in which nothing was seen, metres.
    pub(crate) fn unseen_foot_m(&self) -> f64 {
        let Summary {
            stands,
            is_low,
            height_m,
            ..
        } = self.summary;
        if stands && !is_low {
            f64::from(height_m[0]).max(0.0)
        } else {
            0.0
        }
    }
}

/// Sums over a cluster.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Summary {
    pub(crate) centroid: Point3<f64>,
    pub(crate) mean_rgb: [f32; 3],
    pub(crate) seen: SeenRectangle,
    pub(crate) height_m: [f32; 2],
    /// Whether enough of its points are low for it to stand on the table.
    pub(crate) is_low: bool,
    /// Whether it stands on the table: also what is round, whose foot is hidden.
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
        // A division of 64 bits takes twice as long.
        let width = cloud.width() as u32;
        for &pixel in pixels {
            let point = &cloud.points()[pixel as usize];
            position += point.position().coords;
            for (sum, value) in rgb.iter_mut().zip(point.color.rgb()) {
                *sum += u64::from(value);
            }
            seen.add((pixel % width) as usize, (pixel / width) as usize);
            let h = height.at(point.x, point.y, point.z);
            height_m = [height_m[0].min(h), height_m[1].max(h)];
            n_low += u32::from(h <= config.standing_gap_max_m as f32);
        }
        let n = pixels.len().max(1) as f64;
        let [lowest_m, highest_m] = height_m;
        let is_round = lowest_m <= (ROUND_GAP_SHARE * highest_m).min(ROUND_GAP_MAX_M);
        let is_low = f64::from(n_low) >= (STANDING_SHARE * n).max(3.0);
        Self {
            centroid: (position / n).into(),
            mean_rgb: rgb.map(|sum| (sum as f64 / n) as f32),
            seen,
            height_m,
            is_low,
            stands: is_round || is_low,
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
        let step = pixels.len().div_ceil(N_FOOTPRINT_MAX).max(1);
        footprint.add_all(pixels.len().div_ceil(step), |i| {
            let point = &points[pixels[i * step] as usize];
            [u, v].map(|axis| axis.at(point.x, point.y, point.z))
        });
        Some(Self {
            footprint: footprint.smallest_rectangle()?,
            height_m,
        })
    }

    /// Longer and shorter side of the footprint, and height, metres.
    pub(crate) fn sides_m(&self) -> [f64; 3] {
        let [long, short] = (2.0 * self.footprint.half_sides_m).into();
        [long, short, self.height_m[1] - self.height_m[0]]
    }

    /// Length of the longest side, metres.
    pub(crate) fn longest_side_m(&self) -> f64 {
        let [long, _, height] = self.sides_m();
        long.max(height)
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
