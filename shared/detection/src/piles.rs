//! Which clusters may be several objects.

use crate::RawConfig;
use crate::axis::Axis;
use crate::candidate::{Summary, UprightBox};
use crate::clusters::Clusters;
use point_cloud::OrganizedCloud;

/// A cluster with a longer side may be several objects, metres.
const LONGEST_SIDE_M: f64 = 0.30;

/// A cluster that covers more of the table may be several objects, square metres.
const FOOTPRINT_M2: f64 = 0.03;

/// Tells, cluster by cluster, which are so large that they are searched for
/// creases. What one hand holds is taken as one object: the inside of a bowl and
/// the handle of a mug meet the rest of it in creases, too.
pub(crate) fn find_piles(
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    table_axes: &[Axis; 3],
    config: &RawConfig,
    may_be_pile: &mut Vec<bool>,
) {
    may_be_pile.clear();
    may_be_pile.extend((0..clusters.len()).map(|cluster| {
        let pixels = clusters.pixels(cluster);
        let summary = Summary::of(pixels, cloud, &table_axes[2], config);
        let heights_m = [0.0, f64::from(summary.height_m[1])];
        let upright_box = UprightBox::around(pixels, cloud.points(), table_axes, heights_m);
        upright_box.is_some_and(|upright_box| {
            upright_box.longest_side_m() > LONGEST_SIDE_M
                || upright_box.footprint_m2() > FOOTPRINT_M2
        })
    }));
}
