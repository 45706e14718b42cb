//! Image path of detection: stages from an organised cloud to candidates.

use crate::affine_form::AffineForm;
use crate::candidate::Candidate;
use crate::cluster_hypothesis::{ClusterHypothesis, ClusterStatistics};
use crate::clusters::{Clusters, TrackClaims};
use crate::constraint_evaluation::{BodyMask, ConstraintEvaluator};
use crate::execution::Execution;
use crate::input::DetectionInput;
use crate::near_limit::NearLimit;
use crate::outline_tracing::OutlineTracer;
use crate::output::Detection;
use crate::parallelism::{Parallelism, ScratchPool};
use crate::pixel_bounds::PixelBounds;
use crate::prism::{Prism, TableOverlap, lowest_m};
use crate::reaching_bodies::ReachingBodies;
use crate::samples::Samples;
use crate::segmentation::{Segmentation, SegmentationExamples, SegmentationInput};
use crate::stage::DetectionStage;
use crate::support_plane_holes::SupportPlaneHoles;
use crate::support_relations::find_support_relations;
use crate::table::Table;
use crate::table_noise::noise_ratio;
use crate::table_reference::TableReference;
use crate::table_selection::{TableSelectionBuffers, select_table};
use crate::table_surface::TableSurface;
use crate::{Config, RawConfig};
use point_cloud::OrganizedCloud;
use random::Random;

/// Width of the image border zone, pixels: a candidate that reaches it may be cut.
/// Chosen.
const BORDER_PX: usize = 3;

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

/// Buffers of the image path, reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct OrganizedBuffers {
    samples: Samples,
    table: TableSelectionBuffers,
    surface: TableSurface,
    tracer: OutlineTracer,
    /// Pixels in the prism above the table, per band of image rows.
    bands: Vec<Vec<u32>>,
    /// Pixels in the prism above the table.
    over_table: Vec<u32>,
    body_mask: BodyMask,
    reaching_bodies: ReachingBodies,
    /// Pixels that show people or the robot.
    masked: Vec<u32>,
    /// Clusters of people and the robot; stale when `masked` is empty.
    masked_clusters: Clusters,
    clusters: Clusters,
    segmentation: Segmentation,
    track_claims: TrackClaims,
    holes: SupportPlaneHoles,
    found_hypotheses: ScratchPool<Vec<ClusterHypothesis>>,
    hypotheses: Vec<ClusterHypothesis>,
    candidates: ScratchPool<Vec<Candidate>>,
}

impl OrganizedBuffers {
    /// Empty a detection and keep the memory of its table for the next one.
    pub(crate) fn recycle(&mut self, detection: &mut Detection) {
        self.table.recycle(detection.table.take());
        detection.bodies.clear();
        detection.candidates.clear();
        detection.point_indices.clear();
    }

    /// Pixels covered by a cluster hypothesis.
    fn pixels(&self, hypothesis: &ClusterHypothesis) -> &[u32] {
        let clusters = if hypothesis.is_masked {
            &self.masked_clusters
        } else {
            &self.clusters
        };
        clusters.pixels(hypothesis.cluster as usize)
    }
}

/// Detect the table and the candidates in an organised cloud; `detection` comes
/// empty. Without a table it stays empty.
pub(crate) fn detect_organized(
    frame: &DetectionInput<'_>,
    config: &Config,
    buffers: &mut OrganizedBuffers,
    detection: &mut Detection,
    mut execution: Execution<'_>,
) {
    let raw = config.get();
    let parallelism = execution.parallelism;
    if let Some(table) = find_table(frame, raw, buffers, &mut execution) {
        list_above_table(&frame.cloud, &table, raw, parallelism, buffers);
        execution.end_stage(DetectionStage::PrismFilter);
        cluster_pixels(frame, &table, raw, parallelism, buffers);
        execution.end_stage(DetectionStage::Clustering);
        segment(frame, &table, raw, parallelism, buffers);
        execution.end_stage(DetectionStage::Segmentation);
        regroup_by_tracks(frame, buffers);
        execution.end_stage(DetectionStage::TrackRegrouping);
        grow_to_support_plane(&frame.cloud, &table, buffers);
        execution.end_stage(DetectionStage::SupportPlaneGrowth);
        find_hypotheses(&frame.cloud, &table, raw, parallelism, buffers);
        execution.end_stage(DetectionStage::BoundingBoxes);
        write_candidates(frame, &table, config, parallelism, buffers, detection);
        detection.bodies.assign(buffers.reaching_bodies.map());
        detection.table = Some(table);
        execution.end_stage(DetectionStage::ConstraintEvaluation);
    }
}

/// Table of a frame with its surface cells and outline.
fn find_table(
    frame: &DetectionInput<'_>,
    config: &RawConfig,
    buffers: &mut OrganizedBuffers,
    execution: &mut Execution<'_>,
) -> Option<Table> {
    let (samples, surface) = (&mut buffers.samples, &mut buffers.surface);
    samples.refill(&frame.cloud, config);
    execution.end_stage(DetectionStage::Subsampling);
    let (up, expected, selection) = (frame.up_in_camera, frame.priors.table, &mut buffers.table);
    let table = select_table(samples, up, expected, config, selection);
    execution.end_stage(DetectionStage::TablePlane);
    let mut table = table?;
    surface.refill(&mut table, samples);
    table.noise_ratio = noise_ratio(samples, &table, surface, &config.depth_noise);
    table.depth_noise = config.depth_noise.scaled(table.noise_ratio);
    if surface.differs_from_polygon() {
        buffers.tracer.trace(surface, &mut table.outline);
    }
    execution.end_stage(DetectionStage::TableSurface);
    Some(table)
}

/// List the pixels in the prism above the table and in holes of the support plane.
fn list_above_table(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    config: &RawConfig,
    parallelism: &dyn Parallelism,
    buffers: &mut OrganizedBuffers,
) {
    let height = AffineForm::coordinates_of(&table.table_from_camera)[2];
    buffers.holes.find(&buffers.samples, &height, |z| {
        lowest_m(z, config.height_min_m as f32, &table.depth_noise)
    });
    let prism = Prism::over(table, config, &buffers.holes, &buffers.surface);
    let over_table = &mut buffers.over_table;
    prism.list_pixels(cloud, parallelism, &mut buffers.bands, over_table);
}

/// Cluster the pixels above the table. Pixels of people and the robot are clustered
/// separately, so that no object merges with a body that touches it.
fn cluster_pixels(
    frame: &DetectionInput<'_>,
    table: &Table,
    config: &RawConfig,
    parallelism: &dyn Parallelism,
    buffers: &mut OrganizedBuffers,
) {
    let (over_table, masked) = (&mut buffers.over_table, &mut buffers.masked);
    let (samples, bodies) = (&buffers.samples, &mut buffers.reaching_bodies);
    let body_mask = &mut buffers.body_mask;
    body_mask.refill(&frame.priors, table, config);
    let tracks = frame.priors.tracks;
    body_mask.extract(&frame.cloud, tracks, over_table, masked);
    if frame.priors.instructor.is_none() {
        bodies.find(frame, samples, table, &buffers.surface, config);
        bodies.extract(&frame.cloud, samples, over_table, masked);
    } else {
        bodies.clear();
    }
    let n_min = (config.points_min_at_1m / (config.range_max_m * config.range_max_m)) as u32;
    let clusters = &mut buffers.clusters;
    clusters.label_components(&frame.cloud, parallelism, over_table, n_min);
    if !masked.is_empty() {
        let clusters = &mut buffers.masked_clusters;
        clusters.label_components(&frame.cloud, parallelism, masked, n_min);
    }
}

/// Segmentation: split and join the clusters, so that each is one object.
fn segment(
    frame: &DetectionInput<'_>,
    table: &Table,
    config: &RawConfig,
    parallelism: &dyn Parallelism,
    buffers: &mut OrganizedBuffers,
) {
    let input = segmentation_input(frame, table, config, &buffers.samples);
    let clusters = &mut buffers.clusters;
    buffers.segmentation.segment(&input, clusters, parallelism);
}

fn segmentation_input<'a>(
    frame: &DetectionInput<'a>,
    table: &Table,
    config: &RawConfig,
    samples: &Samples,
) -> SegmentationInput<'a> {
    SegmentationInput {
        cloud: frame.cloud,
        table: TableReference::from(table),
        pixel_pitch: samples.rays().pixel_pitch(),
        tracks: frame.priors.tracks,
        joins_clusters: config.joins_parts,
    }
}

/// Training examples of the segmentation in one frame, see
/// [`add_examples`](crate::add_examples).
pub(crate) fn add_segmentation_examples(
    frame: &DetectionInput<'_>,
    config: &Config,
    buffers: &mut OrganizedBuffers,
    objects: &[Option<u16>],
    random: &mut Random,
    examples: &mut SegmentationExamples,
) {
    let raw = config.get();
    let mut execution = Execution::default();
    let parallelism = execution.parallelism;
    let Some(table) = find_table(frame, raw, buffers, &mut execution) else {
        return;
    };
    list_above_table(&frame.cloud, &table, raw, parallelism, buffers);
    cluster_pixels(frame, &table, raw, parallelism, buffers);
    if buffers.clusters.len() > 0 {
        let input = segmentation_input(frame, &table, raw, &buffers.samples);
        buffers
            .segmentation
            .add_examples((&input, &buffers.clusters), objects, random, examples);
    }
}

/// Track-guided regrouping: split clusters shared by several tracked objects and merge
/// fragments of one tracked object.
fn regroup_by_tracks(frame: &DetectionInput<'_>, buffers: &mut OrganizedBuffers) {
    let (tracks, clusters) = (frame.priors.tracks, &mut buffers.clusters);
    clusters.split_by_tracks(&frame.cloud, tracks, &mut buffers.track_claims);
    clusters.merge_by_tracks(&frame.cloud, tracks);
}

/// Grow the clusters down to the support plane.
fn grow_to_support_plane(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    buffers: &mut OrganizedBuffers,
) {
    let height = AffineForm::coordinates_of(&table.table_from_camera)[2];
    let is_base = |pixel: usize, above: usize| {
        let (point, above) = (&cloud.points()[pixel], &cloud.points()[above]);
        let lowest_m = BASE_HEIGHT_MIN_M.max(BASE_SIGMAS * table.depth_noise.sigma_m(point.z));
        (point.z - above.z).abs() <= BASE_STEP_M * point.z * point.z
            && (lowest_m..=BASE_HEIGHT_MAX_M).contains(&height.at(point.x, point.y, point.z))
    };
    buffers
        .clusters
        .grow_to_support_plane(cloud.width() as isize, is_base);
}

/// Hypotheses of the clusters with enough points, nearest first, with their support.
fn find_hypotheses(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    config: &RawConfig,
    parallelism: &dyn Parallelism,
    buffers: &mut OrganizedBuffers,
) {
    let (clusters, masked_clusters) = (&buffers.clusters, &buffers.masked_clusters);
    let (found_hypotheses, hypotheses) = (&mut buffers.found_hypotheses, &mut buffers.hypotheses);
    let table_axes = AffineForm::coordinates_of(&table.table_from_camera);
    let overlap = TableOverlap::new(table, &buffers.surface);
    let n_masked = if buffers.masked.is_empty() {
        0
    } else {
        masked_clusters.len()
    };
    let of_bodies = (0..n_masked as u32).map(|cluster| (cluster, true));
    let of_objects = (0..clusters.len() as u32).map(|cluster| (cluster, false));
    let all = of_objects.chain(of_bodies);
    found_hypotheses.for_each(parallelism, all, |found, (cluster, is_masked)| {
        let own = if is_masked { masked_clusters } else { clusters };
        let pixels = own.pixels(cluster as usize);
        if overlap.share(pixels, cloud) >= OVER_TABLE_SHARE_MIN
            && let Some(hypothesis) =
                ClusterHypothesis::of(cluster, pixels, cloud, &table_axes, config)
            && is_significant(pixels.len(), &hypothesis.statistics, table, config)
        {
            found.push(ClusterHypothesis {
                is_masked,
                ..hypothesis
            });
        }
    });
    hypotheses.clear();
    found_hypotheses.gather(hypotheses);
    find_support_relations(cloud, clusters, table, buffers.samples.rays(), hypotheses);
    let distance = |one: &ClusterHypothesis| one.statistics.centroid.coords.norm_squared();
    hypotheses.sort_unstable_by(|a, b| {
        distance(a)
            .total_cmp(&distance(b))
            .then((a.is_masked, a.cluster).cmp(&(b.is_masked, b.cluster)))
    });
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

/// Evaluate the constraints of the hypotheses and write them as candidates.
fn write_candidates(
    frame: &DetectionInput<'_>,
    table: &Table,
    config: &Config,
    parallelism: &dyn Parallelism,
    buffers: &mut OrganizedBuffers,
    detection: &mut Detection,
) {
    let bounds = PixelBounds::of(&frame.cloud);
    let near_limit = NearLimit::of(frame.cloud, &buffers.samples, table);
    let evaluator = ConstraintEvaluator {
        cloud: frame.cloud,
        table,
        priors: frame.priors,
        body_mask: &buffers.body_mask,
        depth_bodies: buffers
            .reaching_bodies
            .map()
            .is_any()
            .then_some((&buffers.reaching_bodies, &buffers.samples)),
        config: config.get(),
    };
    let indices = &mut detection.point_indices;
    for hypothesis in &buffers.hypotheses {
        indices.extend_from_slice(buffers.pixels(hypothesis));
    }
    let mut first = 0;
    let hypotheses = buffers.hypotheses.iter().map(|hypothesis| {
        let range = first..first + buffers.pixels(hypothesis).len();
        first = range.end;
        (hypothesis, range)
    });
    buffers.candidates.for_each(
        parallelism,
        hypotheses,
        |candidates, (hypothesis, range)| {
            let pixels = &indices[range.clone()];
            let is_cut = bounds.is_touched_by(&hypothesis.statistics.pixel_bounds, BORDER_PX)
                || near_limit.cuts(pixels);
            let candidate = evaluator.candidate(hypothesis, range, pixels, is_cut, config.rule());
            candidates.push(candidate);
        },
    );
    buffers.candidates.gather(&mut detection.candidates);
    let first = |candidate: &Candidate| candidate.range.start;
    detection.candidates.sort_unstable_by_key(first);
}
