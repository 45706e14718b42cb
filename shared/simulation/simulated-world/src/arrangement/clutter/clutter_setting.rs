//! Setting of a crowded table: size and finish of the table, and pose of the camera.

use super::{AREA_PER_OBJECT_M2, crowd_centre};
use crate::camera_mount::CameraMount;
use crate::furniture::{TableDimensions, TableFinish, TablePattern};
use crate::random_stream::random_stream;
use std::f64::consts::PI;

/// Random stream of the table.
const STREAM_TABLE: u64 = 13;
/// Random stream of the finish of the table.
const STREAM_FINISH: u64 = 15;
/// Random stream of the camera.
const STREAM_CAMERA: u64 = 14;
/// Sides of the table along x and y, metres: least and greatest. Chosen.
const TABLE_M: [[f64; 2]; 2] = [[1.2, 2.4], [0.9, 1.7]];
/// Distance of the camera from the point it looks at, metres. Chosen.
const DISTANCE_M: [f64; 2] = [0.8, 2.0];
/// Elevation of the camera, degrees. Chosen.
const ELEVATION_DEG: [f64; 2] = [25.0, 60.0];
/// Greatest azimuth of the camera, degrees; the wall is behind the table. Chosen.
const AZIMUTH_DEG: f64 = 65.0;
/// Colours of table tops: beech, oak, walnut, white, grey, black-brown, green, blue. Estimated
/// from pictures.
const TABLE_COLORS: [[u8; 3]; 8] = [
    [222, 192, 166],
    [178, 136, 92],
    [122, 84, 58],
    [226, 224, 218],
    [150, 150, 152],
    [74, 62, 56],
    [120, 138, 112],
    [108, 126, 152],
];

/// Table dimensions drawn from the seed.
pub(crate) fn clutter_table(seed: u64) -> TableDimensions {
    let mut random = random_stream(seed, STREAM_TABLE);
    TableDimensions {
        size_m: TABLE_M.map(|[low, high]| random.between(low, high)),
        ..TableDimensions::default()
    }
}

/// Finish of the table drawn from the seed.
pub(crate) fn clutter_table_finish(seed: u64) -> TableFinish {
    let mut random = random_stream(seed, STREAM_FINISH);
    let at = random.below(TABLE_COLORS.len());
    let pattern = match at {
        0..3 | 5 => TablePattern::WoodGrain,
        _ if random.unit() < 0.5 => TablePattern::Mottle,
        _ => TablePattern::Plain,
    };
    let factor = random.between(0.85, 1.1);
    TableFinish {
        color: TABLE_COLORS[at].map(|c| (f64::from(c) * factor).round() as u8),
        pattern,
        contrast_percent: 8 + random.below(22) as u8,
    }
}

/// Camera mount drawn from the seed: it looks at a point in the crowd, more often from near than
/// from far.
pub(crate) fn clutter_camera(seed: u64, table: &TableDimensions, n_objects: usize) -> CameraMount {
    let mut random = random_stream(seed, STREAM_CAMERA);
    let centre_m = crowd_centre(seed, table);
    let [dense, loose] = AREA_PER_OBJECT_M2;
    let reach_m = (n_objects as f64 * dense.midpoint(loose) / PI).sqrt();
    let mut near_centre = |centre_m: f64| centre_m + random.between(-0.6, 0.6) * reach_m;
    let (x, y) = (near_centre(centre_m.x), near_centre(centre_m.y));
    let [nearest_m, farthest_m] = DISTANCE_M;
    let share = random.unit().powi(2);
    CameraMount {
        look_at_m: [x, y, table.height_m + random.between(0.0, 0.1)],
        distance_m: nearest_m + (farthest_m - nearest_m) * share,
        elevation_deg: random.between(ELEVATION_DEG[0], ELEVATION_DEG[1]),
        azimuth_deg: random.between(-AZIMUTH_DEG, AZIMUTH_DEG),
        orbit_deg_s: 0.0,
    }
}
