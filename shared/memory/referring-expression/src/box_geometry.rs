//! Geometry of an upright or lying box: extents, gaps and overlaps along directions.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::world::WorldObject;

/// Box in the world frame, as a centre and three half edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BoxGeometry {
    pub(crate) centre: Vector3<f64>,
    half_edges: [Vector3<f64>; 3],
    /// Directions of the longest horizontal edge, and across it.
    horizontal_axes: [Vector3<f64>; 2],
    /// Extents along the horizontal axes, shorter first.
    footprint_edges_m: [f64; 2],
}

impl BoxGeometry {
    /// Box of an object. A quaternion without a direction counts as no rotation.
    pub(crate) fn new(object: &WorldObject) -> Self {
        let [x, y, z, w] = object.orientation_xyzw;
        let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
            .filter(|rotation| rotation.coords.iter().all(|part| part.is_finite()))
            .unwrap_or_else(UnitQuaternion::identity);
        let edge = |axis: usize| {
            let half_m = 0.5 * finite(object.size_m[axis]).abs();
            rotation * Vector3::ith(axis, half_m)
        };
        let half_edges = [edge(0), edge(1), edge(2)];
        let horizontal_axes = horizontal_axes(&half_edges);
        let edges = horizontal_axes.map(|axis| 2.0 * half_extent_m(&half_edges, &axis));
        Self {
            centre: Vector3::from(object.centre_in_world_m.map(finite)),
            half_edges,
            horizontal_axes,
            footprint_edges_m: [edges[0].min(edges[1]), edges[0].max(edges[1])],
        }
    }

    /// Half of the extent along a unit vector.
    pub(crate) fn half_extent_m(&self, direction: &Vector3<f64>) -> f64 {
        half_extent_m(&self.half_edges, direction)
    }

    pub(crate) fn height_m(&self) -> f64 {
        2.0 * self.half_extent_m(&Vector3::z())
    }

    pub(crate) fn bottom_m(&self) -> f64 {
        self.centre.z - self.half_extent_m(&Vector3::z())
    }

    pub(crate) fn top_m(&self) -> f64 {
        self.centre.z + self.half_extent_m(&Vector3::z())
    }

    /// Extents of the footprint along its own horizontal axes, shorter first.
    pub(crate) fn footprint_edges_m(&self) -> [f64; 2] {
        self.footprint_edges_m
    }

    /// Mean half edge of the footprint.
    pub(crate) fn radius_m(&self) -> f64 {
        let [shorter, longer] = self.footprint_edges_m();
        0.25 * (shorter + longer)
    }

    /// Horizontal distance between two boxes by their separating axes; 0 if the footprints overlap.
    pub(crate) fn gap_m(&self, other: &Self) -> f64 {
        let [own, others] = [self, other].map(|frame| self.gap_in_frame_m(other, frame));
        own.max(others)
    }

    /// Vertical distance between two boxes; 0 if their heights overlap.
    pub(crate) fn vertical_gap_m(&self, other: &Self) -> f64 {
        let above = self.bottom_m() - other.top_m();
        let below = other.bottom_m() - self.top_m();
        above.max(below).max(0.0)
    }

    /// Share of this footprint that lies over the other's, 0 to 1, along the other's axes.
    pub(crate) fn footprint_overlap(&self, other: &Self) -> f64 {
        let covered = other.horizontal_axes.map(|axis| {
            let half = self.half_extent_m(&axis).max(1e-6);
            let other_half = other.half_extent_m(&axis);
            let offset = (self.centre - other.centre).dot(&axis);
            let from = (offset - half).max(-other_half);
            let to = (offset + half).min(other_half);
            ((to - from) / (2.0 * half)).clamp(0.0, 1.0)
        });
        covered[0] * covered[1]
    }

    fn gap_in_frame_m(&self, other: &Self, frame: &Self) -> f64 {
        let offset = other.centre - self.centre;
        let gaps = frame.horizontal_axes.map(|axis| {
            let extents = self.half_extent_m(&axis) + other.half_extent_m(&axis);
            (offset.dot(&axis).abs() - extents).max(0.0)
        });
        gaps[0].hypot(gaps[1])
    }
}

fn half_extent_m(half_edges: &[Vector3<f64>; 3], direction: &Vector3<f64>) -> f64 {
    half_edges.iter().map(|e| e.dot(direction).abs()).sum()
}

/// Directions of the longest horizontal edge, and across it; x and y if all edges are vertical.
fn horizontal_axes(half_edges: &[Vector3<f64>; 3]) -> [Vector3<f64>; 2] {
    let flat = half_edges.map(|edge| Vector3::new(edge.x, edge.y, 0.0));
    let longest = flat
        .into_iter()
        .max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let along = longest
        .and_then(|edge| edge.try_normalize(1e-9))
        .unwrap_or_else(Vector3::x);
    [along, Vector3::new(-along.y, along.x, 0.0)]
}

fn finite(value: f64) -> f64 {
    if value.is_finite() {
        value.clamp(-1e6, 1e6)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Presence;

    fn cube(x_m: f64, edge_m: f64, yaw_rad: f64) -> BoxGeometry {
        BoxGeometry::new(&WorldObject {
            track_id: 1,
            names: Vec::new(),
            is_labelled: false,
            color_shares: [0.0; 11],
            centre_in_world_m: [x_m, 0.0, 0.0],
            orientation_xyzw: [0.0, 0.0, (0.5 * yaw_rad).sin(), (0.5 * yaw_rad).cos()],
            size_m: [edge_m; 3],
            presence: Presence::InView,
            first_seen_ns: 0,
            last_seen_ns: 0,
        })
    }

    #[test]
    fn box_geometry_measures_gaps_and_overlaps() {
        let (a, b) = (cube(0.0, 0.1, 0.0), cube(0.3, 0.1, 0.0));
        assert!((a.gap_m(&b) - 0.2).abs() < 1e-9);
        assert!((a.footprint_overlap(&cube(0.05, 0.1, 0.0)) - 0.5).abs() < 1e-9);
        assert_eq!(a.footprint_overlap(&b), 0.0);
    }

    #[test]
    fn box_geometry_turns_with_the_quaternion() {
        let turned = cube(0.0, 0.1, std::f64::consts::FRAC_PI_4);
        let half_diagonal_m = 0.05 * 2_f64.sqrt();
        assert!((turned.half_extent_m(&Vector3::x()) - half_diagonal_m).abs() < 1e-9);
        assert!((turned.footprint_edges_m()[1] - 0.1).abs() < 1e-9);
    }

    #[test]
    fn box_geometry_accepts_any_float() {
        let mut object = WorldObject {
            track_id: 1,
            names: Vec::new(),
            is_labelled: false,
            color_shares: [f32::NAN; 11],
            centre_in_world_m: [f64::NAN, f64::INFINITY, 0.0],
            orientation_xyzw: [f64::NAN; 4],
            size_m: [f64::NAN; 3],
            presence: Presence::InView,
            first_seen_ns: 0,
            last_seen_ns: 0,
        };
        assert!(
            BoxGeometry::new(&object)
                .gap_m(&cube(0.0, 0.1, 0.0))
                .is_finite()
        );
        object.orientation_xyzw = [0.0; 4];
        assert!(BoxGeometry::new(&object).height_m().is_finite());
    }
}
