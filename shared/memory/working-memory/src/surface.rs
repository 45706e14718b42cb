//! Support surfaces of the world model: planes that carry objects, matched from scene to scene.

use nalgebra::{Point3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::fact::BoxPose;

/// Greatest angle between two views of one surface, radians (5 degrees). Chosen.
const SAME_SURFACE_RAD: f64 = 0.087;
/// Greatest distance between two views of one surface at the middle of its outline, metres.
/// Chosen.
const SAME_SURFACE_M: f64 = 0.03;

/// Observation of a support surface in one scene, world frame.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceSighting<'a> {
    /// Kind of the surface, as a word.
    pub kind: &'a str,
    /// Plane: upward unit normal and offset, metres.
    pub plane: [f64; 4],
    /// Corners of the convex hull of what is seen of it, metres, in order around it.
    pub corners_m: &'a [[f32; 3]],
}

/// Support surface of the world model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceRecord {
    /// Number of the surface, never used again; 0 before it is kept.
    pub number: u64,
    /// Kind of the surface, as a word.
    pub kind: String,
    /// Plane of the last observation: upward unit normal and offset, world frame, metres.
    pub plane: [f64; 4],
    /// Corners of the convex hull of what was seen of it last, world frame, metres.
    pub corners_m: Vec<[f32; 3]>,
    /// Time of the first observation, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// Time of the last observation, nanoseconds since 1970.
    pub last_seen_ns: u64,
    /// True if the newest scene showed it.
    #[serde(skip)]
    pub is_seen: bool,
    /// Value of `last_seen_ns` on disk, or about to be written.
    #[serde(skip)]
    pub(crate) noted_seen_ns: u64,
}

impl SurfaceSighting<'_> {
    fn normal(&self) -> Vector3<f64> {
        let [x, y, z, _] = self.plane;
        Vector3::new(x, y, z)
    }

    /// Mean of the corners; the point of the plane nearest to the origin without any.
    fn middle(&self) -> Point3<f64> {
        if self.corners_m.is_empty() {
            return Point3::from(-self.plane[3] * self.normal());
        }
        let corners = self.corners_m.iter();
        let sum: Vector3<f64> = corners
            .map(|corner| Vector3::from(corner.map(f64::from)))
            .sum();
        Point3::from(sum / self.corners_m.len() as f64)
    }

    /// Box of what is seen of the surface: no height, the third axis along the normal.
    pub(crate) fn place(&self) -> BoxPose {
        let normal = self.normal();
        let across = if normal.x.abs() < 0.5 {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let world_from_surface =
            UnitQuaternion::from_rotation_matrix(&Rotation3::face_towards(&normal, &across));
        let (mut low, mut high) = (Vector3::zeros(), Vector3::zeros());
        let middle = self.middle();
        for corner in self.corners_m {
            let from_middle = Point3::from(corner.map(f64::from)) - middle;
            let in_surface = world_from_surface.inverse() * from_middle;
            low = low.inf(&in_surface);
            high = high.sup(&in_surface);
        }
        let centre = middle + world_from_surface * (0.5 * (low + high));
        BoxPose {
            position_m: centre.coords.into(),
            orientation_xyzw: world_from_surface.coords.into(),
            size_m: [high.x - low.x, high.y - low.y, 0.0],
        }
    }
}

impl SurfaceRecord {
    pub(crate) fn new(sighting: &SurfaceSighting<'_>, now_ns: u64) -> Self {
        Self {
            number: 0,
            kind: sighting.kind.to_owned(),
            plane: sighting.plane,
            corners_m: sighting.corners_m.to_vec(),
            first_seen_ns: now_ns,
            last_seen_ns: now_ns,
            is_seen: true,
            noted_seen_ns: 0,
        }
    }

    /// Distance between the record and an observation at its middle, metres; `None` for another
    /// surface.
    pub(crate) fn distance_m(&self, sighting: &SurfaceSighting<'_>) -> Option<f64> {
        let [x, y, z, offset_m] = self.plane;
        let normal = Vector3::new(x, y, z);
        let distance_m = (normal.dot(&sighting.middle().coords) + offset_m).abs();
        let is_parallel = normal.dot(&sighting.normal()) >= SAME_SURFACE_RAD.cos();
        (is_parallel && distance_m <= SAME_SURFACE_M).then_some(distance_m)
    }

    /// Copies an observation; allocates only for a changed kind or more corners.
    pub(crate) fn update(&mut self, sighting: &SurfaceSighting<'_>, now_ns: u64) {
        if self.kind != sighting.kind {
            sighting.kind.clone_into(&mut self.kind);
        }
        self.plane = sighting.plane;
        self.corners_m.clear();
        self.corners_m.extend_from_slice(sighting.corners_m);
        self.last_seen_ns = now_ns;
        self.is_seen = true;
    }
}
