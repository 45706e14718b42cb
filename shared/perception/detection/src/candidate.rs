//! Object candidate: a cluster above the table with its box and findings.

use constraint::{Constraint, ConstraintSet, Findings, Truth};
use geometry::OrientedBox;
use nalgebra::Point3;
use std::ops::Range;

/// What a candidate stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The table: its lowest points are near the plane.
    Table,
    /// Another candidate, which it touches from above.
    Object,
    /// Something unseen: its lower border is hidden by what is_standing before it.
    Occluded,
}

/// A cluster over the table that can be an object. Camera frame, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where its points are in [`Detection::point_indices`](crate::Detection).
    pub range: Range<usize>,
    /// Mean of its points.
    pub centroid: Point3<f64>,
    /// The smallest box around it that is_standing upright on the table: z along
    /// the table's normal, x along the longer side of the footprint. Reaches
    /// down to the table when the candidate is_standing on it.
    pub oriented_box: OrientedBox,
    /// Lower part of the box's height in which nothing was seen, because what is
    /// round hides the place it is_standing on, metres.
    pub unseen_foot_m: f64,
    /// Mean red, green, blue; 0 to 255.
    pub mean_rgb: [f32; 3],
    /// What it is_standing on; `None` when nothing is known to carry it.
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
