//! Image-space clusters: connected components of the pixels above the table.

mod connected_components;
mod support_plane_growth;
mod track_regrouping;

use point_cloud::Point;

use connected_components::Band;

pub(crate) use track_regrouping::{BODY_REACH_M, OBJECT_REACH_M, TrackClaims};

/// Label of a pixel outside of all clusters.
pub(crate) const NO_CLUSTER: u32 = u32::MAX;

/// Link rule: distance up to which two neighbouring pixels are connected.
#[derive(Debug, Clone, Copy)]
struct LinkDistance {
    /// Link distance at zero depth, metres. Chosen.
    floor_m: f32,
    /// Growth of the link distance with squared depth, 1/metre; one disparity step of a
    /// Kinect v1 is 2.8 mm at 1 m. Chosen.
    per_m2: f32,
    /// Greatest span of a link in the image, pixels. Bridges sensor holes; the distance in
    /// space must still fit. Chosen.
    reach_px: usize,
}

impl LinkDistance {
    /// Squared link distance at a depth, square metres.
    #[inline]
    fn squared_max(&self, z: f32) -> f32 {
        let distance_max = self.floor_m + self.per_m2 * z * z;
        distance_max * distance_max
    }
}

/// Link distance of the clustering.
const LINKS: LinkDistance = LinkDistance {
    floor_m: 0.004,
    per_m2: 0.0055,
    reach_px: 3,
};

/// Pixel of a cluster.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClusteredPixel {
    /// Index in the image.
    pub(crate) index: usize,
    pub(crate) column: usize,
    pub(crate) row: usize,
    /// Cluster of the pixel.
    pub(crate) cluster: u32,
}

/// Pixel clusters found last, with buffers.
#[derive(Debug, Default)]
pub(crate) struct Clusters {
    /// Per pixel: [`NO_CLUSTER`] or the number of its cluster, for exactly those of `pixels`.
    pub(crate) cluster_of: Vec<u32>,
    bands: Vec<Band>,
    /// Union-find forest, per label: the parent label; a root is its own parent.
    parents: Vec<u32>,
    /// Per label: its number of pixels, then the number of its cluster.
    number_of: Vec<u32>,
    /// Start of each cluster in `pixels`, with one more entry at the end.
    starts: Vec<u32>,
    /// Pixel indices sorted by cluster, those of a cluster in image order.
    pixels: Vec<u32>,
    /// All labelled pixels in image order, with those of dropped small components.
    ungrouped: Vec<u32>,
    /// Pixels added to one cluster by growth towards the support plane.
    front: Vec<u32>,
    /// Pixel indices sorted by cluster with the added ones.
    grown: Vec<u32>,
}

impl Clusters {
    /// Number of clusters.
    pub(crate) fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Pixels of a cluster in image order.
    pub(crate) fn pixels(&self, cluster: usize) -> &[u32] {
        &self.pixels[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }

    /// All labelled pixels in image order, with those of dropped small components.
    pub(crate) fn labelled(&self) -> &[u32] {
        &self.ungrouped
    }

    /// Labelled pixels of each row of an image of `width` columns that has any: the row and its
    /// pixels.
    pub(crate) fn pixel_rows(&self, width: usize) -> impl Iterator<Item = (usize, &[u32])> {
        pixel_rows(&self.ungrouped, width)
    }

    /// Give each clustered pixel of an image of `width` columns one of `n` new clusters, or
    /// [`NO_CLUSTER`].
    pub(crate) fn relabel(
        &mut self,
        width: usize,
        n: usize,
        cluster_of: impl Fn(ClusteredPixel) -> u32,
    ) {
        for (row, pixels) in pixel_rows(&self.ungrouped, width) {
            for &pixel in pixels {
                let index = pixel as usize;
                let cluster = self.cluster_of[index];
                if cluster != NO_CLUSTER {
                    self.cluster_of[index] = cluster_of(ClusteredPixel {
                        index,
                        column: index - row * width,
                        row,
                        cluster,
                    });
                }
            }
        }
        self.rebuild_groups(n);
    }

    /// Number the components with at least `n_min` pixels and count their pixels.
    fn number_large_components(&mut self, n_min: u32) {
        for i in 0..self.parents.len() {
            // A root is its own parent and precedes its members.
            self.parents[i] = self.parents[self.parents[i] as usize];
        }
        self.number_of.clear();
        self.number_of.resize(self.parents.len(), 0);
        for &pixel in &self.ungrouped {
            self.number_of[self.parents[self.cluster_of[pixel as usize] as usize] as usize] += 1;
        }
        self.starts.clear();
        self.starts.push(0);
        let mut n_pixels = 0;
        for n in &mut self.number_of {
            if *n < n_min.max(1) {
                *n = NO_CLUSTER;
            } else {
                n_pixels += *n;
                *n = self.starts.len() as u32 - 1;
                self.starts.push(n_pixels);
            }
        }
        for i in 0..self.parents.len() {
            self.parents[i] = self.number_of[self.parents[i] as usize];
        }
    }

    /// Counting sort of the pixels by the cluster that `parents` holds for each label.
    fn sort_by_cluster(&mut self) {
        let n_pixels = self.starts.last().copied().unwrap_or(0) as usize;
        self.pixels.clear();
        self.pixels.resize(n_pixels, 0);
        // Reuse `number_of` as the write position of each cluster.
        self.number_of.clear();
        self.number_of.extend_from_slice(&self.starts);
        for &pixel in &self.ungrouped {
            let label = &mut self.cluster_of[pixel as usize];
            *label = self.parents[*label as usize];
            if *label != NO_CLUSTER {
                let place = &mut self.number_of[*label as usize];
                self.pixels[*place as usize] = pixel;
                *place += 1;
            }
        }
    }
}

/// Runs of the pixels of one image row each, of pixels in image order: the row and its pixels.
fn pixel_rows(mut pixels: &[u32], width: usize) -> impl Iterator<Item = (usize, &[u32])> {
    std::iter::from_fn(move || {
        let row = *pixels.first()? as usize / width;
        let end = (row + 1) * width;
        let n_own = pixels.partition_point(|&pixel| (pixel as usize) < end);
        let (own, rest) = pixels.split_at(n_own);
        pixels = rest;
        Some((row, own))
    })
}

/// Squared distance of two points, square metres.
#[inline]
fn squared_distance(a: &Point, b: &Point) -> f32 {
    let (dx, dy, dz) = (a.x - b.x, a.y - b.y, a.z - b.z);
    dx * dx + dy * dy + dz * dz
}

#[cfg(test)]
mod tests;
