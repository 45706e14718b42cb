//! Scene priors for the rendered boxes: tracks and a robot link.

use crate::synthetic::camera_from_table;
use detection::ExpectedTrack;
use geometry::{Capsule, OrientedBox};
use nalgebra::{Isometry3, Point3, Vector3};

/// Tracks of a box in the middle of the table and of one on the right.
pub(crate) fn tracks() -> [ExpectedTrack; 2] {
    [0.0, 0.25].map(|x| ExpectedTrack {
        oriented_box: OrientedBox {
            frame_from_box: camera_from_table() * Isometry3::translation(x, 0.0, 0.06),
            half_sides_m: Vector3::new(0.05, 0.035, 0.06),
        },
        n_points: 3000,
        is_handled: false,
        colors: None,
    })
}

/// Robot link over a box on the left.
pub(crate) fn link() -> Capsule {
    let link = Capsule {
        from: Point3::new(-0.5, 0.0, 0.06),
        to: Point3::new(-0.3, 0.0, 0.06),
        radius_m: 0.05,
    };
    link.transformed(&camera_from_table())
}
