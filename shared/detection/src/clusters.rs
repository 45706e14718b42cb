//! Connected parts of the image.

use crate::borders::Borders;
use crate::creases::Creases;
use point_cloud::{OrganizedCloud, Point};

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

/// Links between creases: narrow, since what they cut off is given back later.
const CLOSE_LINKS: Links = Links {
    floor_m: 0.002,
    per_m2: 0.003,
    reach_px: 1,
};

/// Columns and rows by which a part grows; across a hole of one pixel too.
const GROWTH: [(isize, isize); 8] = [
    (-1, 0),
    (1, 0),
    (0, -1),
    (0, 1),
    (-2, 0),
    (2, 0),
    (0, -2),
    (0, 2),
];

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

    /// Takes clusters over from `whole`, splitting those that have creases:
    /// joins what lies between creases, keeps parts of at least `n_min`
    /// pixels, gives every other pixel of a cluster to the part that reaches
    /// it first, and joins parts again whose border is no crease.
    pub(crate) fn split(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        whole: &Self,
        creases: &Creases,
        n_min: u32,
    ) {
        self.ungrouped.clear();
        let split = || (0..whole.len()).filter(|&cluster| creases.may_part[cluster]);
        for cluster in split() {
            let pixels = whole.pixels(cluster).iter().copied();
            self.ungrouped
                .extend(pixels.filter(|&pixel| !creases.is_crease[pixel as usize]));
        }
        self.join_ungrouped(&CLOSE_LINKS, cloud, n_min);
        self.grow_within(whole, cloud.width());
        self.parents.clear();
        self.parents.extend(0..(self.len() + whole.len()) as u32);
        for cluster in split() {
            self.find_borders(cloud, whole, whole.pixels(cluster), &creases.is_crease);
        }
        self.join_over_smooth_borders();
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(&whole.pixels);
        self.number_large(1);
        self.group();
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
        let mut visit = |neighbour: usize| {
            let other = self.cluster_of[neighbour];
            let linked =
                other != OUTSIDE && squared_distance(point, &points[neighbour]) <= squared_max;
            if linked && own == OUTSIDE {
                own = other;
            } else if linked && own != other {
                own = unite(&mut self.parents, own, other);
            }
            linked
        };
        let _ = (1..=links.reach_px.min(column)).any(|step| visit(pixel - step));
        let _ = (1..=links.reach_px.min(pixel / width)).any(|step| visit(pixel - step * width));
        if pixel >= width && column > 0 {
            visit(pixel - width - 1);
        }
        if pixel >= width && column + 1 < width {
            visit(pixel - width + 1);
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

    /// Lets the clusters grow, pixel by pixel, within those of `whole`; what
    /// no cluster reaches gets the label of its cluster in `whole`, counted on
    /// from the own ones.
    fn grow_within(&mut self, whole: &Self, width: usize) {
        let n_parts = self.len() as u32;
        let mut next = 0;
        // The grouped pixels are the front to start from; what is reached is appended.
        while next < self.pixels.len() {
            let pixel = self.pixels[next] as usize;
            next += 1;
            for (columns, rows) in GROWTH {
                let column = (pixel % width).checked_add_signed(columns);
                if column.is_none_or(|column| column >= width) {
                    continue;
                }
                let near = pixel.wrapping_add_signed(columns + rows * width as isize);
                let same = whole.cluster_of.get(near) == Some(&whole.cluster_of[pixel]);
                if same && self.cluster_of[near] == OUTSIDE {
                    self.cluster_of[near] = self.cluster_of[pixel];
                    self.pixels.push(near as u32);
                }
            }
        }
        for &pixel in &whole.pixels {
            if self.cluster_of[pixel as usize] == OUTSIDE {
                self.cluster_of[pixel as usize] = n_parts + whole.cluster_of[pixel as usize];
            }
        }
    }

    /// Notes where parts of one cluster of `whole` meet.
    fn find_borders(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        whole: &Self,
        pixels: &[u32],
        is_crease: &[bool],
    ) {
        for &pixel in pixels {
            let pixel = pixel as usize;
            let part = self.cluster_of[pixel];
            let row_ends = (pixel + 1).is_multiple_of(cloud.width());
            let right = if row_ends { None } else { Some(pixel + 1) };
            for near in right.into_iter().chain([pixel + cloud.width()]) {
                let meet = self
                    .cluster_of
                    .get(near)
                    .is_some_and(|&other| other != part)
                    && whole.cluster_of[near] == whole.cluster_of[pixel];
                if meet {
                    let points = [&cloud.points()[pixel], &cloud.points()[near]];
                    let crease = is_crease[pixel] || is_crease[near];
                    self.borders
                        .add([part, self.cluster_of[near]], points, crease);
                }
            }
        }
    }

    fn join_over_smooth_borders(&mut self) {
        let Self {
            borders, parents, ..
        } = self;
        borders.join_smooth(|a, b| {
            unite(parents, a, b);
        });
        borders.clear();
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
fn root(parents: &mut [u32], mut cluster: u32) -> u32 {
    while parents[cluster as usize] != cluster {
        parents[cluster as usize] = parents[parents[cluster as usize] as usize];
        cluster = parents[cluster as usize];
    }
    cluster
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;
    use proptest::prelude::*;

    const WIDTH: usize = 12;

    /// Depths in steps around 1 m; `None` is not in the prism.
    fn image() -> impl Strategy<Value = Vec<Option<u8>>> {
        prop::collection::vec(prop::option::weighted(0.8, 0..4_u8), WIDTH * 8)
    }

    fn points(image: &[Option<u8>]) -> Vec<Point> {
        let point = |(i, step): (usize, &Option<u8>)| Point {
            x: (i % WIDTH) as f32 * 0.002,
            y: (i / WIDTH) as f32 * 0.002,
            z: 1.0 + 0.006 * f32::from(step.unwrap_or(0)),
            color: Rgba::default(),
        };
        image.iter().enumerate().map(point).collect()
    }

    /// The neighbours a pixel is compared with, nearest linked one per direction.
    fn linked(points: &[Point], inside: &[bool], pixel: usize) -> Vec<usize> {
        let near = |other: &usize| {
            let limit = LINKS.floor_m + LINKS.per_m2 * points[pixel].z * points[pixel].z;
            inside[*other] && squared_distance(&points[pixel], &points[*other]) <= limit * limit
        };
        let (column, row) = (pixel % WIDTH, pixel / WIDTH);
        let mut found: Vec<usize> = Vec::new();
        found.extend((1..=3.min(column)).map(|step| pixel - step).find(near));
        found.extend((1..=3.min(row)).map(|step| pixel - step * WIDTH).find(near));
        if row > 0 && column > 0 {
            found.extend(Some(pixel - WIDTH - 1).filter(near));
        }
        if row > 0 && column + 1 < WIDTH {
            found.extend(Some(pixel - WIDTH + 1).filter(near));
        }
        found
    }

    /// Clusters by spreading the smallest pixel number until nothing changes.
    fn clusters_by_spreading(points: &[Point], inside: &[bool]) -> Vec<usize> {
        let mut first: Vec<usize> = (0..points.len()).collect();
        loop {
            let before = first.clone();
            for pixel in (0..points.len()).filter(|&pixel| inside[pixel]) {
                for other in linked(points, inside, pixel) {
                    let least = first[pixel].min(first[other]);
                    (first[pixel], first[other]) = (least, least);
                }
            }
            if first == before {
                return first;
            }
        }
    }

    proptest! {
        #[test]
        fn clusters_are_what_links_connect(image in image(), n_min in 1..6_u32) {
            let points = points(&image);
            let inside: Vec<bool> = image.iter().map(Option::is_some).collect();
            let pixels: Vec<u32> = (0..image.len() as u32).filter(|&i| inside[i as usize]).collect();
            let cloud = OrganizedCloud::new(&points, WIDTH, 8).unwrap();
            let mut clusters = Clusters::default();
            clusters.join(&cloud, &pixels, n_min);
            let first = clusters_by_spreading(&points, &inside);
            let mut expected: Vec<Vec<u32>> = (0..image.len())
                .map(|root| pixels.iter().copied().filter(|&p| first[p as usize] == root).collect())
                .collect();
            expected.retain(|pixels: &Vec<u32>| pixels.len() >= n_min as usize);
            let found: Vec<Vec<u32>> = (0..clusters.len()).map(|i| clusters.pixels(i).to_vec()).collect();
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn a_split_loses_no_pixel_and_joins_none(image in image(), creased in prop::collection::vec(any::<bool>(), WIDTH * 8)) {
            let points = points(&image);
            let pixels: Vec<u32> =
                (0..image.len() as u32).filter(|&i| image[i as usize].is_some()).collect();
            let cloud = OrganizedCloud::new(&points, WIDTH, 8).unwrap();
            let (mut whole, mut parts) = (Clusters::default(), Clusters::default());
            whole.join(&cloud, &pixels, 2);
            let creases = Creases::from_marks(creased, vec![true; whole.len()]);
            parts.split(&cloud, &whole, &creases, 3);
            let mut left: Vec<u32> = parts.pixels.clone();
            left.sort_unstable();
            let mut right = whole.pixels.clone();
            right.sort_unstable();
            prop_assert_eq!(left, right);
            for part in 0..parts.len() {
                prop_assert!(parts.pixels(part).is_sorted());
                let of = |&pixel: &u32| whole.cluster_of[pixel as usize];
                prop_assert!(parts.pixels(part).iter().map(of).all(|c| c == of(&parts.pixels(part)[0])));
            }
        }
    }
}
