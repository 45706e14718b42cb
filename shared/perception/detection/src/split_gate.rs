//! Split gate: size test for clusters that may be several objects.

use crate::affine_form::AffineForm;
use crate::footprint::Footprint;
use point_cloud::Point;

/// Longest side above which a cluster may be several objects, metres. Chosen.
const LONGEST_SIDE_M: f64 = 0.17;

/// Footprint area above which a cluster may be several objects, square metres. Chosen.
const FOOTPRINT_M2: f64 = 0.013;

/// Target number of points on which a cluster is measured.
const N_SAMPLES: usize = 512;

/// Size test of a cluster before its segmentation. A hand-sized cluster counts as one
/// object: the inside of a cup and its handle have edges too.
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
    footprint.bounding_rectangle().is_some_and(|rectangle| {
        f64::from(highest_m).max(2.0 * rectangle.half_sides_m.x) > LONGEST_SIDE_M
            || rectangle.area_m2() > FOOTPRINT_M2
    })
}
