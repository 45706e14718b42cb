//! Voxel path of detection, for clouds that are not a single view.

use super::table_coverage::TableCoverage;
use super::virtual_view::{CloudCluster, VirtualView};
use super::voxel_clusters::VoxelClusters;
use super::voxel_grid::VoxelGrid;
use super::voxel_table::{VoxelTable, VoxelTableSearch};
use crate::affine_form::AffineForm;
use crate::candidate::Support;
use crate::cluster_hypothesis::ClusterHypothesis;
use crate::constraint_evaluation::{BodyMask, ConstraintEvaluator};
use crate::input::DetectionInput;
use crate::organized::OrganizedBuffers;
use crate::output::Detection;
use crate::support_relations::propagate_support;
use crate::table::Table;
use crate::table_surface::TableSurface;
use crate::{Config, RawConfig};
use point_cloud::{OrganizedCloud, Point};

/// Side of the voxels for the plane search, metres. Chosen.
const VOXEL_M: f32 = 0.010;

/// Least side of the cluster cells, metres. Chosen.
const CELL_M: f64 = 0.006;

/// Least side of the cluster cells, in mean point spacings on the table. Chosen.
const SPACINGS: f64 = 1.5;

/// Area of a Kinect v1 pixel at 1 m, square metres; converts the configured least number of
/// points into a least area.
const PIXEL_AREA_M2: f64 = 2.9e-6;

/// Longest side above which a cluster is examined for parts, metres. Chosen.
const LONGEST_SIDE_M: f64 = 0.30;

/// Footprint area above which a cluster is examined for parts, square metres. Chosen.
const FOOTPRINT_M2: f64 = 0.03;

/// Greatest number of clusters examined for parts; only a damaged cloud has more.
const N_SPLITS_MAX: usize = 32;

/// Greatest number of hypotheses; of more, which only a damaged cloud has, the largest are
/// kept.
const N_HYPOTHESES_MAX: usize = 512;

/// Greatest share of a cluster's points with visible table below at which its support may
/// be occluded. Chosen.
const SEEN_UNDER_MAX: f64 = 0.3;

/// Voxel detector with its buffers.
#[derive(Debug, Default)]
pub(super) struct VoxelDetector {
    voxels: VoxelGrid,
    search: VoxelTableSearch,
    surface: TableSurface,
    coverage: TableCoverage,
    over_table: Vec<u32>,
    clusters: VoxelClusters,
    virtual_view: VirtualView,
    body_mask: BodyMask,
    indices: Vec<u32>,
    hypotheses: Vec<ClusterHypothesis>,
    /// Least number of points of an object at the density of the table.
    n_points_min: f64,
}

impl VoxelDetector {
    /// Detect in a cloud; `organized` serves the virtual views of large clusters.
    pub(super) fn detect(
        &mut self,
        frame: &DetectionInput<'_>,
        rules: &Config,
        organized: &mut OrganizedBuffers,
        detection: &mut Detection,
    ) {
        let config = rules.get();
        let points = frame.cloud.points();
        let position = |i: usize| points[i].is_finite().then(|| coordinates(&points[i]));
        self.voxels.fill(points.len(), position, VOXEL_M);
        let found = self
            .search
            .find(&self.voxels, frame.up_in_camera, config, &mut self.surface);
        let Some(VoxelTable { table, lowest_m }) = found else {
            return;
        };
        let table_axes = AffineForm::coordinates_of(&table.table_from_camera);
        let spacing_m = self.list_above_table(points, &table, &table_axes, lowest_m, config);
        let cell_m = CELL_M.max(SPACINGS * spacing_m);
        let cells_per_point = PIXEL_AREA_M2 / (cell_m * cell_m);
        let n_min = (cells_per_point * config.points_min_at_1m).ceil() as u32;
        self.clusters.label_components(
            points,
            &self.over_table,
            &table_axes,
            (cell_m as f32, n_min),
            &mut self.voxels,
        );
        let per_point = PIXEL_AREA_M2 / (spacing_m * spacing_m).max(1e-12);
        self.n_points_min = per_point.min(1.0) * config.points_min_at_1m;
        self.split_large_clusters(&frame.cloud, &table, config, organized);
        self.find_hypotheses(&frame.cloud, &table_axes, config);
        self.write(frame, &table, rules, detection);
        detection.surfaces.push(table);
    }

    /// List the points in the prism above the table and map the table's own points. Returns
    /// the mean point spacing on the table, metres.
    fn list_above_table(
        &mut self,
        points: &[Point],
        table: &Table,
        table_axes: &[AffineForm; 3],
        lowest_m: f32,
        config: &RawConfig,
    ) -> f64 {
        let Self {
            surface,
            coverage,
            over_table,
            ..
        } = self;
        surface.refill_from_polygon(&table.polygon);
        coverage.clear(&table.polygon);
        over_table.clear();
        let highest_m = config.height_max_m as f32;
        let mut n_on_table = 0_u32;
        for (index, point) in (0..).zip(points) {
            let [u, v, height] = table_axes.map(|axis| axis.at(point.x, point.y, point.z));
            if !(-lowest_m..=highest_m).contains(&height) || !surface.is_table(u, v) {
                continue;
            }
            if height < lowest_m {
                coverage.add(u, v);
                n_on_table += 1;
            } else {
                over_table.push(index);
            }
        }
        (table.polygon.area_m2() / f64::from(n_on_table.max(1))).sqrt()
    }

    /// Split large clusters into the parts seen from a virtual viewpoint.
    fn split_large_clusters(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        table: &Table,
        config: &RawConfig,
        organized: &mut OrganizedBuffers,
    ) {
        let n_joined = self.clusters.len();
        let (mut n_clusters, mut n_views) = (n_joined, 0);
        let table_axes = AffineForm::coordinates_of(&table.table_from_camera);
        for cluster in 0..n_joined {
            self.list_members(cluster);
            let hypothesis = ClusterHypothesis::of(0, &self.indices, cloud, &table_axes, config);
            let Some(ClusterHypothesis { upright_box, .. }) = hypothesis else {
                continue;
            };
            if upright_box.longest_side_m() <= LONGEST_SIDE_M
                && upright_box.footprint_m2() <= FOOTPRINT_M2
            {
                continue;
            }
            n_views += 1;
            if n_views > N_SPLITS_MAX {
                break;
            }
            let bounds = upright_box.in_camera(&table.table_from_camera);
            let virtual_view = CloudCluster {
                points: cloud.points(),
                members: &self.indices,
                bounds: &bounds,
                table,
            };
            let n_parts = self
                .virtual_view
                .find_parts(&virtual_view, config, organized);
            if n_parts >= 2 {
                let part_of = self.virtual_view.part_of();
                self.clusters
                    .split(cluster, part_of, n_clusters as u32, &self.voxels);
                n_clusters += n_parts - 1;
            }
        }
        self.clusters.regroup(n_clusters);
    }

    /// List the indices of a cluster's points in the cloud.
    fn list_members(&mut self, cluster: usize) {
        self.indices.clear();
        let members = self.clusters.members(cluster).iter();
        self.indices
            .extend(members.map(|&member| self.over_table[member as usize]));
    }

    /// Hypotheses of the clusters, nearest to the cloud's origin first.
    fn find_hypotheses(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        table_axes: &[AffineForm; 3],
        config: &RawConfig,
    ) {
        self.hypotheses.clear();
        for cluster in 0..self.clusters.len() {
            self.list_members(cluster);
            if self.indices.len() as f64 >= self.n_points_min {
                let hypothesis =
                    ClusterHypothesis::of(cluster as u32, &self.indices, cloud, table_axes, config);
                self.hypotheses.extend(hypothesis);
            }
        }
        self.keep_largest();
        while propagate_support(&mut self.hypotheses) {}
        self.find_occluded_support(cloud.points(), table_axes);
        while propagate_support(&mut self.hypotheses) {}
        let distance =
            |hypothesis: &ClusterHypothesis| hypothesis.statistics.centroid.coords.norm_squared();
        self.hypotheses.sort_unstable_by(|a, b| {
            distance(a)
                .total_cmp(&distance(b))
                .then(a.cluster.cmp(&b.cluster))
        });
    }

    fn keep_largest(&mut self) {
        if self.hypotheses.len() > N_HYPOTHESES_MAX {
            let clusters = &self.clusters;
            let n_points = |hypothesis: &ClusterHypothesis| {
                clusters.members(hypothesis.cluster as usize).len()
            };
            self.hypotheses.sort_unstable_by_key(|hypothesis| {
                (std::cmp::Reverse(n_points(hypothesis)), hypothesis.cluster)
            });
            self.hypotheses.truncate(N_HYPOTHESES_MAX);
        }
    }

    /// Set an occluded support for hypotheses that neither reach the table nor have visible
    /// table below.
    fn find_occluded_support(&mut self, points: &[Point], table_axes: &[AffineForm; 3]) {
        let [u, v, _] = table_axes;
        for hypothesis in self
            .hypotheses
            .iter_mut()
            .filter(|hypothesis| hypothesis.support.is_none())
        {
            let members = self.clusters.members(hypothesis.cluster as usize);
            let is_over_seen = |&&member: &&u32| {
                let point = &points[self.over_table[member as usize] as usize];
                self.coverage.is_seen(
                    u.at(point.x, point.y, point.z),
                    v.at(point.x, point.y, point.z),
                )
            };
            let n_over_seen = members.iter().filter(is_over_seen).count();
            if n_over_seen as f64 <= SEEN_UNDER_MAX * members.len() as f64 {
                hypothesis.support = Some(Support::Occluded);
            }
        }
    }

    fn write(
        &mut self,
        frame: &DetectionInput<'_>,
        table: &Table,
        config: &Config,
        detection: &mut Detection,
    ) {
        self.body_mask.refill(&frame.priors, table, config.get());
        let evaluator = ConstraintEvaluator {
            depth_bodies: None,
            cloud: frame.cloud,
            surface: (0, table),
            priors: frame.priors,
            body_mask: &self.body_mask,
            config: config.get(),
        };
        for hypothesis in &self.hypotheses {
            let first = detection.point_indices.len();
            let members = self.clusters.members(hypothesis.cluster as usize).iter();
            detection
                .point_indices
                .extend(members.map(|&member| self.over_table[member as usize]));
            let range = first..detection.point_indices.len();
            let indices = &detection.point_indices[range.clone()];
            // Without an image, no border can cut it.
            let candidate = evaluator.candidate(hypothesis, range, indices, false, config.rule());
            detection.candidates.push(candidate);
        }
    }
}

fn coordinates(point: &Point) -> [f32; 3] {
    [point.x, point.y, point.z]
}
