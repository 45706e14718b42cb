//! Which clusters may be several objects.

use crate::axis::Axis;
use crate::clusters::Clusters;
use crate::footprint::Footprint;
use point_cloud::OrganizedCloud;

/// A cluster with a longer side may be several objects, metres,
const LONGEST_SIDE_M: f64 = 0.17;

/// as may one that covers more of the table, square metres.
const FOOTPRINT_M2: f64 = 0.013;

/// A cluster is measured over about this many points.
const N_SAMPLES: usize = 512;

/// Tells, cluster by cluster, which are so large that they are searched for
/// creases. What one hand holds is taken as one object: the inside of a cup and
/// its handle meet the rest of it in creases, too.
pub(crate) fn find_piles(
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    table_axes: &[Axis; 3],
    may_be_pile: &mut Vec<bool>,
) {
    let [u, v, height] = table_axes;
    may_be_pile.clear();
    may_be_pile.extend((0..clusters.len()).map(|cluster| {
        let pixels = clusters.pixels(cluster);
        let step = pixels.len().div_ceil(N_SAMPLES).max(1);
        let (mut footprint, mut highest_m) = (Footprint::new(), 0.0_f32);
        for &pixel in pixels.iter().step_by(step) {
            let p = &cloud.points()[pixel as usize];
            footprint.add(u.at(p.x, p.y, p.z), v.at(p.x, p.y, p.z));
            highest_m = highest_m.max(height.at(p.x, p.y, p.z));
        }
        footprint.smallest_rectangle().is_some_and(|rectangle| {
            let half_sides_m = rectangle.half_sides_m;
            f64::from(highest_m).max(2.0 * half_sides_m.x) > LONGEST_SIDE_M
                || 4.0 * half_sides_m.product() > FOOTPRINT_M2
        })
    }));
}
