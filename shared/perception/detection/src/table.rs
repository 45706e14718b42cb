//! Table: plane, frame, polygon and outline of the support surface.

use crate::outline::Outline;
use geometry::{ConvexPolygon, Plane, RigidTransform};
use nalgebra::{Point2, Point3, Vector2};
use sensor_noise::DepthNoise;
use std::fmt;

/// Least gap between a table and the floor under it, metres; tops of objects are nearer to
/// their table. Chosen.
pub(crate) const FLOOR_GAP_M: f64 = 0.35;

/// Greatest thickness of a board, metres: the face at its rim belongs to it. Chosen.
pub(crate) const BOARD_THICKNESS_MAX_M: f32 = 0.05;

/// Role of a surface among those of a frame, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SurfaceRole {
    /// Table: the surface on which objects are looked for first.
    Table,
    /// Level of furniture over or under the table that carries objects, too, such as the board of
    /// a shelf.
    Level,
    /// Level that only the present frame shows, and on which no object is looked for yet.
    NewLevel,
    /// Floor, or another surface so far under the table that no object is looked for there.
    Floor,
}

impl SurfaceRole {
    /// `true` when objects are looked for on the surface.
    pub fn carries_objects(self) -> bool {
        self <= Self::Level
    }
}

/// Table: a support surface found in a cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Plane, camera frame; its positive side holds the camera, or is up in a cloud that no
    /// single camera has seen.
    pub plane: Plane,
    /// Plane that the image alone would make the table; another one than `plane` where the table of
    /// earlier frames is kept.
    pub plane_by_image: Plane,
    /// Transform into the table's frame: z along the normal, heights over the table.
    pub table_from_camera: RigidTransform,
    /// Convex hull of the visible part of the table, in the table's frame.
    pub polygon: ConvexPolygon,
    /// Outline polygon without the gaps of the table, for example the missing corner of an
    /// L shape.
    pub outline: Outline,
    /// Reason for the selection among the planes of the image.
    pub choice: TableChoice,
    /// Role among the surfaces of the frame.
    pub role: SurfaceRole,
    /// Number of samples of the subsampled image on the table.
    pub n_samples: usize,
    /// Depth noise measured on the table: the configured law, scaled by `noise_ratio`.
    pub depth_noise: DepthNoise,
    /// Ratio of the noise and warp measured on the table to the configured law, at least 1;
    /// 1 where it cannot be measured.
    pub noise_ratio: f32,
}

impl Table {
    /// Signed distance of a point in the table's frame from the rim, metres; see
    /// [`Outline::rim_distance_m`].
    pub fn rim_distance_m(&self, place: &Point2<f64>) -> f64 {
        self.outline.rim_distance_m(place)
    }

    /// Corners of the convex hull of the visible part, in another frame.
    pub fn corners(&self, frame_from_camera: &RigidTransform) -> impl Iterator<Item = Point3<f64>> {
        let frame_from_table = frame_from_camera * self.table_from_camera.inverse();
        let corners = self.polygon.corners().iter();
        corners.map(move |corner| frame_from_table * Point3::new(corner.x, corner.y, 0.0))
    }

    /// Depth of the middle of the visible part of the table along the optical axis, metres.
    pub fn middle_depth_m(&self) -> f64 {
        self.middle_in_camera().z
    }

    /// Middle of the visible part of the table, camera frame.
    pub fn middle_in_camera(&self) -> Point3<f64> {
        let corners = self.polygon.corners();
        let sum: Vector2<f64> = corners.iter().map(|corner| corner.coords).sum();
        let middle = (sum / corners.len().max(1) as f64).push(0.0);
        self.table_from_camera.inverse() * Point3::from(middle)
    }
}

/// Greatest angle between two views of one surface, radians. Chosen.
const SAME_SURFACE_RAD: f64 = 0.035;

/// Greatest distance between two views of one surface in the middle of its visible part, metres.
/// Chosen.
const SAME_SURFACE_M: f64 = 0.015;

/// True if two planes, of which `middle` is on one, are views of one surface.
pub fn is_same_surface(one: &Plane, other: &Plane, middle: &Point3<f64>) -> bool {
    one.normal.dot(&other.normal) >= SAME_SURFACE_RAD.cos()
        && (one.height_m(middle) - other.height_m(middle)).abs() <= SAME_SURFACE_M
}

/// Reason for the selection of a table. Two tables of one height count as two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableChoice {
    /// Table choice: the only surface that can be a table.
    Only,
    /// Dominant surface: it covers so much of the view that no other was searched.
    Most,
    /// Largest of several surfaces that can be a table.
    Largest {
        /// Number of other surfaces that can be a table.
        n_others: usize,
    },
    /// Surface over a larger one, which is the floor or a lower table.
    OverLarger {
        /// Number of other surfaces that can be a table.
        n_others: usize,
    },
    /// Surface around a larger one above it, the top of an object, level or leaning.
    Around,
    /// Table of the frames before, although this image alone would give another one.
    Kept,
    /// Surface beside the table with free space beneath one of the two.
    Level,
}

impl fmt::Display for TableChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let others = |n: usize| if n == 1 { "surface" } else { "surfaces" };
        match *self {
            Self::Only => write!(f, "the only surface that can be a table"),
            Self::Around => write!(f, "around the top of an object that covers much of it"),
            Self::Kept => write!(f, "the table of the frames before"),
            Self::Level => write!(f, "another level, with free space between it and the table"),
            Self::Most => write!(f, "most of the points in range"),
            Self::Largest { n_others: n } => {
                write!(f, "larger than {n} other {} that can be a table", others(n))
            }
            Self::OverLarger { n_others: n } => write!(
                f,
                "over a larger one, of {n} other {} that can be a table",
                others(n)
            ),
        }
    }
}
