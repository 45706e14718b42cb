//! Object candidate: a cluster above the table with its box and findings.

use constraint::{Constraint, ConstraintSet, Findings, Ternary};
use geometry::OrientedBox;
use nalgebra::Point3;
use std::ops::Range;

/// Support relation of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// Table: the lowest points are near the plane.
    Table,
    /// Supported by another candidate below, in contact.
    Object,
    /// Unknown support: the lower border is occluded by a nearer surface.
    Occluded,
}

/// Object candidate: a cluster above the table with box, support and findings. Camera
/// frame, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Range of the candidate's points in [`Detection::point_indices`](crate::Detection).
    pub range: Range<usize>,
    /// Index of the surface on or over which it stands, in
    /// [`Detection::surfaces`](crate::Detection).
    pub surface: usize,
    /// Centroid: mean of the candidate's points.
    pub centroid: Point3<f64>,
    /// Minimum-area upright bounding box: z along the table's normal, x along the longer
    /// side of the footprint. Extends down to the table when the candidate stands on it.
    pub oriented_box: OrientedBox,
    /// Height of the lower part of the box without any point, metres, because a round
    /// object occludes its own contact area.
    pub occluded_base_m: f64,
    /// Mean colour: red, green, blue, each 0 to 255.
    pub mean_rgb: [f32; 3],
    /// Support relation; `None` when no support is known.
    pub support: Option<Support>,
    /// `true` when the candidate reaches the border of the sensor's view, so that a part of
    /// it may be missing.
    pub touches_image_border: bool,
    /// `true` when the longest side is between `side_min_m` and `side_max_m` of the
    /// settings.
    pub is_object_sized: bool,
    /// Findings of all constraints about the candidate.
    pub findings: Findings,
    /// Verdict of the rule. False for a candidate that is not object-sized, whatever the
    /// rule says. Only a true verdict begins a track.
    pub verdict: Ternary,
    /// Constraints that decided the verdict.
    pub decisive: ConstraintSet,
}

impl Candidate {
    /// Number of points of the candidate.
    pub fn n_points(&self) -> usize {
        self.range.len()
    }

    /// `true` when size and support allow an object that is neither person nor robot,
    /// before the rule is evaluated.
    pub fn is_hypothesis(&self) -> bool {
        self.is_object_sized && self.support.is_some() && !self.findings.is_person_or_robot()
    }

    /// `true` when a person or the robot may touch the candidate, so that a part of it may
    /// be missing.
    pub fn is_touched(&self) -> bool {
        let limbs = [Constraint::Instructor, Constraint::Robot];
        let mut truths = limbs.map(|limb| self.findings.get(limb).value).into_iter();
        truths.any(|truth| truth == Ternary::Unknown)
    }

    /// `true` when the candidate can be the observation of a live track, whatever the rule
    /// says: everything of an object's size except people and the robot.
    pub fn can_continue_track(&self) -> bool {
        self.is_object_sized && !self.findings.is_person_or_robot()
    }
}
