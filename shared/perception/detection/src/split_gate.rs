//! Which clusters may be several objects.

use crate::affine_form::AffineForm;
use crate::footprint::Footprint;
use point_cloud::Point;

/// A cluster with a longer side may be several objects, metres,
const LONGEST_SIDE_M: f64 = 0.17;

/// as may one that covers more of the table, square metres.
const FOOTPRINT_M2: f64 = 0.013;

/// A cluster is measured over about this many points.
const N_SAMPLES: usize = 512;

/// Whether a cluster is so large that it is searched for creases. What one hand holds
/// is taken as one object: the inside of a cup and its handle meet the rest of it in
/// creases, too.
pub(crate) fn may_be_several_objects(
    points: &[Point],
    pixels: &[u32],
    table_axes: &[AffineForm; 3],
) -> bool {
    let [u, v, height] = table_axes;
    let step = pixels.len().div_ceil(N_SAMPLES).max(1);
    let (mut footprint, mut highest_m) = (Footprint::new(), 0.0_f32);
    for &pixel in pixels.iter().step_by(step) {
        let p = &points[pixel as usize];
        footprint.add(u.at(p.x, p.y, p.z), v.at(p.x, p.y, p.z));
        highest_m = highest_m.max(height.at(p.x, p.y, p.z));
    }
    footprint.min_area_rectangle().is_some_and(|rectangle| {
        let half_sides_m = rectangle.half_sides_m;
        f64::from(highest_m).max(2.0 * half_sides_m.x) > LONGEST_SIDE_M
            || 4.0 * half_sides_m.product() > FOOTPRINT_M2
    })
}
