//! Objects on the table, as a task sees them, and how they lie on each other.

use geometry::OrientedBox;
use nalgebra::{Point2, Vector3};
use scene_document::CategoryAnswer;

/// Distance between the foot of an object and the top of what it lies on, metres. Chosen.
const CONTACT_M: f64 = 0.03;

/// Object of the newest scene.
#[derive(Debug, Clone, PartialEq)]
pub struct TableObject {
    /// Track-id.
    pub track: u64,
    /// Best category.
    pub label: Option<String>,
    /// Certainty of the label.
    pub answer: CategoryAnswer,
    /// Box around the object, world, z up.
    pub body: OrientedBox,
    /// True if the object is seen in this scene.
    pub is_seen: bool,
}

impl TableObject {
    /// Middle of the object seen from above, metres.
    pub(crate) fn middle(&self) -> Point2<f64> {
        self.body.centre().xy()
    }

    /// Heights of foot and top, metres.
    fn heights_m(&self) -> [f64; 2] {
        let half = self.half_extents_m();
        let z = self.body.centre().z;
        [z - half.z, z + half.z]
    }

    /// Half extents along the axes of the world, metres.
    fn half_extents_m(&self) -> Vector3<f64> {
        let rotation = self.body.frame_from_box.rotation.to_rotation_matrix();
        rotation.matrix().abs() * self.body.half_sides_m
    }

    /// True if another object lies on or in this one.
    pub(crate) fn carries(&self, other: &Self) -> bool {
        let [foot, top] = self.heights_m();
        let [other_foot, other_top] = other.heights_m();
        let centre_in_box = self.body.frame_from_box.inverse() * other.body.centre();
        let is_over = (0..2).all(|axis| centre_in_box[axis].abs() <= self.body.half_sides_m[axis]);
        let is_smaller = other.body.volume_m3() < self.body.volume_m3();
        let lies_on = (other_foot - top).abs() <= CONTACT_M && other_top > top;
        let lies_in = other_foot > foot && other_foot < top && is_smaller;
        self.track != other.track && is_over && (lies_on || lies_in)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use geometry::RigidTransform;

    /// Named object of a size, standing at a place of a table at height zero.
    pub(crate) fn object(
        track: u64,
        label: &str,
        foot_m: [f64; 3],
        sides_m: [f64; 3],
    ) -> TableObject {
        let [x, y, z] = foot_m;
        TableObject {
            track,
            label: (!label.is_empty()).then(|| label.to_owned()),
            answer: if label.is_empty() {
                CategoryAnswer::Unknown
            } else {
                CategoryAnswer::Is
            },
            body: OrientedBox {
                frame_from_box: RigidTransform::translation(x, y, z + 0.5 * sides_m[2]),
                half_sides_m: 0.5 * Vector3::from(sides_m),
            },
            is_seen: true,
        }
    }

    #[test]
    fn what_lies_on_or_in_another_thing_is_carried() {
        let tray = object(1, "tray", [0.0, 0.0, 0.0], [0.4, 0.3, 0.05]);
        let cup = object(2, "cup", [0.1, 0.0, 0.05], [0.07, 0.07, 0.09]);
        let apple = object(3, "apple", [0.1, 0.05, 0.01], [0.06, 0.06, 0.06]);
        let beside = object(4, "box", [0.3, 0.0, 0.0], [0.1, 0.1, 0.1]);
        assert!(tray.carries(&cup) && tray.carries(&apple));
        assert!(!tray.carries(&beside) && !cup.carries(&tray) && !tray.carries(&tray));
    }
}
