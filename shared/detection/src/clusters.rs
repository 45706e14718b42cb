//! Connected parts of the image.

use crate::borders::Borders;
use crate::prism::{OUTSIDE, OVER_TABLE};
use point_cloud::{OrganizedCloud, Point};

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
const LINKS: Links = Links { floor_m: 0.004, per_m2: 0.0055, reach_px: 3 };

/// Links between creases: narrow, since what they cut off is given back later.
const CLOSE_LINKS: Links = Links { floor_m: 0.002, per_m2: 0.003, reach_px: 1 };

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
    borders: Borders,
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
        self.join_with(&LINKS, cloud, n_min);
    }

    fn join_with(&mut self, links: &Links, cloud: &OrganizedCloud<'_>, n_min: u32) {
        self.link_neighbours(links, cloud);
        self.number_large(n_min);
        self.group();
    }

    /// Splits clusters along creases: joins what lies between creases, keeps
    /// parts of at least `n_min` pixels, and gives every other pixel of a
    /// cluster to the part that reaches it first. A cluster without such a
    /// part stays whole.
    pub(crate) fn split(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        whole: &Self,
        is_crease: &[bool],
        n_min: u32,
    ) {
        self.cluster_of.clear();
        self.cluster_of.extend(whole.cluster_of.iter().zip(is_crease).map(|(&cluster, &crease)| {
            if cluster == OUTSIDE || crease { OUTSIDE } else { OVER_TABLE }
        }));
        self.join_with(&CLOSE_LINKS, cloud, n_min);
        self.grow_within(whole, cloud.width());
        self.join_over_smooth_borders(cloud, whole, is_crease);
        self.number_large(1);
        self.group();
    }

    /// Undoes what was split without a crease.
    fn join_over_smooth_borders(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        whole: &Self,
        is_crease: &[bool],
    ) {
        let width = cloud.width();
        self.borders.clear();
        for pixel in 0..self.cluster_of.len() {
            let part = self.cluster_of[pixel];
            if part == OUTSIDE {
                continue;
            }
            for near in [pixel + 1, pixel + width] {
                let meet = self.cluster_of.get(near).is_some_and(|&other| other != part)
                    && whole.cluster_of[near] == whole.cluster_of[pixel];
                if meet {
                    let points = [&cloud.points()[pixel], &cloud.points()[near]];
                    let crease = is_crease[pixel] || is_crease[near];
                    self.borders.add([part, self.cluster_of[near]], points, crease);
                }
            }
        }
        let n_parts = self.cluster_of.iter().filter(|&&part| part != OUTSIDE).max();
        self.parents.clear();
        self.parents.extend(0..n_parts.map_or(0, |&last| last + 1));
        let Self { borders, parents, .. } = self;
        borders.join_smooth(|a, b| {
            unite(parents, a, b);
        });
    }

    /// Lets the clusters grow, pixel by pixel, within those of `whole`.
    fn grow_within(&mut self, whole: &Self, width: usize) {
        let n_parts = self.len() as u32;
        let mut next = 0;
        // The grouped pixels are the front to start from; what is reached is appended.
        while next < self.pixels.len() {
            let pixel = self.pixels[next] as usize;
            next += 1;
            for step in [-1, 1, -(width as isize), width as isize, -2, 2, -2 * width as isize, 2 * width as isize] {
                let Some(near) = pixel.checked_add_signed(step) else { continue };
                let same = whole.cluster_of.get(near) == Some(&whole.cluster_of[pixel]);
                if same && self.cluster_of[near] == OUTSIDE {
                    self.cluster_of[near] = self.cluster_of[pixel];
                    self.pixels.push(near as u32);
                }
            }
        }
        for (part, &cluster) in self.cluster_of.iter_mut().zip(&whole.cluster_of) {
            if *part == OUTSIDE && cluster != OUTSIDE {
                *part = n_parts + cluster;
            }
        }
    }

    fn link_neighbours(&mut self, links: &Links, cloud: &OrganizedCloud<'_>) {
        self.parents.clear();
        let width = cloud.width();
        for row in 0..cloud.height() {
            for column in 0..width {
                let pixel = row * width + column;
                if self.cluster_of[pixel] == OVER_TABLE {
                    self.link_pixel(links, cloud.points(), (width, column), pixel);
                }
            }
        }
    }

    /// Gives a pixel the cluster of the neighbours before it that are near in
    /// space, or a new one.
    #[inline]
    fn link_pixel(
        &mut self,
        links: &Links,
        points: &[Point],
        (width, column): (usize, usize),
        pixel: usize,
    ) {
        let point = &points[pixel];
        let distance_max = links.floor_m + links.per_m2 * point.z * point.z;
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
        for step in 1..=links.reach_px.min(column) {
            if visit(pixel - step) {
                break;
            }
        }
        for step in 1..=links.reach_px.min(pixel / width) {
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
