//! Region adjacency graph and greedy merging.

use super::boundary::{BoundaryImage, BoundaryPair, RegionBoundary};
use super::continuation::{are_alike, are_in_a_row};
use super::decision_tree::{FeatureLanes, LANES};
use super::pair_features::{LOG_FOOTPRINT_RATIO, PairContext, PairFeatures, pair_features};
use super::region::{Region, RegionSums, YawAxes};
use crate::segmentation::{Bends, Cell, CellImage, NO_TRACK};
use crate::table_reference::TableReference;
use nalgebra::Vector3;
use point_cloud::Point;
use sensor_noise::DepthNoise;

/// Least log odds at which two regions are merged: even odds.
const LOG_ODDS_MIN: f32 = 0.0;

/// Greatest footprint of the common box of two regions of two clusters, as a multiple of the
/// larger region's: of two equal things with a gap between them it is larger. Chosen.
const FOOTPRINT_RATIO_MAX: f32 = 2.4;

/// Least share of its cluster that a region must have to join this to another cluster: a few mixed
/// pixels at the foot of a thing say nothing about what stands beside it. Chosen.
const CLUSTER_SHARE_MIN: f32 = 0.1;

/// Prior log odds that two regions are one object because one track claims both, and that they
/// are two because two tracks do. Chosen.
const TRACK_LOG_ODDS: f32 = 2.5;

/// Place of no edge.
const NO_EDGE_PLACE: u32 = u32::MAX;

/// Pair of adjacent regions with the decision that is right: a training example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionPair {
    /// Features of the pair, in the order of [`FEATURE_NAMES`](crate::FEATURE_NAMES).
    pub features: PairFeatures,
    /// `true` when both regions belong to one object.
    pub is_one_object: bool,
}

/// Region adjacency graph with the cell pairs along all boundaries. Reused from frame to
/// frame.
#[derive(Debug, Default)]
pub(crate) struct RegionAdjacency {
    axes: YawAxes,
    /// Position of the camera in the table's frame, metres.
    camera: Vector3<f32>,
    noise: DepthNoise,
    /// Per cell: the height over the table, metres.
    height_m: Vec<f32>,
    pairs: Vec<BoundaryPair>,
    edges: Vec<RegionEdge>,
    sums: Vec<RegionSums>,
    regions: Vec<Region>,
    /// Per region: its cluster.
    cluster_of: Vec<u32>,
    cluster_sums: Vec<RegionSums>,
    clusters: Vec<Region>,
    /// Per region: the track that claims it, or [`NO_TRACK`].
    claims: Vec<u32>,
    /// Per region: the place of its edge with the region that was merged last.
    edge_with: Vec<u32>,
}

/// Edge of the graph: two adjacent regions.
#[derive(Debug, Clone, Copy)]
struct RegionEdge {
    boundary: RegionBoundary,
    /// Log odds that the regions are one object.
    log_odds: f32,
}

impl RegionAdjacency {
    /// Reset to `n_regions` empty regions.
    pub(crate) fn clear(&mut self, n_regions: usize) {
        self.height_m.clear();
        self.pairs.clear();
        self.sums.clear();
        self.sums.resize(n_regions, RegionSums::default());
        self.cluster_of.clear();
        self.cluster_of.resize(n_regions, 0);
        self.claims.clear();
        self.claims.resize(n_regions, NO_TRACK);
    }

    /// Add the next cell, with the point that stands for it, to its region.
    #[inline]
    pub(crate) fn add_cell(
        &mut self,
        region: u32,
        cell: &Cell,
        point: &Point,
        table: &TableReference,
    ) {
        let position = table.axes.map(|axis| axis.at(point.x, point.y, point.z));
        self.height_m.push(position[2]);
        self.cluster_of[region as usize] = cell.cluster;
        self.sums[region as usize].add(cell, position, &self.axes);
    }

    /// Add a pair of neighbouring cells, in the order of the image, of different regions.
    #[inline]
    pub(crate) fn add_pair(&mut self, cells: [u32; 2], region_of: &[u32], strength: u8) {
        let [a, b] = cells.map(|cell| region_of[cell as usize]);
        self.pairs.push(BoundaryPair {
            regions: [a.min(b), a.max(b)],
            cells,
            strength,
        });
    }

    /// Build the graph from the added cells and pairs.
    pub(crate) fn connect(
        &mut self,
        image: &CellImage,
        bends: &Bends,
        region_of: &[u32],
        table: &TableReference,
    ) {
        self.noise = table.noise;
        self.camera = Vector3::from(table.axes.map(|axis| axis.at(0.0, 0.0, 0.0)));
        self.describe_clusters();
        let cells = BoundaryImage {
            image,
            bends,
            region_of,
            height_m: &self.height_m,
        };
        self.pairs.sort_unstable();
        self.edges.clear();
        for pairs in self.pairs.chunk_by(|a, b| a.regions == b.regions) {
            self.edges.push(RegionEdge {
                boundary: RegionBoundary::of(pairs, &cells),
                log_odds: f32::NEG_INFINITY,
            });
        }
    }

    /// Describe all regions and clusters by their sums.
    fn describe_clusters(&mut self) {
        let n_clusters = self.cluster_of.iter().max();
        let n_clusters = n_clusters.map_or(0, |&last| last as usize + 1);
        self.cluster_sums.clear();
        self.cluster_sums.resize(n_clusters, RegionSums::default());
        for (sums, &cluster) in self.sums.iter().zip(&self.cluster_of) {
            self.cluster_sums[cluster as usize].merge(sums);
        }
        for (regions, sums) in [
            (&mut self.regions, &self.sums),
            (&mut self.clusters, &self.cluster_sums),
        ] {
            regions.clear();
            regions.extend(sums.iter().map(|sums| sums.describe(&self.camera)));
        }
    }

    /// Note the track that claims each region, or [`NO_TRACK`].
    pub(crate) fn claim(&mut self, claims: &[u32]) {
        self.claims.copy_from_slice(claims);
    }

    /// Greedy region merging: call `join(target, source)` for each two regions that are one
    /// object, most certain first, and update the graph after each merge. Regions of two clusters
    /// are merged only when `joins_clusters`.
    pub(crate) fn merge_regions(&mut self, joins_clusters: bool, mut join: impl FnMut(u32, u32)) {
        if !joins_clusters {
            let cluster_of = &self.cluster_of;
            self.edges.retain(|edge| {
                let [a, b] = edge.boundary.regions.map(|region| region as usize);
                cluster_of[a] == cluster_of[b]
            });
        }
        self.rate(|_| true);
        while let Some(edge) = self.most_certain() {
            let [target, source] = self.merge(edge);
            join(target, source);
            self.rate(|regions| regions.contains(&target));
        }
    }

    /// True if two merged regions, by their roots, may be the parts of one body on both sides of an
    /// occluder, and no two tracks claim them.
    pub(crate) fn may_continue(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a as usize, b as usize];
        let are_two_tracks = match [self.claims[a], self.claims[b]] {
            [NO_TRACK, _] | [_, NO_TRACK] => false,
            [one, other] => one != other,
        };
        if are_two_tracks {
            return false;
        }
        let [one, other] = [&self.regions[a], &self.regions[b]];
        are_alike(one, other, &self.noise)
            && are_in_a_row(one, other, &self.together(&self.sums, a, b))
    }

    /// Description of two regions or clusters together.
    fn together(&self, sums: &[RegionSums], a: usize, b: usize) -> Region {
        let mut both = sums[a];
        both.merge(&sums[b]);
        both.describe(&self.camera)
    }

    /// Training examples: merge regions of one object greedily, those with the weakest boundary
    /// first, and add each edge when it is new or changed (learned agglomeration;
    /// Nunez-Iglesias et al. 2013).
    pub(crate) fn add_examples(
        &mut self,
        object_of_region: &[Option<u16>],
        examples: &mut Vec<RegionPair>,
    ) {
        let mut changed = None;
        loop {
            for edge in 0..self.edges.len() {
                let regions = self.regions_of(edge);
                if changed.is_some_and(|region| !regions.contains(&region)) {
                    continue;
                }
                let objects = regions.map(|region| object_of_region[region as usize]);
                self.edges[edge].log_odds = f32::NEG_INFINITY;
                if let [Some(a), Some(b)] = objects {
                    let example = RegionPair {
                        features: self.features(edge),
                        is_one_object: a == b,
                    };
                    if example.is_one_object {
                        self.edges[edge].log_odds = -self.edges[edge].boundary.mean_log_odds();
                    }
                    examples.push(example);
                }
            }
            match self.best_edge() {
                Some((edge, odds)) if odds > f32::NEG_INFINITY => {
                    changed = Some(self.merge(edge)[0]);
                }
                _ => return,
            }
        }
    }

    /// Rate the log odds of the edges whose regions are selected.
    fn rate(&mut self, is_selected: impl Fn(&[u32; 2]) -> bool) {
        let mut lanes = FeatureLanes::default();
        let (mut rated, mut n) = ([0; LANES], 0);
        for edge in 0..self.edges.len() {
            if is_selected(&self.edges[edge].boundary.regions) {
                let features = self.features(edge);
                if self.are_apart(edge, &features) {
                    self.edges[edge].log_odds = f32::NEG_INFINITY;
                    continue;
                }
                lanes.set(n, &features);
                rated[n] = edge;
                n += 1;
                if n == LANES {
                    self.set_log_odds(&rated, &lanes);
                    n = 0;
                }
            }
        }
        self.set_log_odds(&rated[..n], &lanes);
    }

    fn set_log_odds(&mut self, edges: &[usize], lanes: &FeatureLanes) {
        if edges.is_empty() {
            return;
        }
        for (&edge, log_odds) in edges.iter().zip(lanes.log_odds()) {
            self.edges[edge].log_odds = log_odds + self.prior_log_odds(edge);
        }
    }

    /// True if the regions of an edge, which are of two clusters, are apart on the table, since
    /// equal things in rows look like one in all other features; or if one is a scrap of its
    /// cluster.
    fn are_apart(&self, edge: usize, features: &PairFeatures) -> bool {
        let regions = self.regions_of(edge).map(|region| region as usize);
        let clusters = regions.map(|region| self.cluster_of[region] as usize);
        let is_scrap = |(region, cluster): (usize, usize)| {
            let [part, whole] =
                [&self.regions[region], &self.clusters[cluster]].map(|of| of.n_pixels_at_1m);
            part < CLUSTER_SHARE_MIN * whole
        };
        clusters[0] != clusters[1]
            && (features[LOG_FOOTPRINT_RATIO].exp() > FOOTPRINT_RATIO_MAX
                || regions.into_iter().zip(clusters).any(is_scrap))
    }

    /// Prior log odds of an edge by the claims of tracks on its regions.
    fn prior_log_odds(&self, edge: usize) -> f32 {
        let claims = self.regions_of(edge);
        match claims.map(|region| self.claims[region as usize]) {
            [NO_TRACK, _] | [_, NO_TRACK] => 0.0,
            [a, b] if a == b => TRACK_LOG_ODDS,
            _ => -TRACK_LOG_ODDS,
        }
    }

    /// Regions of an edge, lower number first.
    fn regions_of(&self, edge: usize) -> [u32; 2] {
        self.edges[edge].boundary.regions
    }

    /// Features of an edge.
    fn features(&self, edge: usize) -> PairFeatures {
        let boundary = &self.edges[edge].boundary;
        let [a, b] = boundary.regions.map(|region| region as usize);
        let clusters = [a, b].map(|region| self.cluster_of[region] as usize);
        let is_one_cluster = clusters[0] == clusters[1];
        let cluster = if is_one_cluster {
            self.clusters[clusters[0]]
        } else {
            self.together(&self.cluster_sums, clusters[0], clusters[1])
        };
        let context = PairContext {
            both: &self.together(&self.sums, a, b),
            cluster: &cluster,
            is_one_cluster,
            noise: &self.noise,
        };
        pair_features(boundary, [&self.regions[a], &self.regions[b]], &context)
    }

    /// Merge the regions of an edge, and their boundaries to common third regions. Returns
    /// the region that remains and the one that is gone.
    fn merge(&mut self, edge: usize) -> [u32; 2] {
        let [target, source] = self.edges.swap_remove(edge).boundary.regions;
        let gone = self.sums[source as usize];
        let kept = &mut self.sums[target as usize];
        kept.merge(&gone);
        self.regions[target as usize] = kept.describe(&self.camera);
        self.join_clusters(target, source);
        let claims = [target, source].map(|region| self.claims[region as usize]);
        self.claims[target as usize] = match claims {
            [NO_TRACK, claim] | [claim, NO_TRACK] => claim,
            [a, b] if a == b => a,
            _ => NO_TRACK,
        };
        self.join_boundaries(target, source);
        [target, source]
    }

    /// Make the clusters of two merged regions one.
    fn join_clusters(&mut self, target: u32, source: u32) {
        let [kept, gone] = [target, source].map(|region| self.cluster_of[region as usize]);
        if kept != gone {
            let sums = self.cluster_sums[gone as usize];
            self.cluster_sums[kept as usize].merge(&sums);
            let cluster = self.cluster_sums[kept as usize].describe(&self.camera);
            self.clusters[kept as usize] = cluster;
            let of_gone = self.cluster_of.iter_mut().filter(|own| **own == gone);
            of_gone.for_each(|cluster| *cluster = kept);
        }
    }

    /// Move the boundaries of the region `source` to `target`, and add up those that `target` has
    /// already.
    fn join_boundaries(&mut self, target: u32, source: u32) {
        let other_of = |regions: [u32; 2], own: u32| match regions {
            [a, b] if a == own => Some(b as usize),
            [a, b] if b == own => Some(a as usize),
            _ => None,
        };
        self.edge_with.clear();
        self.edge_with.resize(self.regions.len(), NO_EDGE_PLACE);
        for (place, edge) in (0..).zip(&self.edges) {
            if let Some(other) = other_of(edge.boundary.regions, target) {
                self.edge_with[other] = place;
            }
        }
        // From the last one on, so that a removed edge is replaced by one that has been seen.
        for place in (0..self.edges.len()).rev() {
            let Some(other) = other_of(self.edges[place].boundary.regions, source) else {
                continue;
            };
            let region = other as u32;
            match self.edge_with[other] {
                NO_EDGE_PLACE => {
                    let regions = [target.min(region), target.max(region)];
                    self.edges[place].boundary.regions = regions;
                }
                first => {
                    let boundary = self.edges[place].boundary;
                    self.edges[first as usize].boundary.add(&boundary);
                    self.remove_edge(place, target);
                }
            }
        }
    }

    /// Remove an edge, and note the new place of the last one if that is an edge of `target`.
    fn remove_edge(&mut self, place: usize, target: u32) {
        self.edges.swap_remove(place);
        if let Some(moved) = self.edges.get(place) {
            let [a, b] = moved.boundary.regions;
            if a == target {
                self.edge_with[b as usize] = place as u32;
            } else if b == target {
                self.edge_with[a as usize] = place as u32;
            }
        }
    }

    /// Edge with the highest log odds, with these.
    fn best_edge(&self) -> Option<(usize, f32)> {
        let log_odds = self.edges.iter().map(|edge| edge.log_odds);
        log_odds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Edge with the highest log odds; `None` when no two regions are one object.
    fn most_certain(&self) -> Option<usize> {
        let best = self.best_edge();
        best.and_then(|(edge, odds)| (odds > LOG_ODDS_MIN).then_some(edge))
    }
}

#[cfg(test)]
mod tests;
