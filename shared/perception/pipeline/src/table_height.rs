//! Height of the tracked table, by which a frame of another surface is told.
//!
//! A camera that looks away from the table still sees a level surface: the floor, a seat, a
//! counter. What stands there is furniture, and the objects of the table are out of sight. The
//! tracks remember the height of the table on which they were seen, so that no setting and no
//! search for the floor is needed.

use crate::frame_pose::FramePose;
use detection::Table;
use nalgebra::{Point3, Unit, Vector3};

/// Greatest difference in height between two views of one table, metres. Views of one table
/// differ by the error of the camera pose, 1 to 3 cm; a dining table (0.72 to 0.75 m) and a
/// counter (0.9 m, EN 1116) by 15 cm or more, a seat or the floor by more. Chosen.
const SAME_TABLE_M: f64 = 0.10;

/// Time after which another surface is the table, nanoseconds: it was found at one height all
/// the time, and no tracked object was in view. A glance aside is shorter, and a robot that has
/// come to another table stays there longer. Chosen.
const OTHER_TABLE_NS: u64 = 5_000_000_000;

/// Longest time without the other surface after which it still counts as found all the time,
/// nanoseconds. Chosen.
const GAP_NS: u64 = 1_000_000_000;

/// Place of a table along the up direction, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TableHeight {
    /// Middle of the visible part of the table.
    middle_in_world: Point3<f64>,
    /// Up direction of the frame, or the table's normal if that is unknown.
    up_in_world: Unit<Vector3<f64>>,
}

impl TableHeight {
    /// Height of the table of a frame.
    pub(crate) fn of(table: &Table, frame: &FramePose) -> Self {
        let up_in_camera = frame.up_in_camera.unwrap_or(table.plane.normal);
        Self {
            middle_in_world: frame.world_from_camera * table.middle_in_camera(),
            up_in_world: frame.world_from_camera.rotation * up_in_camera,
        }
    }

    /// True if another table is at the same height.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let above_m = self
            .up_in_world
            .dot(&(other.middle_in_world - self.middle_in_world));
        above_m.abs() <= SAME_TABLE_M
    }
}

/// Surface at another height than the tracked table, and the times of its first and last frame.
#[derive(Debug, Clone, Copy)]
struct OtherSurface {
    height: TableHeight,
    first_ns: u64,
    last_ns: u64,
}

/// Watch on surfaces at another height than the tracked table, one of which may become the
/// table.
#[derive(Debug, Clone, Default)]
pub(crate) struct OtherTable(Option<OtherSurface>);

impl OtherTable {
    /// True if a surface has lasted, and is therefore the table.
    pub(crate) fn has_lasted(&self, found: &TableHeight, now_ns: u64) -> bool {
        let watched_ns = self.found_since_ns(found, now_ns);
        watched_ns.is_some_and(|first_ns| now_ns.saturating_sub(first_ns) >= OTHER_TABLE_NS)
    }

    /// Capture stamp since which a surface is found all the time; `None` when it was not.
    fn found_since_ns(&self, found: &TableHeight, now_ns: u64) -> Option<u64> {
        let lasting = self.0.filter(|other| {
            other.height.is_same(found) && now_ns.saturating_sub(other.last_ns) <= GAP_NS
        });
        lasting.map(|other| other.first_ns)
    }

    /// Takes account of a frame with a surface that is not the table of the tracks.
    pub(crate) fn found(&mut self, height: TableHeight, now_ns: u64) {
        self.0 = Some(OtherSurface {
            height,
            first_ns: self.found_since_ns(&height, now_ns).unwrap_or(now_ns),
            last_ns: now_ns,
        });
    }

    /// Forgets the surface: the camera has not moved on from the tracked table.
    pub(crate) fn clear(&mut self) {
        self.0 = None;
    }
}
