//! Segmentation: splits the clusters above the table into objects, and joins the parts of an
//! object that are several clusters.
//!
//! The clusters are copied into an image of cells. A small network rates the edge between each
//! two neighbouring cells as a boundary of objects; a watershed over these edges gives regions;
//! and adjacent regions are merged while trained trees find them to be one object.

mod amodal_completion;
mod bends;
mod cell_image;
mod edge_features;
mod edge_image;
mod edge_network;
mod pixel_labels;
mod region_claims;
#[allow(
    clippy::approx_constant,
    reason = "trained numbers, near a constant by chance"
)]
mod trained_network;
mod training;
mod undivided_clusters;
mod watershed;

use crate::clusters::{Clusters, NO_CLUSTER};
use crate::input::ExpectedTrack;
use crate::parallelism::Parallelism;
use crate::region_merging::RegionAdjacency;
use crate::split_gate::may_be_several_objects;
use crate::table_reference::TableReference;
use amodal_completion::{AmodalCompletion, RegionImage};
use cell_image::MARGIN;
use pixel_labels::CellLabels;
use point_cloud::OrganizedCloud;
use region_claims::RegionClaims;
use undivided_clusters::UndividedClusters;
use union_find::{find_root, union};
use watershed::{CELLS_MIN, Watershed};

pub(crate) use bends::Bends;
pub(crate) use cell_image::{Cell, CellImage, NO_CELL};
pub use edge_features::{EDGE_FEATURE_NAMES, EdgeFeatures, N_EDGE_FEATURES};
pub(crate) use edge_image::{EdgeImage, NO_EDGE, log_odds_of};
pub(crate) use region_claims::NO_TRACK;
pub use training::{EdgeExample, SegmentationExamples};

/// Greatest number of cells without depth between adjacent regions. Chosen.
const GAP_CELLS: usize = 3;

/// Image whose clusters are segmented.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SegmentationInput<'a> {
    pub(crate) cloud: OrganizedCloud<'a>,
    pub(crate) table: TableReference,
    /// Tangent of the angle between neighbouring pixels.
    pub(crate) pixel_pitch: f32,
    /// Live tracks: regions that one track claims are rather one object, those that two tracks
    /// claim rather two.
    pub(crate) tracks: &'a [ExpectedTrack],
    /// `true` to make one object of its parts that are several clusters, such as the inside and
    /// the outside of a bowl.
    pub(crate) joins_clusters: bool,
}

/// Segmentation of the clusters of an image. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Segmentation {
    image: CellImage,
    bends: Bends,
    edges: EdgeImage,
    /// Per cluster: `true` when it is too small for several objects.
    is_whole: Vec<bool>,
    watershed: Watershed,
    adjacency: RegionAdjacency,
    region_claims: RegionClaims,
    /// Union-find forest of the regions.
    parents: Vec<u32>,
    /// Per region: the new cluster.
    cluster_of: Vec<u32>,
    amodal_completion: AmodalCompletion,
    undivided: UndividedClusters,
    labels: CellLabels,
}

impl Segmentation {
    /// Split and join clusters, so that each is one object.
    pub(crate) fn segment(
        &mut self,
        input: &SegmentationInput<'_>,
        clusters: &mut Clusters,
        parallelism: &dyn Parallelism,
    ) {
        if clusters.len() > 0 {
            self.find_regions(input, clusters, parallelism);
            self.claim_regions(input);
            self.merge_regions(input);
            self.unite_pieces(clusters.len());
            let n_clusters = self.number_clusters(clusters.len());
            self.labels
                .relabel(clusters, n_clusters, &input.cloud, &self.image);
        }
    }

    /// Over-segmentation of the clusters into regions, with their adjacency.
    fn find_regions(
        &mut self,
        input: &SegmentationInput<'_>,
        clusters: &Clusters,
        parallelism: &dyn Parallelism,
    ) {
        let SegmentationInput { cloud, table, .. } = input;
        let is_whole = (0..clusters.len()).map(|cluster| {
            let pixels = clusters.pixels(cluster);
            !may_be_several_objects(cloud.points(), pixels, &table.axes)
        });
        self.is_whole.clear();
        self.is_whole.extend(is_whole);
        self.image.refill(cloud, clusters);
        let pitch = self.image.pitch(input.pixel_pitch);
        self.bends.refill(&self.image, pitch, &table.noise);
        self.edges.refill(
            (&self.image, &self.is_whole),
            &self.bends,
            pitch,
            table.noise,
            parallelism,
        );
        self.watershed
            .refill(&self.image, &self.edges, &self.is_whole);
        self.connect_regions(cloud, table);
    }

    /// Region adjacency graph: regions are adjacent when their cells are neighbours, or separated
    /// by a narrow gap without depth.
    fn connect_regions(&mut self, cloud: &OrganizedCloud<'_>, table: &TableReference) {
        let Self {
            image,
            bends,
            edges,
            watershed,
            adjacency,
            ..
        } = self;
        let regions = &watershed.region_of;
        adjacency.clear(watershed.regions.len());
        for (cell, &region) in image.cells.iter().zip(regions) {
            let point = &cloud.points()[cell.pixel as usize];
            adjacency.add_cell(region, cell, point, table);
        }
        for (number, cell) in (0..).zip(&image.cells) {
            let place = cell.place as usize;
            for (strengths, step) in edges.to_next.iter().zip([1, image.width]) {
                let beyond_gap = |place: &usize| {
                    image.number_of[*place] != NO_CELL || has_depth(cloud, image, *place)
                };
                let mut next = (place + step..).step_by(step).take(GAP_CELLS + 1);
                let other = next.find(beyond_gap).map(|place| image.number_of[place]);
                if let Some(other) = other.filter(|&other| other != NO_CELL)
                    && regions[other as usize] != regions[number as usize]
                {
                    adjacency.add_pair([number, other], regions, strengths[place]);
                }
            }
        }
        adjacency.connect(image, bends, regions, table);
    }

    /// Tell the region graph which track claims each region.
    fn claim_regions(&mut self, input: &SegmentationInput<'_>) {
        let claims = self.region_claims.find(
            &input.cloud,
            &self.image.cells,
            &self.watershed,
            input.tracks,
        );
        self.adjacency.claim(claims);
    }

    fn merge_regions(&mut self, input: &SegmentationInput<'_>) {
        let parents = &mut self.parents;
        parents.clear();
        parents.extend(0..self.watershed.regions.len() as u32);
        self.adjacency.merge_regions(input.joins_clusters, |a, b| {
            union(parents, a, b);
        });
        if input.joins_clusters {
            let image = RegionImage {
                cloud: &input.cloud,
                cells: &self.image,
                region_of: &self.watershed.region_of,
                noise: &input.table.noise,
            };
            self.amodal_completion
                .unite_parts(&image, &self.adjacency, parents);
        }
    }

    fn unite_pieces(&mut self, n_clusters: usize) {
        let n_pixels_min = CELLS_MIN * (self.image.stride_px * self.image.stride_px) as u32;
        let regions = (&self.watershed.regions[..], n_pixels_min);
        self.undivided
            .unite_pieces(n_clusters, regions, &mut self.parents);
    }

    /// Number the merged regions, give each cell and undivided cluster its number, and return how
    /// many there are.
    fn number_clusters(&mut self, n_before: usize) -> usize {
        let mut n_clusters = 0;
        self.cluster_of.clear();
        for region in 0..self.parents.len() {
            // A root precedes the regions that were merged into it.
            let root = find_root(&mut self.parents, region as u32) as usize;
            let cluster = if root == region {
                n_clusters += 1;
                n_clusters - 1
            } else {
                self.cluster_of[root]
            };
            self.cluster_of.push(cluster);
        }
        let of_cells = self.watershed.region_of.iter();
        self.labels.of_cell.clear();
        self.labels
            .of_cell
            .extend(of_cells.map(|&region| self.cluster_of[region as usize]));
        let of_clusters = (0..n_before as u32).map(|cluster| {
            let region = self.undivided.object(cluster);
            region.map_or(NO_CLUSTER, |region| self.cluster_of[region as usize])
        });
        self.labels.of_cluster.clear();
        self.labels.of_cluster.extend(of_clusters);
        n_clusters as usize
    }
}

/// `true` when the first pixel of a place has depth; `false` beyond the border of the image.
fn has_depth(cloud: &OrganizedCloud<'_>, image: &CellImage, place: usize) -> bool {
    let margins = MARGIN..image.width - MARGIN;
    if !margins.contains(&(place % image.width)) || place / image.width < MARGIN {
        return false;
    }
    let [column, row] = image.first_pixel(place);
    let point = cloud.points().get(row * cloud.width() + column);
    point.is_some_and(|point| point.z > 0.0)
}

#[cfg(test)]
mod tests;
