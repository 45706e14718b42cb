//! Connected parts of the image.

mod by_tracks;
mod feet;
mod parting;

use crate::borders::Borders;
use point_cloud::{OrganizedCloud, Point};

pub(crate) use by_tracks::TrackClaims;

/// Mark of a pixel that is in no cluster.
pub(crate) const OUTSIDE: u32 = u32::MAX;

/// When two pixels belong together.
#[derive(Debug, Clone, Copy)]
struct Links {
    /// Points this near are one surface at any depth, metres.
    floor_m: f32,
    /// Growth of the distance with squared depth, 1/metre. A step of a Kinect
    /// v1's disparity is 2.8 mm at 1 m.
    per_m2: f32,
    /// How many pixels a link may span: holes of the sensor are bridged, the
    /// distance in space stays the judge.
    reach_px: usize,
}

/// Links of a cluster.
const LINKS: Links = Links {
    floor_m: 0.004,
    per_m2: 0.0055,
    reach_px: 3,
};

/// Buffers, and the clusters found last.
#[derive(Debug, Default)]
pub(crate) struct Clusters {
    /// Per pixel: [`OUTSIDE`] or the number of its cluster.
    pub(crate) cluster_of: Vec<u32>,
    /// Per label: the label it was joined with; a root is its own parent.
    parents: Vec<u32>,
    /// Per label: its number of pixels, then the number of its cluster.
    number_of: Vec<u32>,
    /// Where each cluster's pixels begin in `pixels`, with one more at the end.
    starts: Vec<u32>,
    /// Pixels grouped by cluster.
    pixels: Vec<u32>,
    ungrouped: Vec<u32>,
    borders: Borders,
    /// Pixels from which parts grow.
    front: Vec<u32>,
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

    /// Joins pixels, given in image order, to clusters of neighbours near in
    /// space; those with fewer than `n_min` pixels are left out.
    ///
    /// Union-find in one pass over the pixels (after Wu, Otoo and Suzuki 2009).
    pub(crate) fn join(&mut self, cloud: &OrganizedCloud<'_>, pixels: &[u32], n_min: u32) {
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(pixels);
        self.join_ungrouped(&LINKS, cloud, n_min);
    }

    fn join_ungrouped(&mut self, links: &Links, cloud: &OrganizedCloud<'_>, n_min: u32) {
        self.cluster_of.clear();
        self.cluster_of.resize(cloud.points().len(), OUTSIDE);
        self.parents.clear();
        for i in 0..self.ungrouped.len() {
            self.link_pixel(links, cloud, self.ungrouped[i] as usize);
        }
        self.number_large(n_min);
        self.group();
    }

    /// Gives a pixel the label of the neighbours before it that are near in
    /// space, or a new one.
    #[inline]
    fn link_pixel(&mut self, links: &Links, cloud: &OrganizedCloud<'_>, pixel: usize) {
        let (points, width) = (cloud.points(), cloud.width());
        let column = pixel % width;
        let point = &points[pixel];
        let distance_max = links.floor_m + links.per_m2 * point.z * point.z;
        let squared_max = distance_max * distance_max;
        let mut own = OUTSIDE;
        let mut visit = |neighbour: usize, own: &mut u32| {
            let other = self.cluster_of[neighbour];
            let linked =
                other != OUTSIDE && squared_distance(point, &points[neighbour]) <= squared_max;
            if linked && *own == OUTSIDE {
                *own = other;
            } else if linked && *own != other {
                *own = unite(&mut self.parents, *own, other);
            }
            linked
        };
        let _ = (1..=links.reach_px.min(column)).any(|step| visit(pixel - step, &mut own));
        let n_above = links.reach_px.min(pixel / width);
        let _ = (1..=n_above).any(|step| visit(pixel - step * width, &mut own));
        let on_left = (n_above > 0 && column > 0).then(|| pixel - width - 1);
        let on_right = (n_above > 0 && column + 1 < width).then(|| pixel - width + 1);
        for diagonal in [on_left, on_right].into_iter().flatten() {
            // Mostly it has the same label already, and no distance is needed.
            if self.cluster_of[diagonal] != own {
                visit(diagonal, &mut own);
            }
        }
        if own == OUTSIDE {
            own = self.parents.len() as u32;
            self.parents.push(own);
        }
        self.cluster_of[pixel] = own;
    }

    /// Numbers the clusters that are large enough, and counts their pixels.
    fn number_large(&mut self, n_min: u32) {
        for i in 0..self.parents.len() {
            // A root is its own parent and comes before its members.
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
                *n = OUTSIDE;
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

    /// Sorts the pixels by the cluster that `parents` now holds for each label.
    fn group(&mut self) {
        let n_pixels = self.starts.last().copied().unwrap_or(0) as usize;
        self.pixels.clear();
        self.pixels.resize(n_pixels, 0);
        // `number_of` has done its work and serves as each cluster's next place.
        self.number_of.clear();
        self.number_of.extend_from_slice(&self.starts);
        for &pixel in &self.ungrouped {
            let label = &mut self.cluster_of[pixel as usize];
            *label = self.parents[*label as usize];
            if *label != OUTSIDE {
                let place = &mut self.number_of[*label as usize];
                self.pixels[*place as usize] = pixel;
                *place += 1;
            }
        }
    }
}

/// Squared distance of two points, square metres.
#[inline]
fn squared_distance(a: &Point, b: &Point) -> f32 {
    let (dx, dy, dz) = (a.x - b.x, a.y - b.y, a.z - b.z);
    dx * dx + dy * dy + dz * dz
}

/// Joins two clusters under the one that began first; returns its root.
#[inline]
fn unite(parents: &mut [u32], a: u32, b: u32) -> u32 {
    let (a, b) = (root(parents, a), root(parents, b));
    let (first, second) = (a.min(b), a.max(b));
    parents[second as usize] = first;
    first
}

/// The root of a cluster, with path halving.
#[inline]
pub(crate) fn root(parents: &mut [u32], mut cluster: u32) -> u32 {
    while parents[cluster as usize] != cluster {
        parents[cluster as usize] = parents[parents[cluster as usize] as usize];
        cluster = parents[cluster as usize];
    }
    cluster
}

#[cfg(test)]
mod tests;
