//! Connected parts of the image.

use crate::prism::{OUTSIDE, OVER_TABLE};
use point_cloud::{OrganizedCloud, Point};

/// Points this near are one surface at any depth, metres.
const LINK_FLOOR_M: f32 = 0.004;

/// Growth of the distance with squared depth, 1/metre: three steps of a Kinect
/// v1's disparity, which is 2.8 mm at 1 m.
const LINK_PER_M2: f32 = 0.0055;

/// How many pixels a link may span: holes of the sensor are bridged, the
/// distance in space stays the judge.
const REACH_PX: usize = 3;

/// Buffers, and the clusters found last.
#[derive(Debug, Default)]
pub(crate) struct Clusters {
    /// Per pixel: [`OUTSIDE`] or the number of its cluster.
    pub(crate) cluster_of: Vec<u32>,
    parents: Vec<u32>,
    number_of: Vec<u32>,
    /// Where each cluster's pixels begin in `pixels`, with one more at the end.
    starts: Vec<u32>,
    /// Pixels grouped by cluster, in image order within each.
    pixels: Vec<u32>,
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

    /// Joins the pixels that `cluster_of` marks as [`OVER_TABLE`] to clusters
    /// of neighbours near in space, numbered by their first pixel; those with
    /// fewer than `n_min` pixels are marked [`OUTSIDE`].
    ///
    /// Union-find in one pass over the image (after Wu, Otoo and Suzuki 2009).
    pub(crate) fn join(&mut self, cloud: &OrganizedCloud<'_>, n_min: u32) {
        self.link_neighbours(cloud);
        self.number_large(n_min);
        self.group();
    }

    fn link_neighbours(&mut self, cloud: &OrganizedCloud<'_>) {
        self.parents.clear();
        let width = cloud.width();
        for row in 0..cloud.height() {
            for column in 0..width {
                let pixel = row * width + column;
                if self.cluster_of[pixel] == OVER_TABLE {
                    self.link_pixel(cloud.points(), width, column, pixel);
                }
            }
        }
    }

    /// Gives a pixel the cluster of the neighbours before it that are near in
    /// space, or a new one.
    #[inline]
    fn link_pixel(&mut self, points: &[Point], width: usize, column: usize, pixel: usize) {
        let point = &points[pixel];
        let distance_max = LINK_FLOOR_M + LINK_PER_M2 * point.z * point.z;
        let squared_max = distance_max * distance_max;
        let mut own = OUTSIDE;
        let mut visit = |neighbour: usize| {
            let linked = self.cluster_of[neighbour] != OUTSIDE
                && squared_distance(point, &points[neighbour]) <= squared_max;
            if linked {
                let other = self.cluster_of[neighbour];
                own = if own == OUTSIDE || own == other {
                    other
                } else {
                    unite(&mut self.parents, own, other)
                };
            }
            linked
        };
        for step in 1..=REACH_PX.min(column) {
            if visit(pixel - step) {
                break;
            }
        }
        for step in 1..=REACH_PX.min(pixel / width) {
            if visit(pixel - step * width) {
                break;
            }
        }
        if pixel >= width {
            if column > 0 {
                visit(pixel - width - 1);
            }
            if column + 1 < width {
                visit(pixel - width + 1);
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
        for label in &mut self.cluster_of {
            if *label != OUTSIDE {
                *label = self.parents[*label as usize];
                self.number_of[*label as usize] += 1;
            }
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
    }

    /// Sorts the pixels by cluster.
    fn group(&mut self) {
        let n_pixels = self.starts.last().copied().unwrap_or(0) as usize;
        self.pixels.clear();
        self.pixels.resize(n_pixels, 0);
        // `parents` has done its work and serves as each cluster's next place.
        self.parents.clear();
        self.parents.extend_from_slice(&self.starts);
        for (pixel, label) in self.cluster_of.iter_mut().enumerate() {
            if *label != OUTSIDE {
                *label = self.number_of[*label as usize];
                if *label != OUTSIDE {
                    let place = &mut self.parents[*label as usize];
                    self.pixels[*place as usize] = pixel as u32;
                    *place += 1;
                }
            }
        }
    }
}

#[inline]
pub(crate) fn squared_distance(a: &Point, b: &Point) -> f32 {
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
fn root(parents: &mut [u32], mut cluster: u32) -> u32 {
    while parents[cluster as usize] != cluster {
        parents[cluster as usize] = parents[parents[cluster as usize] as usize];
        cluster = parents[cluster as usize];
    }
    cluster
}
