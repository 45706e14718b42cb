//! Support relations: which hypothesis rests on the table or on another one.

use crate::candidate::Support;
use crate::cluster_hypothesis::ClusterHypothesis;
use crate::clusters::Clusters;
use nalgebra::{Point3, Vector3};
use point_cloud::OrganizedCloud;

/// Greatest gap between boxes in contact, metres; the supporting side of the lower object
/// is often occluded. Chosen; sensitivity: see `tabula-lab sweep`.
const TOUCH_M: f64 = 0.03;

/// Least depth step of an occlusion, metres. Chosen; sensitivity: see `tabula-lab sweep`.
const OCCLUSION_STEP_M: f32 = 0.02;

/// Distances of the probes below the lower border of a cluster, pixels. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const PROBE_PX: [f64; 3] = [2.0, 4.0, 8.0];

/// Least occluded share of the lower border for an occluded support. Chosen; sensitivity:
/// see `tabula-lab sweep`.
const OCCLUDED_SHARE_MIN: f64 = 0.3;

/// Least share of the lower border without depth below for an unknown support. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const NO_DEPTH_SHARE_MIN: f64 = 0.5;

/// Least cosine between the line of sight and straight down at which an object occludes its
/// own base: about 25 degrees. Chosen; sensitivity: see `tabula-lab sweep`.
const STEEP_VIEW_COS_MIN: f64 = 0.905;

/// Find the support of each hypothesis that does not stand on the table: a supported
/// hypothesis in contact, or an unseen one behind an occluded lower border. Without either
/// it stays `None`. People and the robot neither give nor need support.
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
    // Each pass carries support one object higher; a pass without change ends it.
    while propagate_support(hypotheses) {}
}

/// Propagate support by contact to hypotheses without one; returns `true` on a change.
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

/// `true` when a point is seen so steeply from above that an object there shows only its
/// top.
fn is_seen_from_above(at: &Point3<f64>, up: &Vector3<f64>) -> bool {
    -at.coords.dot(up) >= STEEP_VIEW_COS_MIN * at.coords.norm()
}

/// Unit direction in the image towards the table at a point: columns and rows.
fn image_direction_down(at: &Point3<f64>, up: &Vector3<f64>) -> [f64; 2] {
    let (columns, rows) = (at.x * up.z - up.x * at.z, at.y * up.z - up.y * at.z);
    let length = columns.hypot(rows);
    if length > 1e-9 {
        [columns / length, rows / length]
    } else {
        [0.0, 1.0]
    }
}

/// Visibility of the base: the surroundings of a cluster's lower border.
#[derive(Debug, Clone, Copy)]
struct BaseVisibility {
    /// Share of the lower border with a nearer surface below it.
    occluded_share: f64,
    /// Share of the lower border without depth below it.
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
