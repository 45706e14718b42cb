//! Support relations: which hypothesis rests on the table or on another one.

use crate::affine_form::AffineForm;
use crate::candidate::Support;
use crate::cluster_hypothesis::ClusterHypothesis;
use crate::clusters::Clusters;
use crate::samples::RayGrid;
use crate::table::Table;
use crate::upright_box::UprightBox;
use nalgebra::{Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};

/// Greatest horizontal gap between boxes in contact, metres; the supporting side of the
/// lower object is often occluded. Chosen.
const TOUCH_M: f64 = 0.03;

/// Greatest vertical gap between boxes in contact, metres: an object that overhangs its
/// support hides the top of it. Chosen.
const HIDDEN_TOP_M: f64 = 0.06;

/// Greatest height over the table at which an object without depth below it stands on the
/// table, metres. Chosen.
const UNSEEN_BASE_MAX_M: f32 = 0.10;

/// Least depth step of an occlusion, metres. Chosen.
const OCCLUSION_STEP_M: f32 = 0.02;

/// Least depth step from the table's rim to an object behind it, metres: more than the table
/// recedes within the first probe. Chosen.
const RIM_STEP_M: f32 = 0.04;

/// Distances of the probes below the lower border of a cluster, pixels. Chosen.
const PROBE_PX: [f64; 3] = [2.0, 4.0, 8.0];

/// Least occluded share of the lower border for an occluded support. Chosen.
const OCCLUDED_SHARE_MIN: f64 = 0.3;

/// Least share of the lower border without depth below for an unknown support. Chosen.
const NO_DEPTH_SHARE_MIN: f64 = 0.5;

/// Heights at which the vertical line below the centre of an object is looked at, as shares of
/// the height of its lowest point.
const BELOW_SHARES: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// Tolerance of depth within which a place is in view, metres. Chosen.
const IN_VIEW_M: f64 = 0.01;

/// Greatest distance from the table's plane of a surface level with it, metres. Chosen.
const LEVEL_M: f32 = 0.01;

/// Greatest distance from the table's plane of a surface level with it, in sigmas of the depth
/// noise, where that exceeds [`LEVEL_M`]. Chosen.
const LEVEL_SIGMAS: f32 = 3.0;

/// Least share of the lower border off the table for furniture beside it.
/// Chosen.
const OFF_TABLE_SHARE_MIN: f64 = 0.3;

/// Distance from the border of the table at which an object stands on the table for certain,
/// metres. Chosen.
const BORDER_MARGIN_M: f64 = 0.05;

/// Find the support of each hypothesis that does not stand on the table: a supported
/// hypothesis in contact, or an unseen one behind an occluded lower border or behind the object
/// itself. Without any it stays `None`, and furniture that begins off the table loses its
/// support. People and the robot neither give nor need support.
pub(crate) fn find_support_relations(
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    table: &Table,
    rays: &RayGrid,
    hypotheses: &mut [ClusterHypothesis],
) {
    let up = &table.plane.normal;
    let camera_from_table = table.table_from_camera.inverse();
    for hypothesis in hypotheses.iter_mut().filter(|one| !one.is_masked) {
        let is_supported = hypothesis.support.is_some();
        if is_supported && is_inside_border(&hypothesis.upright_box, table) {
            continue;
        }
        let step = image_direction_down(&hypothesis.statistics.centroid, up);
        let base = BaseVisibility::of(cloud, clusters, hypothesis.cluster, step, table);
        if base.off_table_share >= OFF_TABLE_SHARE_MIN {
            hypothesis.support = None;
            hypothesis.off_table_share = base.off_table_share as f32;
        } else if !is_supported {
            let is_occluded = base.occluded_share >= OCCLUDED_SHARE_MIN;
            hypothesis.is_base_without_depth =
                !is_occluded && base.no_depth_share >= NO_DEPTH_SHARE_MIN;
            let is_low = hypothesis.statistics.height_m[0] <= UNSEEN_BASE_MAX_M;
            let is_unseen = is_occluded || hypothesis.is_base_without_depth && is_low;
            hypothesis.support = is_unseen.then_some(Support::Occluded);
        }
    }
    // Each pass carries support one object higher; a pass without change ends it.
    while propagate_support(hypotheses) {}
    let pixel_at = |place: &Point3<f64>| {
        let place = camera_from_table * place;
        Some((rays.pixel_at(&place)?, place.z))
    };
    for hypothesis in hypotheses.iter_mut().filter(|one| needs_support(one)) {
        if hides_place_below(hypothesis, cloud, clusters, pixel_at) {
            hypothesis.support = Some(Support::Occluded);
        }
    }
    while propagate_support(hypotheses) {}
}

/// `true` when a box is so far inside the border of the table that nothing of it can begin
/// beside the table.
fn is_inside_border(upright_box: &UprightBox, table: &Table) -> bool {
    let (centre, radius_m) = upright_box.disc();
    table
        .outline
        .contains_disc(&centre, radius_m + BORDER_MARGIN_M)
}

/// `true` for a hypothesis without support that may have one.
fn needs_support(hypothesis: &ClusterHypothesis) -> bool {
    hypothesis.support.is_none() && !hypothesis.is_masked && hypothesis.off_table_share == 0.0
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
                && upright_box.touches(&other.upright_box, TOUCH_M, HIDDEN_TOP_M)
        };
        if needs_support(&hypotheses[i]) && hypotheses.iter().any(carries) {
            hypotheses[i].support = Some(Support::Object);
            news = true;
        }
    }
    news
}

/// `true` when an object hides the vertical line between it and the table below its centre, so
/// that it may stand there unseen, as a ball or anything seen from above does. `pixel_at` gives
/// the column, row and depth of a point in the table's frame.
fn hides_place_below(
    hypothesis: &ClusterHypothesis,
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    pixel_at: impl Fn(&Point3<f64>) -> Option<([usize; 2], f64)>,
) -> bool {
    let (centre, _) = hypothesis.upright_box.disc();
    let lowest_m = f64::from(hypothesis.statistics.height_m[0]);
    let mut is_hidden = false;
    for share in BELOW_SHARES {
        let place = Point3::new(centre.x, centre.y, share * lowest_m);
        let Some(([column, row], depth_m)) = pixel_at(&place) else {
            return false;
        };
        if column >= cloud.width() || row >= cloud.height() {
            return false;
        }
        let pixel = row * cloud.width() + column;
        let seen_m = f64::from(cloud.points()[pixel].z);
        let is_own = clusters.cluster_of[pixel] == hypothesis.cluster;
        if seen_m > depth_m - IN_VIEW_M {
            return false;
        }
        is_hidden |= is_own;
    }
    is_hidden
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
    /// Share of the lower border where the object begins off the table: the same surface goes
    /// on below the table's, or the table itself hides it.
    off_table_share: f64,
}

impl BaseVisibility {
    fn of(
        cloud: &OrganizedCloud<'_>,
        clusters: &Clusters,
        cluster: u32,
        step: [f64; 2],
        table: &Table,
    ) -> Self {
        let height = AffineForm::from(&table.plane);
        let (points, width) = (cloud.points(), cloud.width());
        let steps = PROBE_PX.map(|px| step.map(|part| (part * px).round() as isize));
        let (mut n_border, mut n_occluded, mut n_no_depth, mut n_off_table) =
            (0_u32, 0_u32, 0_u32, 0_u32);
        for &pixel in clusters.pixels(cluster as usize) {
            let pixel = pixel as usize;
            let below = |[columns, rows]: [isize; 2]| {
                let column = (pixel % width).checked_add_signed(columns)?;
                let row = (pixel / width).checked_add_signed(rows)?;
                (column < width && row < cloud.height()).then_some(row * width + column)
            };
            // Most pixels are inside and end here at the first probe.
            let mut probed = steps.iter().filter_map(|&step| below(step));
            if probed.any(|other| clusters.cluster_of[other] == cluster) {
                continue;
            }
            n_border += 1;
            let probes = steps.map(|step| below(step).map(|other| &points[other]));
            let probes = probes.map(|probe| probe.filter(|point| point.is_finite()));
            let Some(nearest) = probes.into_iter().flatten().next() else {
                n_no_depth += 1;
                continue;
            };
            let own = &points[pixel];
            let noise_m = LEVEL_M.max(LEVEL_SIGMAS * table.depth_noise.sigma_m(own.z));
            let height_m = |point: &Point| height.at(point.x, point.y, point.z);
            let is_nearer = nearest.z < own.z - OCCLUSION_STEP_M;
            n_occluded += u32::from(is_nearer && height_m(nearest) > noise_m);
            let is_behind_rim = probes[0].is_some_and(|table| {
                table.z < own.z - RIM_STEP_M && height_m(table).abs() <= noise_m
            });
            let goes_on_below = probes.into_iter().flatten().any(|point| {
                let is_same = (point.z - own.z).abs() <= OCCLUSION_STEP_M * own.z * own.z;
                is_same && height_m(point) < -noise_m
            });
            n_off_table += u32::from(is_behind_rim || goes_on_below);
        }
        let share = |n: u32| f64::from(n) / f64::from(n_border.max(1));
        Self {
            occluded_share: share(n_occluded),
            no_depth_share: share(n_no_depth),
            off_table_share: share(n_off_table),
        }
    }
}
