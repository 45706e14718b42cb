//! Connected parts of the image.

mod by_tracks;
mod feet;
mod parting;

use point_cloud::{OrganizedCloud, Point};

pub(crate) use by_tracks::TrackClaims;
pub(crate) use parting::Parting;

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

impl Links {
    /// Greatest squared distance of two linked points, one of them at a depth, square
    /// metres.
    #[inline]
    fn squared_max(&self, z: f32) -> f32 {
        let distance_max = self.floor_m + self.per_m2 * z * z;
        distance_max * distance_max
    }
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
        let width = cloud.width();
        let (mut row, mut row_start) = (0, 0);
        for i in 0..self.ungrouped.len() {
            let pixel = self.ungrouped[i] as usize;
            while pixel >= row_start + width {
                row_start += width;
                row += 1;
            }
            self.link_pixel(links, cloud, [pixel - row_start, row]);
        }
        self.number_large(n_min);
        self.group();
    }

    /// Gives a pixel the label of the neighbours before it that are near in
    /// space, or a new one.
    #[inline]
    fn link_pixel(&mut self, links: &Links, cloud: &OrganizedCloud<'_>, [column, row]: [usize; 2]) {
        let (points, width) = (cloud.points(), cloud.width());
        let Self {
            cluster_of,
            parents,
            ..
        } = self;
        let pixel = row * width + column;
        let near = Near {
            points,
            cluster_of,
            point: points[pixel],
            squared_max: links.squared_max(points[pixel].z),
        };
        let left = near.first_label(pixel, 1, links.reach_px.min(column));
        let above = near.first_label(pixel, width, links.reach_px.min(row));
        let mut own = joined(parents, left, above);
        let on_left = (row > 0 && column > 0).then(|| pixel - width - 1);
        let on_right = (row > 0 && column + 1 < width).then(|| pixel - width + 1);
        for diagonal in [on_left, on_right].into_iter().flatten() {
            // Mostly it has the same label already, and no distance is needed.
            if cluster_of[diagonal] != own {
                own = joined(parents, own, near.label(diagonal));
            }
        }
        if own == OUTSIDE {
            own = parents.len() as u32;
            parents.push(own);
        }
        cluster_of[pixel] = own;
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

/// What is asked about the neighbours of a point.
struct Near<'a> {
    points: &'a [Point],
    cluster_of: &'a [u32],
    point: Point,
    squared_max: f32,
}

impl Near<'_> {
    /// The label of a neighbour that is linked; [`OUTSIDE`] for others.
    #[inline]
    fn label(&self, neighbour: usize) -> u32 {
        let label = self.cluster_of[neighbour];
        let squared_distance = squared_distance(&self.point, &self.points[neighbour]);
        if label != OUTSIDE && squared_distance <= self.squared_max {
            label
        } else {
            OUTSIDE
        }
    }

    /// The label of the first linked one of `n` neighbours, each `step` before the
    /// last.
    #[inline]
    fn first_label(&self, mut pixel: usize, step: usize, n: usize) -> u32 {
        for _ in 0..n {
            pixel -= step;
            let label = self.label(pixel);
            if label != OUTSIDE {
                return label;
            }
        }
        OUTSIDE
    }
}

/// Squared distance of two points, square metres.
#[inline]
fn squared_distance(a: &Point, b: &Point) -> f32 {
    let (dx, dy, dz) = (a.x - b.x, a.y - b.y, a.z - b.z);
    dx * dx + dy * dy + dz * dz
}

/// Joins the clusters of two labels, either of which may be none.
#[inline]
fn joined(parents: &mut [u32], a: u32, b: u32) -> u32 {
    if a == OUTSIDE || a == b {
        b
    } else if b == OUTSIDE {
        a
    } else {
        unite(parents, a, b)
    }
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
