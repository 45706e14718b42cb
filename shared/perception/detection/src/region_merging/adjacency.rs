//! Region adjacency graph and greedy merging.

use super::boundary::{BoundaryPair, RegionBoundary};
use super::decision_tree::log_odds;
use super::pair_features::{PairFeatures, pair_features};
use super::region::{Region, RegionSums, YawAxes};
use crate::affine_form::AffineForm;
use crate::patch::Patch;
use crate::table_reference::TableReference;
use nalgebra::Vector3;
use point_cloud::Point;
use random::Random;
use sensor_noise::DepthNoise;

/// Least log odds at which two regions are merged: even odds.
const LOG_ODDS_MIN: f32 = 0.0;

/// Pair of adjacent regions with the decision that is right: a training example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionPair {
    /// Features of the pair, in the order of [`FEATURE_NAMES`](crate::FEATURE_NAMES).
    pub features: PairFeatures,
    /// `true` when both regions belong to one object.
    pub is_one_object: bool,
}

/// Region adjacency graph with the pixel pairs along all boundaries. Reused from frame to
/// frame.
#[derive(Debug, Default)]
pub(crate) struct RegionAdjacency {
    axes: YawAxes,
    /// Position of the camera in the table's frame, metres.
    camera: Vector3<f32>,
    pairs: Vec<BoundaryPair>,
    edges: Vec<RegionEdge>,
    sums: Vec<RegionSums>,
    regions: Vec<Region>,
    /// All regions together.
    cluster: Region,
    noise: DepthNoise,
}

/// Edge of the graph: two adjacent regions.
#[derive(Debug, Clone, Copy)]
struct RegionEdge {
    boundary: RegionBoundary,
    /// Log odds that the regions are one object.
    log_odds: f32,
}

impl RegionAdjacency {
    /// Reset to `n_parts` empty regions, counted from 0.
    pub(crate) fn clear(&mut self, n_parts: usize) {
        self.pairs.clear();
        self.sums.clear();
        self.sums.resize(n_parts, RegionSums::default());
    }

    /// Add the colour and area of a pixel to its region.
    #[inline]
    pub(crate) fn add_pixel(&mut self, region: u32, point: &Point) {
        self.sums[region as usize].add_pixel(point);
    }

    /// Add the position of a pixel to its region.
    #[inline]
    pub(crate) fn add_position(&mut self, region: u32, point: &Point, table: &[AffineForm; 3]) {
        let position = [0, 1, 2].map(|i| table[i].at(point.x, point.y, point.z));
        self.sums[region as usize].add_position(position, point.z, &self.axes);
    }

    /// Add a pair of neighbouring pixels of different regions, as patch indices.
    #[inline]
    pub(crate) fn add_pair(&mut self, regions: [u32; 2], pixels: [usize; 2]) {
        let [a, b] = pixels.map(|pixel| pixel as u32);
        self.pairs.push(if regions[0] < regions[1] {
            BoundaryPair {
                regions,
                pixels: [a, b],
            }
        } else {
            BoundaryPair {
                regions: [regions[1], regions[0]],
                pixels: [b, a],
            }
        });
    }

    /// Build the graph from the added pixels and pairs; `bend` holds the signed bend at each
    /// pixel of the patch.
    pub(crate) fn connect(&mut self, patch: &Patch, bend: &[f32], table: &TableReference) {
        self.noise = table.noise;
        self.camera = Vector3::from(table.axes.map(|axis| axis.at(0.0, 0.0, 0.0)));
        self.regions.clear();
        self.regions
            .extend(self.sums.iter().map(|sums| sums.describe(&self.camera)));
        let mut all = RegionSums::default();
        self.sums.iter().for_each(|sums| all.merge(sums));
        self.cluster = all.describe(&self.camera);
        self.pairs.sort_unstable();
        self.edges.clear();
        for pairs in self.pairs.chunk_by(|a, b| a.regions == b.regions) {
            self.edges.push(RegionEdge {
                boundary: RegionBoundary::of(pairs, patch, bend, &table.axes[2]),
                log_odds: 0.0,
            });
        }
    }

    /// Greedy region merging: call `join(target, source)` for each two regions that are one
    /// object, most certain first, and update the graph after each merge.
    pub(crate) fn merge_regions(&mut self, mut join: impl FnMut(u32, u32)) {
        for edge in 0..self.edges.len() {
            self.edges[edge].log_odds = log_odds(&self.features(edge));
        }
        while let Some(edge) = self.most_certain() {
            let [target, source] = self.merge(edge);
            join(target, source);
            for edge in 0..self.edges.len() {
                if self.edges[edge].boundary.regions.contains(&target) {
                    self.edges[edge].log_odds = log_odds(&self.features(edge));
                }
            }
        }
    }

    /// Training examples: list all edges whose regions have known objects, then merge the
    /// regions of one object in a random order and list the changed edges after each merge.
    pub(crate) fn list_examples(
        &mut self,
        object_of_region: &[Option<u16>],
        random: &mut Random,
        examples: &mut Vec<RegionPair>,
    ) {
        let objects = |adjacency: &Self, edge: usize| {
            let [a, b] = adjacency.regions_of(edge);
            object_of_region[a as usize].zip(object_of_region[b as usize])
        };
        let mut changed = None;
        loop {
            let mut same = Vec::new();
            for edge in 0..self.edges.len() {
                let Some((a, b)) = objects(self, edge) else {
                    continue;
                };
                if changed.is_none_or(|region| self.regions_of(edge).contains(&region)) {
                    examples.push(RegionPair {
                        features: self.features(edge),
                        is_one_object: a == b,
                    });
                }
                if a == b {
                    same.push(edge);
                }
            }
            let Some(&next) = random.choice(&same) else {
                return;
            };
            changed = Some(self.merge(next)[0]);
        }
    }

    /// Number of edges of the graph.
    pub(crate) fn n_edges(&self) -> usize {
        self.edges.len()
    }

    /// Regions of an edge, lower number first.
    pub(crate) fn regions_of(&self, edge: usize) -> [u32; 2] {
        self.edges[edge].boundary.regions
    }

    /// Features of an edge.
    pub(crate) fn features(&self, edge: usize) -> PairFeatures {
        let boundary = &self.edges[edge].boundary;
        let [a, b] = boundary.regions.map(|region| region as usize);
        let mut both = self.sums[a];
        both.merge(&self.sums[b]);
        pair_features(
            boundary,
            [&self.regions[a], &self.regions[b]],
            &both.describe(&self.camera),
            &self.cluster,
            &self.noise,
        )
    }

    /// Merge the regions of an edge, and their boundaries to common third regions. Returns
    /// the region that remains and the one that is gone.
    pub(crate) fn merge(&mut self, edge: usize) -> [u32; 2] {
        let [target, source] = self.edges.swap_remove(edge).boundary.regions;
        let gone = self.sums[source as usize];
        let kept = &mut self.sums[target as usize];
        kept.merge(&gone);
        self.regions[target as usize] = kept.describe(&self.camera);
        for edge in &mut self.edges {
            let regions = &mut edge.boundary.regions;
            for region in regions.iter_mut().filter(|region| **region == source) {
                *region = target;
            }
            regions.sort_unstable();
        }
        self.edges
            .sort_unstable_by_key(|edge| edge.boundary.regions);
        self.edges.dedup_by(|next, first| {
            let same = next.boundary.regions == first.boundary.regions;
            if same {
                first.boundary.add(&next.boundary);
            }
            same
        });
        [target, source]
    }

    /// Edge with the highest log odds; `None` when no two regions are one object.
    fn most_certain(&self) -> Option<usize> {
        let odds = self.edges.iter().map(|edge| edge.log_odds);
        let (at, odds) = odds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (odds > LOG_ODDS_MIN).then_some(at)
    }
}
#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use point_cloud::{OrganizedCloud, Rgba};

    const WIDTH: usize = 90;
    const HEIGHT: usize = 40;

    /// Graph of an image of three regions side by side, each 30 columns wide, numbered by
    /// `number_of`; the depth steps back by 2 cm from the second to the third.
    fn graph(number_of: [u32; 3]) -> RegionAdjacency {
        let column_of = |i: usize| i % WIDTH;
        let points: Vec<Point> = (0..WIDTH * HEIGHT)
            .map(|i| {
                let z = if column_of(i) < 60 { 1.0 } else { 1.02 };
                let grey = 80 + 40 * (column_of(i) / 30) as u8;
                Point {
                    x: (column_of(i) as f32 - 45.0) / 585.0 * z,
                    y: (i / WIDTH) as f32 / 585.0 * z,
                    z,
                    color: Rgba::opaque(grey, grey, grey),
                }
            })
            .collect();
        let cloud = OrganizedCloud::new(&points, WIDTH, HEIGHT).unwrap();
        let cluster: Vec<u32> = (0..points.len() as u32).collect();
        let mut patch = Patch::default();
        patch.copy_cluster(&cloud, &cluster);
        let table = TableReference {
            axes: AffineForm::coordinates_of(&RigidTransform::identity()),
            noise: DepthNoise::default(),
        };
        let mut graph = RegionAdjacency::default();
        graph.clear(3);
        let columns: Vec<(usize, usize)> = patch
            .pixels
            .iter()
            .enumerate()
            .map(|(i, pixel)| (pixel.index as usize, column_of(i)))
            .collect();
        for &(index, column) in &columns {
            patch.part_of[index] = number_of[column / 30];
        }
        for &(index, column) in &columns {
            let region = number_of[column / 30];
            graph.add_pixel(region, &patch.points[index]);
            graph.add_position(region, &patch.points[index], &table.axes);
            if column + 1 < WIDTH && number_of[(column + 1) / 30] != region {
                graph.add_pair([region, number_of[(column + 1) / 30]], [index, index + 1]);
            }
        }
        let bend = vec![0.0; patch.points.len()];
        graph.connect(&patch, &bend, &table);
        graph
    }

    fn feature(features: &PairFeatures, name: &str) -> f32 {
        let at = super::super::FEATURE_NAMES
            .iter()
            .position(|own| own.starts_with(name));
        features[at.unwrap()]
    }

    #[test]
    fn features_tell_a_surface_from_a_step() {
        let graph = graph([0, 1, 2]);
        assert_eq!(graph.n_edges(), 2);
        let [flat, step] = [0, 1].map(|edge| graph.features(edge));
        assert_eq!([graph.regions_of(0), graph.regions_of(1)], [[0, 1], [1, 2]]);
        for (name, expected) in [
            ("share of the boundary with unknown", [0.0, 1.0]),
            ("cosine between the normals", [1.0, 1.0]),
            ("distance of the smaller region's centroid", [0.0, 0.02]),
            ("convexity of the centroids", [0.0, 0.0]),
            ("mean depth step across", [0.0, 0.02]),
        ] {
            for (features, expected) in [flat, step].iter().zip(expected) {
                let found = feature(features, name);
                assert!((found - expected).abs() < 0.01, "{name}: {found}");
            }
        }
    }

    #[test]
    fn merged_region_has_the_features_of_all_its_pixels() {
        let mut merged = graph([0, 1, 2]);
        assert_eq!(merged.merge(0), [0, 1]);
        assert_eq!(merged.regions_of(0), [0, 2]);
        let whole = graph([0, 0, 2]).features(0);
        for (i, (a, b)) in merged.features(0).into_iter().zip(whole).enumerate() {
            assert!((a - b).abs() < 1e-3, "feature {i}: {a} {b}");
        }
    }

    #[test]
    fn merging_ends_and_joins_neighbours_only() {
        let mut joined = Vec::new();
        graph([0, 1, 2]).merge_regions(|a, b| joined.push([a, b]));
        assert!(joined.contains(&[0, 1]), "{joined:?}");
        assert!(joined.len() <= 2);
    }

    #[test]
    fn examples_follow_the_known_objects() {
        let mut pairs = Vec::new();
        let mut random = Random::from_seed(1);
        let objects = [Some(10), Some(10), Some(20)];
        graph([0, 1, 2]).list_examples(&objects, &mut random, &mut pairs);
        let truths: Vec<bool> = pairs.iter().map(|pair| pair.is_one_object).collect();
        // Both edges at first, and the remaining one after the merge of the first two.
        assert_eq!(truths, [true, false, false]);
        pairs.clear();
        graph([0, 1, 2]).list_examples(&[None, Some(10), None], &mut random, &mut pairs);
        assert!(pairs.is_empty());
    }
}
