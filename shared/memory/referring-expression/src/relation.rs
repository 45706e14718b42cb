//! Spatial relations between boxes, graded by geometry in the frame of the viewpoint.
//!
//! "Left", "right", "behind" and "in front of" are projective relations in the relative frame of
//! reference (Levinson, 2003): those of a person who looks along the camera. "In front of" means
//! nearer to that person.

use nalgebra::Vector3;

use crate::box_geometry::BoxGeometry;
use crate::world::Viewpoint;

coded_enum::coded_enum! {
    /// Relation of an object to a landmark.
    pub(crate) enum Relation {
        LeftOf, "left of";
        RightOf, "right of";
        Behind, "behind";
        InFrontOf, "in front of";
        NextTo, "next to";
        FarFrom, "far from";
        On, "on";
        Under, "under";
        Above, "above";
        In, "in";
    }
}

coded_enum::coded_enum! {
    /// Absolute place, relative to the spread of all objects.
    pub(crate) enum TablePlace {
        Left, "on the left";
        Right, "on the right";
        Front, "in front";
        Back, "at the back";
        Middle, "in the middle";
        /// The table itself, on which everything stands.
        Anywhere, "on the table";
    }
}

/// Horizontal directions of the viewpoint, of unit length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ViewFrame {
    pub(crate) position: Vector3<f64>,
    pub(crate) right: Vector3<f64>,
    pub(crate) forward: Vector3<f64>,
}

/// Error of the height of a box's top or bottom. Chosen.
const CONTACT_ERROR_M: f64 = 0.02;

impl ViewFrame {
    /// Frame of a viewpoint; None if a direction is vertical or not a number.
    pub(crate) fn new(viewpoint: &Viewpoint) -> Option<Self> {
        let horizontal = |direction: [f64; 3]| {
            let flat = Vector3::new(direction[0], direction[1], 0.0);
            flat.try_normalize(1e-6)
                .filter(|unit| unit.iter().all(|part| part.is_finite()))
        };
        let position = Vector3::from(viewpoint.position_in_world_m);
        Some(Self {
            position,
            right: horizontal(viewpoint.right_in_world)?,
            forward: horizontal(viewpoint.forward_in_world)?,
        })
        .filter(|frame| frame.position.iter().all(|part| part.is_finite()))
    }
}

impl Relation {
    /// True if the relation depends on the viewpoint.
    pub(crate) fn needs_view(self) -> bool {
        matches!(
            self,
            Self::LeftOf | Self::RightOf | Self::Behind | Self::InFrontOf
        )
    }

    /// Score of the relation between an object and a landmark, 0 to 1.
    ///
    /// 0 for a projective relation without a view.
    pub(crate) fn score(
        self,
        object: &BoxGeometry,
        landmark: &BoxGeometry,
        view: Option<&ViewFrame>,
    ) -> f64 {
        let projective = |direction: fn(&ViewFrame) -> Vector3<f64>| {
            view.map_or(0.0, |view| {
                projective_score(object, landmark, &direction(view))
            })
        };
        match self {
            Self::LeftOf => projective(|view| -view.right),
            Self::RightOf => projective(|view| view.right),
            Self::Behind => projective(|view| view.forward),
            Self::InFrontOf => projective(|view| -view.forward),
            Self::NextTo => nearness(object, landmark),
            Self::FarFrom => ramp(relative_gap(object, landmark), 1.5, 4.0),
            Self::On => support_score(object, landmark),
            Self::Under => above_score(landmark, object),
            Self::Above => above_score(object, landmark),
            Self::In => containment_score(object, landmark),
        }
    }
}

/// Rising ramp: 0 up to `from`, 1 from `to` on. It falls if `to` is less than `from`.
pub(crate) fn ramp(value: f64, from: f64, to: f64) -> f64 {
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// Score of an object's offset to a landmark in a horizontal direction.
///
/// Full if the extents are apart and the offset is within 10 degrees of the direction; 0 if the
/// object overlaps by three quarters, or if the offset is nearly across. People accept a projective
/// relation the less, the more the offset deviates from its direction (Logan and Sadler, 1996).
fn projective_score(object: &BoxGeometry, landmark: &BoxGeometry, direction: &Vector3<f64>) -> f64 {
    let mut offset = object.centre - landmark.centre;
    offset.z = 0.0;
    let along = offset.dot(direction);
    let across = (offset - along * direction).norm();
    let extents = object.half_extent_m(direction) + landmark.half_extent_m(direction);
    let apart = ramp(along / extents.max(1e-3), 0.25, 0.9);
    let angle_deg = across.atan2(along).to_degrees();
    apart * ramp(angle_deg, 80.0, 10.0)
}

/// Gap relative to the sizes of both boxes.
fn relative_gap(object: &BoxGeometry, landmark: &BoxGeometry) -> f64 {
    let scale_m = (object.radius_m() + landmark.radius_m()).max(0.06);
    object.gap_m(landmark) / scale_m
}

fn nearness(object: &BoxGeometry, landmark: &BoxGeometry) -> f64 {
    let is_level = ramp(object.vertical_gap_m(landmark), 0.15, 0.05);
    let is_stacked = support_score(object, landmark).max(support_score(landmark, object));
    ramp(relative_gap(object, landmark), 2.0, 0.8) * is_level * (1.0 - is_stacked)
}

fn support_score(object: &BoxGeometry, support: &BoxGeometry) -> f64 {
    let gap_m = (object.bottom_m() - support.top_m()).abs();
    let contact = ramp(gap_m, 3.0 * CONTACT_ERROR_M, CONTACT_ERROR_M);
    contact * overlap_of_smaller(object, support)
}

fn above_score(upper: &BoxGeometry, lower: &BoxGeometry) -> f64 {
    let clearance_m = upper.bottom_m() - lower.top_m();
    ramp(clearance_m, -3.0 * CONTACT_ERROR_M, -CONTACT_ERROR_M) * overlap_of_smaller(upper, lower)
}

fn overlap_of_smaller(a: &BoxGeometry, b: &BoxGeometry) -> f64 {
    let overlap = a.footprint_overlap(b).max(b.footprint_overlap(a));
    ramp(overlap, 0.2, 0.6)
}

fn containment_score(object: &BoxGeometry, container: &BoxGeometry) -> f64 {
    let footprint = ramp(object.footprint_overlap(container), 0.4, 0.8);
    let is_over_bottom = ramp(
        object.bottom_m() - container.bottom_m(),
        -2.0 * CONTACT_ERROR_M,
        -CONTACT_ERROR_M,
    );
    let depth_m = container.top_m() - object.bottom_m();
    let is_sunk = ramp(depth_m, 0.0, 0.25 * container.height_m().max(1e-3));
    let [shorter, longer] = container.footprint_edges_m();
    let [object_shorter, object_longer] = object.footprint_edges_m();
    let is_smaller = ramp(
        (object_shorter * object_longer) / (shorter * longer).max(1e-6),
        1.2,
        0.95,
    );
    footprint * is_over_bottom * is_sunk * is_smaller
}

/// Score of an object between two landmarks, 0 to 1, from no viewpoint: its centre lies beyond the
/// inner faces of both, and near the segment between their centres.
pub(crate) fn between_score(object: &BoxGeometry, ends: [&BoxGeometry; 2]) -> f64 {
    let flat = |vector: Vector3<f64>| Vector3::new(vector.x, vector.y, 0.0);
    let line = flat(ends[1].centre - ends[0].centre);
    let offset = flat(object.centre - ends[0].centre);
    let length_m = line.norm();
    if length_m < 1e-3 {
        return 0.0;
    }
    let fraction = offset.dot(&line) / (length_m * length_m);
    let aside_m = (offset - fraction * line).norm();
    let radius_m = ends[0].radius_m().max(ends[1].radius_m()) + object.radius_m();
    let direction = line / length_m;
    let is_beyond = |end: &BoxGeometry, distance_m: f64| {
        let half_m = end.half_extent_m(&direction);
        ramp(distance_m, 0.5 * half_m, half_m.max(0.15 * length_m))
    };
    let along_m = fraction * length_m;
    let is_inside = is_beyond(ends[0], along_m) * is_beyond(ends[1], length_m - along_m);
    let far_m = radius_m.max(0.3 * length_m);
    is_inside * ramp(aside_m, 1.2 * far_m, 0.5 * far_m)
}

impl TablePlace {
    /// Score of an object's place among all objects, 0 to 1.
    pub(crate) fn score(self, object: &BoxGeometry, all: &[BoxGeometry], view: &ViewFrame) -> f64 {
        let across = position_among(object, all, &view.right);
        let depth = position_among(object, all, &view.forward);
        match self {
            Self::Left => ramp(across, 0.6, 0.3),
            Self::Right => ramp(across, 0.4, 0.7),
            Self::Front => ramp(depth, 0.6, 0.3),
            Self::Back => ramp(depth, 0.4, 0.7),
            Self::Middle => {
                // People mean the middle between left and right more than that in depth.
                let off_centre = (across - 0.5).abs().max(0.4 * (depth - 0.5).abs());
                ramp(off_centre, 0.35, 0.15)
            }
            Self::Anywhere => 1.0,
        }
    }
}

/// Position of an object in the range of all objects along a direction, 0 to 1; 0.5 without range.
fn position_among(object: &BoxGeometry, all: &[BoxGeometry], direction: &Vector3<f64>) -> f64 {
    let positions = all.iter().map(|other| other.centre.dot(direction));
    let (from, to) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), p| {
        (from.min(p), to.max(p))
    });
    if to - from > 0.02 {
        (object.centre.dot(direction) - from) / (to - from)
    } else {
        0.5
    }
}
