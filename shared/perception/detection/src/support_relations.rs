//! What carries a cluster.

use crate::candidate::Support;
use crate::cluster_hypothesis::ClusterHypothesis;
use crate::clusters::Clusters;
use nalgebra::{Point3, Vector3};
use point_cloud::OrganizedCloud;

/// Boxes this near touch, metres: the side of the lower object that the upper
/// one rests on is often hidden.
const TOUCH_M: f64 = 0.03;

/// What is nearer by more hides what is behind it, metres.
const OCCLUSION_STEP_M: f32 = 0.02;

/// How far below its lower border a cluster's neighbour is looked for, pixels.
const PROBE_PX: [f64; 3] = [2.0, 4.0, 8.0];

/// Share of the lower border that must be hidden by something.
const OCCLUDED_SHARE_MIN: f64 = 0.3;

/// With this share of the lower border without any depth below, nobody knows
/// what carries a cluster.
const NO_DEPTH_SHARE_MIN: f64 = 0.5;

/// Least cosine between the line of sight and straight down at which an object
/// hides its own foot: about 25 degrees.
const STEEP_VIEW_COS_MIN: f64 = 0.905;

/// Finds what carries each cluster that does not stand on the table itself: a
/// carried cluster that its box touches, or, unseen, whatever hides its lower
/// border. Without either it hangs in the air and keeps `None`. People and the
/// robot carry nothing that stands, and are not asked what carries them.
pub(crate) fn find_support_relations(
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    up_in_camera: &Vector3<f64>,
    hypotheses: &mut [ClusterHypothesis],
) {
    let unsupported =
        |hypothesis: &&mut ClusterHypothesis| hypothesis.support.is_none() && !hypothesis.is_masked;
    for hypothesis in hypotheses.iter_mut().filter(unsupported) {
        if is_seen_from_above(&hypothesis.statistics.centroid, up_in_camera) {
            hypothesis.support = Some(Support::Occluded);
            continue;
        }
        let step = image_direction_down(&hypothesis.statistics.centroid, up_in_camera);
        let base = BaseVisibility::of(cloud, clusters, hypothesis.cluster, step);
        if base.occluded_share >= OCCLUDED_SHARE_MIN {
            hypothesis.support = Some(Support::Occluded);
        }
        hypothesis.is_base_without_depth = base.no_depth_share >= NO_DEPTH_SHARE_MIN;
    }
    // Each pass carries support one object higher; a pass without news ends it.
    while propagate_support(hypotheses) {}
}

/// Whether another cluster was found to rest on a carried one.
pub(crate) fn propagate_support(hypotheses: &mut [ClusterHypothesis]) -> bool {
    let mut news = false;
    for i in 0..hypotheses.len() {
        let upright_box = hypotheses[i].upright_box;
        let carries = |other: &ClusterHypothesis| {
            other.support.is_some()
                && other.is_object_sized
                && !other.is_masked
                && upright_box.touches(&other.upright_box, TOUCH_M)
        };
        let is_asked = hypotheses[i].support.is_none() && !hypotheses[i].is_masked;
        if is_asked && hypotheses.iter().any(carries) {
            hypotheses[i].support = Some(Support::Object);
            news = true;
        }
    }
    news
}

/// Whether a place is seen so steeply from above that an object there shows
/// nothing but its top.
fn is_seen_from_above(at: &Point3<f64>, up: &Vector3<f64>) -> bool {
    -at.coords.dot(up) >= STEEP_VIEW_COS_MIN * at.coords.norm()
}

/// The image direction towards the table at a point, columns and rows, length 1.
fn image_direction_down(at: &Point3<f64>, up: &Vector3<f64>) -> [f64; 2] {
    let (columns, rows) = (at.x * up.z - up.x * at.z, at.y * up.z - up.y * at.z);
    let length = columns.hypot(rows);
    if length > 1e-9 {
        [columns / length, rows / length]
    } else {
        [0.0, 1.0]
    }
}

/// What is seen at a cluster's lower border.
#[derive(Debug, Clone, Copy)]
struct BaseVisibility {
    /// Share of it before which something nearer is seen.
    occluded_share: f64,
    /// Share of it below which there is no depth.
    no_depth_share: f64,
}

impl BaseVisibility {
    fn of(cloud: &OrganizedCloud<'_>, clusters: &Clusters, cluster: u32, step: [f64; 2]) -> Self {
        let (points, width) = (cloud.points(), cloud.width());
        let steps = PROBE_PX.map(|px| step.map(|part| (part * px).round() as isize));
        let (mut n_border, mut n_occluded, mut n_no_depth) = (0_u32, 0_u32, 0_u32);
        for &pixel in clusters.pixels(cluster as usize) {
            let pixel = pixel as usize;
            let below = steps.map(|[columns, rows]| {
                let column = (pixel % width).checked_add_signed(columns)?;
                let row = (pixel / width).checked_add_signed(rows)?;
                (column < width && row < cloud.height()).then_some(row * width + column)
            });
            let mut seen = below.iter().flatten();
            if seen.any(|&other| clusters.cluster_of[other] == cluster) {
                continue;
            }
            n_border += 1;
            let nearest = below
                .iter()
                .flatten()
                .find(|&&other| points[other].is_finite());
            n_occluded += u32::from(
                nearest.is_some_and(|&i| points[i].z < points[pixel].z - OCCLUSION_STEP_M),
            );
            n_no_depth += u32::from(nearest.is_none());
        }
        let share = |n: u32| f64::from(n) / f64::from(n_border.max(1));
        Self {
            occluded_share: share(n_occluded),
            no_depth_share: share(n_no_depth),
        }
    }
}
