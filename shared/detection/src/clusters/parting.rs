//! Clusters that are several objects, parted along their creases.

use super::{Clusters, Links, OUTSIDE, unite};
use crate::creases::Creases;
use point_cloud::OrganizedCloud;

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

impl Clusters {
    /// Takes clusters over from `whole`, splitting those that have creases:
    /// joins what lies between creases, keeps parts of at least `n_min`
    /// pixels, gives every other pixel of a cluster to the part that reaches
    /// it first, and joins parts again whose border says that they are one.
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
        self.grow_within(whole, split(), cloud.width());
        let n_parts = self.len() + whole.len();
        self.parents.clear();
        self.parents.extend(0..n_parts as u32);
        self.borders.clear(n_parts);
        for cluster in split() {
            self.find_borders(cloud, whole, whole.pixels(cluster));
        }
        let Self {
            borders, parents, ..
        } = self;
        borders.join_same(cloud, &creases.bend, |a, b| {
            unite(parents, a, b);
        });
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(&whole.pixels);
        self.number_large(1);
        self.group();
    }

    /// Lets the clusters grow, pixel by pixel, within those of `whole`; what
    /// no cluster reaches gets the label of its cluster in `whole`, counted on
    /// from the own ones.
    fn grow_within(&mut self, whole: &Self, split: impl Iterator<Item = usize>, width: usize) {
        let n_parts = self.len() as u32;
        let neighbours = |pixel: usize| {
            GROWTH.iter().filter_map(move |(columns, rows)| {
                let column = (pixel % width).checked_add_signed(*columns)?;
                let near = pixel.wrapping_add_signed(columns + rows * width as isize);
                let same = whole.cluster_of.get(near) == Some(&whole.cluster_of[pixel]);
                (column < width && same).then_some(near)
            })
        };
        // The front begins with the grouped pixels that have somewhere to grow.
        self.front.clear();
        for cluster in split {
            for &pixel in whole.pixels(cluster) {
                let pixel = pixel as usize;
                let is_free = |&near: &usize| self.cluster_of[near] == OUTSIDE;
                if self.cluster_of[pixel] == OUTSIDE {
                    let grouped = neighbours(pixel).filter(|near| !is_free(near));
                    self.front.extend(grouped.map(|near| near as u32));
                }
            }
        }
        let mut next = 0;
        while next < self.front.len() {
            let pixel = self.front[next] as usize;
            next += 1;
            for near in neighbours(pixel) {
                if self.cluster_of[near] == OUTSIDE {
                    self.cluster_of[near] = self.cluster_of[pixel];
                    self.front.push(near as u32);
                }
            }
        }
        for &pixel in &whole.pixels {
            if self.cluster_of[pixel as usize] == OUTSIDE {
                self.cluster_of[pixel as usize] = n_parts + whole.cluster_of[pixel as usize];
            }
        }
    }

    /// Notes where parts of one cluster of `whole` meet, and what they look like.
    fn find_borders(&mut self, cloud: &OrganizedCloud<'_>, whole: &Self, pixels: &[u32]) {
        for &pixel in pixels {
            let pixel = pixel as usize;
            let part = self.cluster_of[pixel];
            self.borders.add_pixel(part, &cloud.points()[pixel]);
            let row_ends = (pixel + 1).is_multiple_of(cloud.width());
            let right = if row_ends { None } else { Some(pixel + 1) };
            for near in right.into_iter().chain([pixel + cloud.width()]) {
                let other = self.cluster_of.get(near).copied();
                let Some(other) = other.filter(|&other| other != part) else {
                    continue;
                };
                if whole.cluster_of[near] == whole.cluster_of[pixel] {
                    self.borders.add_pair([part, other], [pixel, near]);
                }
            }
        }
    }
}
