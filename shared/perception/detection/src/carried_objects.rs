//! Objects over one support surface: the stages from pixels to hypotheses, and their buffers.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::cluster_hypothesis::{ClusterHypothesis, ClusterStatistics};
use crate::clusters::{BODY_REACH_M, Clusters, OBJECT_REACH_M, TrackClaims};
use crate::constraint_evaluation::BodyMask;
use crate::input::DetectionInput;
use crate::parallelism::{Parallelism, ScratchPool};
use crate::prism::{Prism, TableOverlap, lowest_m};
use crate::reaching_bodies::ReachingBodies;
use crate::samples::Samples;
use crate::segmentation::{Segmentation, SegmentationExamples, SegmentationInput};
use crate::support_plane_holes::SupportPlaneHoles;
use crate::support_relations::find_support_relations;
use crate::table::{BOARD_THICKNESS_MAX_M, SurfaceRole, Table};
use crate::table_reference::TableReference;
use crate::table_surface::TableSurface;
use crate::walls::Walls;
use geometry::Plane;
use point_cloud::OrganizedCloud;
use random::Random;

/// Least height of the base pixels of an object over the table, metres. Chosen.
const BASE_HEIGHT_MIN_M: f32 = 0.0035;

/// Least height of base pixels over the table, in sigmas of the depth noise, where
/// that exceeds [`BASE_HEIGHT_MIN_M`]. Chosen.
const BASE_SIGMAS: f32 = 1.3;

/// Greatest height of the base pixels of an object over the table, metres. Chosen.
const BASE_HEIGHT_MAX_M: f32 = 0.02;

/// Greatest depth step within the base of one object, metres at 1 m, growing with
/// squared depth. A larger step is the base of an object behind. Chosen.
const BASE_STEP_M: f32 = 0.02;

/// Least share of an object's points above the table's cells. Chosen.
const OVER_TABLE_SHARE_MIN: f64 = 0.25;

/// Height of the highest point in sigmas of the depth noise up to which a cluster may be noise
/// of the table. Chosen.
const NOISE_HEIGHT_SIGMAS: f32 = 6.0;

/// Ratio of the least number of points of such a cluster to that of any other. Chosen.
const LOW_POINTS_FACTOR: f64 = 8.0;

/// Frame of a detection, with one of its surfaces.
#[derive(Clone, Copy)]
pub(crate) struct SurfaceFrame<'a> {
    pub(crate) frame: &'a DetectionInput<'a>,
    pub(crate) surface: &'a Table,
    pub(crate) config: &'a RawConfig,
    pub(crate) parallelism: &'a dyn Parallelism,
}

/// Buffers that all surfaces use in turn, and what is known of the whole frame.
#[derive(Debug, Default)]
pub(crate) struct SharedBuffers {
    pub(crate) samples: Samples,
    pub(crate) reaching_bodies: ReachingBodies,
    segmentation: Segmentation,
    /// Pixels in the prism, per band of image rows.
    bands: Vec<Vec<u32>>,
    track_claims: TrackClaims,
    /// Walls of the surfaces of the frame so far.
    pub(crate) walls: Vec<Plane>,
    found_hypotheses: ScratchPool<Vec<ClusterHypothesis>>,
}

/// Objects over one surface. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct CarriedObjects {
    /// Cells of the surface.
    pub(crate) cells: TableSurface,
    /// People and the robot over the surface.
    pub(crate) body_mask: BodyMask,
    /// Pixels in the prism above the surface.
    over_surface: Vec<u32>,
    /// Pixels that show people or the robot.
    masked: Vec<u32>,
    /// Clusters of people and the robot; stale when `masked` is empty.
    masked_clusters: Clusters,
    clusters: Clusters,
    holes: SupportPlaneHoles,
    walls: Walls,
    hypotheses: Vec<ClusterHypothesis>,
}

impl CarriedObjects {
    /// Hypotheses found last, nearest first.
    pub(crate) fn hypotheses(&self) -> &[ClusterHypothesis] {
        &self.hypotheses
    }

    /// Pixels covered by a hypothesis.
    pub(crate) fn pixels(&self, hypothesis: &ClusterHypothesis) -> &[u32] {
        let clusters = if hypothesis.is_masked {
            &self.masked_clusters
        } else {
            &self.clusters
        };
        clusters.pixels(hypothesis.cluster as usize)
    }

    /// List the pixels in the prism above the surface and in holes of the support plane, but
    /// for those of walls.
    pub(crate) fn list_pixels(&mut self, on: &SurfaceFrame<'_>, shared: &mut SharedBuffers) {
        let (table, config) = (on.surface, on.config);
        let height = AffineForm::coordinates_of(&table.table_from_camera)[2];
        self.holes.find(&shared.samples, &height, |z| {
            lowest_m(z, config.height_min_m as f32, &table.depth_noise)
        });
        let prism = Prism::over(table, config, &self.holes, &self.cells);
        let (bands, pixels) = (&mut shared.bands, &mut self.over_surface);
        prism.list_pixels(&on.frame.cloud, on.parallelism, bands, pixels);
        let (samples, around) = (&shared.samples, (table, &self.cells));
        self.walls.find(samples, around, config, &mut shared.walls);
        self.walls
            .remove_from(pixels, &on.frame.cloud, &table.depth_noise);
    }

    /// Leave the pixels on and over a higher surface to it, with those of the face at its rim.
    pub(crate) fn leave_to(&mut self, upper: &Table, over: &Self, cloud: &OrganizedCloud<'_>) {
        let [u, v, height] = AffineForm::coordinates_of(&upper.table_from_camera);
        self.over_surface.retain(|&pixel| {
            let point = &cloud.points()[pixel as usize];
            let [u, v, height_m] = [&u, &v, &height].map(|axis| axis.at(point.x, point.y, point.z));
            height_m < -BOARD_THICKNESS_MAX_M || !over.cells.is_near(u, v)
        });
    }

    /// Cluster the pixels above the surface. Pixels of people and the robot are clustered
    /// separately, so that no object merges with a body that touches it. Bodies are found in depth
    /// by the way in which they reach over the table.
    pub(crate) fn cluster(&mut self, on: &SurfaceFrame<'_>, shared: &mut SharedBuffers) {
        let SurfaceFrame {
            frame,
            surface,
            config,
            parallelism,
        } = *on;
        let (over_surface, masked) = (&mut self.over_surface, &mut self.masked);
        let (samples, bodies) = (&shared.samples, &mut shared.reaching_bodies);
        let body_mask = &mut self.body_mask;
        body_mask.refill(&frame.priors, surface, config);
        body_mask.extract(&frame.cloud, frame.priors.tracks, over_surface, masked);
        if frame.priors.instructor.is_some() {
            bodies.clear();
        } else {
            if surface.role == SurfaceRole::Table {
                bodies.find(frame, samples, surface, &self.cells, config);
            }
            bodies.extract(&frame.cloud, samples, over_surface, masked);
        }
        let n_min = (config.points_min_at_1m / (config.range_max_m * config.range_max_m)) as u32;
        let clusters = &mut self.clusters;
        clusters.label_components(&frame.cloud, parallelism, over_surface, n_min);
        if !masked.is_empty() {
            let clusters = &mut self.masked_clusters;
            clusters.label_components(&frame.cloud, parallelism, masked, n_min);
        }
    }

    /// Segmentation: split and join the clusters, so that each is one object.
    pub(crate) fn segment(&mut self, on: &SurfaceFrame<'_>, shared: &mut SharedBuffers) {
        let input = segmentation_input(on, &shared.samples);
        let clusters = &mut self.clusters;
        shared
            .segmentation
            .segment(&input, clusters, on.parallelism);
    }

    /// Training examples of the segmentation of these clusters, see
    /// [`add_examples`](crate::add_examples).
    pub(crate) fn add_examples(
        &self,
        on: &SurfaceFrame<'_>,
        shared: &mut SharedBuffers,
        objects: &[Option<u16>],
        random: &mut Random,
        examples: &mut SegmentationExamples,
    ) {
        if self.clusters.len() > 0 {
            let input = segmentation_input(on, &shared.samples);
            let of = (&input, &self.clusters);
            shared
                .segmentation
                .add_examples(of, objects, random, examples);
        }
    }

    /// Track-guided regrouping: split clusters shared by several tracked objects, those in the
    /// space of a person or the robot as well, and merge fragments of one tracked object.
    pub(crate) fn regroup_by_tracks(&mut self, on: &SurfaceFrame<'_>, shared: &mut SharedBuffers) {
        let (cloud, tracks) = (&on.frame.cloud, on.frame.priors.tracks);
        let claims = &mut shared.track_claims;
        self.clusters
            .split_by_tracks(cloud, tracks, OBJECT_REACH_M, claims);
        self.clusters.merge_by_tracks(cloud, tracks);
        if !self.masked.is_empty() {
            self.masked_clusters
                .split_by_tracks(cloud, tracks, BODY_REACH_M, claims);
        }
    }

    /// Grow the clusters down to the support plane.
    pub(crate) fn grow_to_surface(&mut self, on: &SurfaceFrame<'_>, _shared: &mut SharedBuffers) {
        let (cloud, surface) = (&on.frame.cloud, on.surface);
        let height = AffineForm::coordinates_of(&surface.table_from_camera)[2];
        let is_base = |pixel: usize, above: usize| {
            let (point, above) = (&cloud.points()[pixel], &cloud.points()[above]);
            let sigma_m = surface.depth_noise.sigma_m(point.z);
            let lowest_m = BASE_HEIGHT_MIN_M.max(BASE_SIGMAS * sigma_m);
            (point.z - above.z).abs() <= BASE_STEP_M * point.z * point.z
                && (lowest_m..=BASE_HEIGHT_MAX_M).contains(&height.at(point.x, point.y, point.z))
        };
        self.clusters
            .grow_to_support_plane(cloud.width() as isize, is_base);
    }

    /// Hypotheses of the clusters with enough points, nearest first, with their support.
    pub(crate) fn find_hypotheses(&mut self, on: &SurfaceFrame<'_>, shared: &mut SharedBuffers) {
        let SurfaceFrame {
            frame: DetectionInput { cloud, .. },
            surface,
            config,
            parallelism,
        } = *on;
        let (clusters, masked_clusters) = (&self.clusters, &self.masked_clusters);
        let (found, hypotheses) = (&mut shared.found_hypotheses, &mut self.hypotheses);
        let axes = AffineForm::coordinates_of(&surface.table_from_camera);
        let overlap = TableOverlap::new(surface, &self.cells);
        let n_masked = if self.masked.is_empty() {
            0
        } else {
            masked_clusters.len()
        };
        let of_bodies = (0..n_masked as u32).map(|cluster| (cluster, true));
        let of_objects = (0..clusters.len() as u32).map(|cluster| (cluster, false));
        let all = of_objects.chain(of_bodies);
        found.for_each(parallelism, all, |found, (cluster, is_masked)| {
            let own = if is_masked { masked_clusters } else { clusters };
            let pixels = own.pixels(cluster as usize);
            if overlap.share(pixels, cloud) >= OVER_TABLE_SHARE_MIN
                && let Some(hypothesis) =
                    ClusterHypothesis::of(cluster, pixels, cloud, &axes, config)
                && is_significant(pixels.len(), &hypothesis.statistics, surface, config)
            {
                found.push(ClusterHypothesis {
                    is_masked,
                    ..hypothesis
                });
            }
        });
        hypotheses.clear();
        found.gather(hypotheses);
        find_support_relations(cloud, clusters, surface, shared.samples.rays(), hypotheses);
        let distance = |one: &ClusterHypothesis| one.statistics.centroid.coords.norm_squared();
        hypotheses.sort_unstable_by(|a, b| {
            distance(a)
                .total_cmp(&distance(b))
                .then((a.is_masked, a.cluster).cmp(&(b.is_masked, b.cluster)))
        });
    }
}

fn segmentation_input<'a>(on: &SurfaceFrame<'a>, samples: &Samples) -> SegmentationInput<'a> {
    SegmentationInput {
        cloud: on.frame.cloud,
        table: TableReference::from(on.surface),
        pixel_pitch: samples.rays().pixel_pitch(),
        tracks: on.frame.priors.tracks,
        joins_clusters: on.config.joins_parts,
    }
}

/// `true` when a cluster has enough points for its height: what hardly rises above the noise
/// of the table has to be larger.
fn is_significant(
    n_points: usize,
    statistics: &ClusterStatistics,
    table: &Table,
    config: &RawConfig,
) -> bool {
    let depth_m = statistics.centroid.z;
    let sigma_m = table.depth_noise.sigma_m(depth_m as f32);
    let is_high = statistics.height_m[1] >= NOISE_HEIGHT_SIGMAS * sigma_m;
    let factor = if is_high { 1.0 } else { LOW_POINTS_FACTOR };
    n_points as f64 >= factor * config.points_min_at_1m / (depth_m * depth_m)
}
