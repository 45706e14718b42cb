//! Undivided clusters: those whose regions are all one object, but for pieces that are too small
//! for a region of their own.

use super::watershed::WatershedRegion;
use crate::clusters::NO_CLUSTER;
use union_find::{find_root, union};

/// Object of each cluster that is not divided. Reused from frame to frame.
#[derive(Debug, Default)]
pub(super) struct UndividedClusters {
    objects: Vec<Objects>,
    /// Per root of regions: their cluster, or [`NO_CLUSTER`] for several.
    cluster_of_root: Vec<u32>,
}

/// Objects of which a cluster has regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Objects {
    None,
    /// The only one, by the root of its regions.
    One(u32),
    Several,
}

impl UndividedClusters {
    /// Find the undivided ones of `n_clusters` clusters, and unite each with its small pieces. A
    /// piece has fewer than `n_pixels_min` pixels and was merged with no other cluster; an oblique
    /// strip that is narrower than a cell falls into such pieces. `parents` is the union-find
    /// forest of the regions.
    pub(super) fn unite_pieces(
        &mut self,
        n_clusters: usize,
        (regions, n_pixels_min): (&[WatershedRegion], u32),
        parents: &mut [u32],
    ) {
        self.objects.clear();
        self.objects.resize(n_clusters, Objects::None);
        self.cluster_of_root.clear();
        let clusters = regions.iter().map(|region| region.cluster);
        self.cluster_of_root.extend(clusters);
        for (number, region) in (0..).zip(regions) {
            let root = find_root(parents, number);
            if region.cluster != self.cluster_of_root[root as usize] {
                self.cluster_of_root[root as usize] = NO_CLUSTER;
            }
            if region.n_pixels >= n_pixels_min {
                let objects = &mut self.objects[region.cluster as usize];
                *objects = match *objects {
                    Objects::None => Objects::One(root),
                    Objects::One(other) if other == root => Objects::One(root),
                    _ => Objects::Several,
                };
            }
        }
        for (number, region) in (0..).zip(regions) {
            if region.n_pixels < n_pixels_min
                && self.cluster_of_root[find_root(parents, number) as usize] == region.cluster
                && let Some(object) = self.object(region.cluster)
            {
                union(parents, number, object);
            }
        }
    }

    /// Region of the only object of a cluster; `None` when the cluster is divided or has no
    /// region but pieces.
    pub(super) fn object(&self, cluster: u32) -> Option<u32> {
        match self.objects[cluster as usize] {
            Objects::One(region) => Some(region),
            Objects::None | Objects::Several => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_join_the_only_object_of_their_cluster() {
        let region = |cluster: u32, n_pixels: u32| WatershedRegion { cluster, n_pixels };
        // Cluster 0: two large regions that were merged, and a piece; cluster 1: two large regions
        // and a piece; cluster 2: pieces only; cluster 3: a large region, and two pieces that were
        // merged; cluster 4: a large region, and a piece that was merged with one of cluster 2.
        let regions = [
            region(0, 20),
            region(0, 3),
            region(0, 50),
            region(1, 40),
            region(1, 40),
            region(1, 1),
            region(2, 5),
            region(2, 5),
            region(3, 50),
            region(3, 4),
            region(3, 4),
            region(4, 50),
            region(4, 2),
        ];
        let mut parents: Vec<u32> = (0..13).collect();
        union(&mut parents, 0, 2);
        union(&mut parents, 9, 10);
        union(&mut parents, 7, 12);
        let mut clusters = UndividedClusters::default();
        clusters.unite_pieces(5, (&regions, 20), &mut parents);
        let roots: Vec<u32> = (0..13).map(|r| find_root(&mut parents, r)).collect();
        assert_eq!(roots, [0, 0, 0, 3, 4, 5, 6, 7, 8, 8, 8, 11, 7]);
        let objects = [0, 1, 2, 3].map(|cluster| clusters.object(cluster));
        assert_eq!(objects, [Some(0), None, None, Some(8)]);
    }
}
