//! Table: plane, frame, polygon and outline of the support surface.

use crate::outline::Outline;
use geometry::{ConvexPolygon, Plane, RigidTransform};
use nalgebra::Point2;
use std::fmt;

/// A plane this far under another one, seen by the same camera, is the floor
/// occluded the table, metres; the tops of objects are nearer to their table.
pub(crate) const FLOOR_GAP_M: f64 = 0.35;

/// A table found in an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The plane, camera frame; its positive side holds the camera, or is up in a
    /// cloud that no single camera has seen.
    pub plane: Plane,
    /// The frame of the table: z along the normal, heights over the table.
    pub table_from_camera: RigidTransform,
    /// Convex hull of the part of the table that is seen, in the table's frame.
    pub polygon: ConvexPolygon,
    /// The same without what is seen to be no table, as in the corner of an L.
    pub outline: Outline,
    /// Why this and no other plane of the image is the table.
    pub choice: TableChoice,
    /// Number of samples of the thinned image on the table.
    pub n_samples: usize,
}

impl Table {
    /// Distance of a place on the table, in the table's frame, from the rim,
    /// metres; see [`Outline::rim_distance_m`].
    pub fn rim_distance_m(&self, place: &Point2<f64>) -> f64 {
        self.outline.rim_distance_m(place)
    }
}

/// Why a surface is the table. Two tables of one height are two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableChoice {
    /// No other surface could be a table.
    Only,
    /// It shows so much of itself that no other was looked for.
    Most,
    /// It shows more of itself than the others.
    Largest {
        /// How many others there are.
        n_others: usize,
    },
    /// It lies over a larger one, which is the floor or a lower table.
    OverLarger {
        /// How many others there are.
        n_others: usize,
    },
    /// It is seen around a larger surface a little over it, the top of an object.
    Around,
}

impl fmt::Display for TableChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let others = |n: usize| if n == 1 { "surface" } else { "surfaces" };
        match *self {
            Self::Only => write!(f, "the only surface that can be a table"),
            Self::Around => write!(f, "around the top of an object that covers most of it"),
            Self::Most => write!(f, "most of what is in range"),
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
