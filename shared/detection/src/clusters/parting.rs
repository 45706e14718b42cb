//! Clusters that are several objects, parted along their creases.

use super::{Clusters, Links, OUTSIDE, root, squared_distance, unite};
use crate::borders::Borders;
use crate::creases::Creases;
use crate::patch::{FREE, Patch};
use point_cloud::OrganizedCloud;

/// A part of a cluster between creases has at least this many pixels.
const PART_PIXELS_MIN: u32 = 150;

/// Links between creases: narrow, since what they cut off is given back later.
const CLOSE_LINKS: Links = Links {
    floor_m: 0.002,
    per_m2: 0.003,
    reach_px: 1,
};

/// Columns and rows by which a part grows; across a hole of one pixel too.
const GROWTH: [[isize; 2]; 8] = [
    [-1, 0],
    [1, 0],
    [0, -1],
    [0, 1],
    [-2, 0],
    [2, 0],
    [0, -2],
    [0, 2],
];

/// Buffers.
#[derive(Debug, Default)]
pub(crate) struct Parting {
    patch: Patch,
    creases: Creases,
    borders: Borders,
    /// Per label of a part: the label it was joined with.
    parents: Vec<u32>,
    /// Per label: its number of pixels, then the number of its part.
    number_of: Vec<u32>,
    /// Places from which parts grow.
    front: Vec<u32>,
    /// Per place: whether the front has begun with it.
    is_queued: Vec<bool>,
    /// Where the parts of all clusters begin, and the pixels of one in new order.
    starts: Vec<u32>,
    sorted: Vec<u32>,
}

impl Clusters {
    /// Parts the clusters that may be piles along their creases, cluster by cluster:
    /// joins what lies between creases, keeps parts of some size, gives every other
    /// pixel to the part that reaches it first, and joins parts again whose border
    /// says that they are one.
    pub(crate) fn part_along_creases(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        may_be_pile: &[bool],
        parting: &mut Parting,
    ) {
        parting.starts.clear();
        parting.starts.push(0);
        for (cluster, &may_be_pile) in may_be_pile.iter().enumerate() {
            let range = self.starts[cluster] as usize..self.starts[cluster + 1] as usize;
            let pixels = &mut self.pixels[range];
            if may_be_pile && parting.part(cloud, pixels) {
                parting.sort(pixels);
            } else {
                let end = self.starts[cluster + 1];
                parting.starts.push(end);
            }
        }
        if parting.starts.len() > self.starts.len() {
            std::mem::swap(&mut self.starts, &mut parting.starts);
            self.mark_pixels();
        }
    }

    /// Notes for each pixel in which cluster it is now.
    fn mark_pixels(&mut self) {
        for (cluster, range) in (0..).zip(self.starts.windows(2)) {
            for &pixel in &self.pixels[range[0] as usize..range[1] as usize] {
                self.cluster_of[pixel as usize] = cluster;
            }
        }
    }
}

impl Parting {
    /// Finds the parts of a cluster. Returns whether there are several.
    fn part(&mut self, cloud: &OrganizedCloud<'_>, cluster: &[u32]) -> bool {
        self.patch.lay(cloud, cluster);
        self.creases.find(&self.patch, cloud.width()) && self.part_patch(PART_PIXELS_MIN)
    }

    /// Finds the parts, of at least `n_min` pixels each, between the creases.
    fn part_patch(&mut self, n_min: u32) -> bool {
        self.join_between_creases();
        let n_parts = self.keep_large(n_min);
        self.grow();
        self.find_borders(n_parts);
        self.join_same()
    }

    /// Gives each pixel beside the creases the label of the neighbours before it that
    /// are near in space, or a new one.
    fn join_between_creases(&mut self) {
        let Self {
            patch,
            creases,
            parents,
            ..
        } = self;
        let Patch {
            width,
            pixels,
            points,
            part_of,
        } = patch;
        parents.clear();
        for pixel in pixels {
            let place = pixel.place as usize;
            if creases.is_crease[place] {
                continue;
            }
            let squared_max = CLOSE_LINKS.squared_max(pixel.z);
            let mut own = FREE;
            for near in [
                place - 1,
                place - *width,
                place - *width - 1,
                place - *width + 1,
            ] {
                let other = part_of[near];
                if other < FREE
                    && other != own
                    && squared_distance(&points[place], &points[near]) <= squared_max
                {
                    own = match own {
                        FREE => other,
                        own => unite(parents, own, other),
                    };
                }
            }
            if own == FREE {
                own = parents.len() as u32;
                parents.push(own);
            }
            part_of[place] = own;
        }
    }

    /// Numbers the parts that are large enough, in the order in which they begin, and
    /// frees the pixels of the others. Returns the number of parts.
    fn keep_large(&mut self, n_min: u32) -> u32 {
        let Self {
            patch,
            parents,
            number_of,
            ..
        } = self;
        for label in 0..parents.len() as u32 {
            parents[label as usize] = root(parents, label);
        }
        number_of.clear();
        number_of.resize(parents.len(), 0);
        let labels = || patch.part_of.iter().filter(|&&label| label < FREE);
        for &label in labels() {
            number_of[parents[label as usize] as usize] += 1;
        }
        let mut n_parts = 0;
        for n in number_of.iter_mut() {
            let is_large = *n >= n_min;
            *n = if is_large { n_parts } else { FREE };
            n_parts += u32::from(is_large);
        }
        for label in patch.part_of.iter_mut().filter(|label| **label < FREE) {
            *label = number_of[parents[*label as usize] as usize];
        }
        n_parts
    }

    /// Lets the parts grow, pixel by pixel, over what is free.
    fn grow(&mut self) {
        let Self {
            patch,
            front,
            is_queued,
            ..
        } = self;
        let width = patch.width as isize;
        let steps = GROWTH.map(|[columns, rows]| columns + rows * width);
        let neighbours = |place: u32| steps.map(|step| (place as usize).wrapping_add_signed(step));
        let part_of = &mut patch.part_of;
        is_queued.clear();
        is_queued.resize(part_of.len(), false);
        // The front begins with the parts' pixels that have somewhere to grow.
        front.clear();
        let places = patch.pixels.iter().map(|pixel| pixel.place);
        for place in places.filter(|&place| part_of[place as usize] == FREE) {
            for near in neighbours(place) {
                if part_of[near] < FREE && !is_queued[near] {
                    is_queued[near] = true;
                    front.push(near as u32);
                }
            }
        }
        let mut next = 0;
        while let Some(&place) = front.get(next) {
            next += 1;
            let part = part_of[place as usize];
            for near in neighbours(place) {
                if part_of[near] == FREE {
                    part_of[near] = part;
                    front.push(near as u32);
                }
            }
        }
    }

    /// Notes where parts meet, and what they look like. What no part reaches is one
    /// more, the last.
    fn find_borders(&mut self, n_parts: u32) {
        let Self { patch, borders, .. } = self;
        for part in patch.part_of.iter_mut().filter(|part| **part == FREE) {
            *part = n_parts;
        }
        borders.clear(n_parts as usize + 1);
        for pixel in &patch.pixels {
            let place = pixel.place as usize;
            let part = patch.part_of[place];
            borders.add_pixel(part, &patch.points[place]);
            for near in [place + 1, place + patch.width] {
                let other = patch.part_of[near];
                if other != part && other != OUTSIDE {
                    borders.add_pair([part, other], [place, near]);
                }
            }
        }
        self.parents.clear();
        self.parents.extend(0..=n_parts);
    }

    /// Joins the parts whose border says that they are one, and numbers what is left.
    /// Returns whether it is more than one.
    fn join_same(&mut self) -> bool {
        let Self {
            patch,
            creases,
            borders,
            parents,
            number_of,
            ..
        } = self;
        borders.join_same(&patch.points, &creases.bend, |a, b| {
            unite(parents, a, b);
        });
        number_of.clear();
        number_of.resize(parents.len(), 0);
        for pixel in &patch.pixels {
            let part = &mut patch.part_of[pixel.place as usize];
            *part = root(parents, *part);
            number_of[*part as usize] += 1;
        }
        number_of.iter().filter(|&&n| n > 0).count() > 1
    }

    /// Sorts the pixels of a cluster by the part they are in, and notes where each
    /// part ends.
    fn sort(&mut self, pixels: &mut [u32]) {
        let Self {
            patch,
            number_of: next_of,
            starts,
            sorted,
            ..
        } = self;
        let mut end = starts.last().copied().unwrap_or(0);
        let mut next = 0;
        for n in next_of.iter_mut() {
            let n_pixels = std::mem::replace(n, next);
            next += n_pixels;
            if n_pixels > 0 {
                end += n_pixels;
                starts.push(end);
            }
        }
        sorted.clear();
        sorted.resize(pixels.len(), 0);
        for (own, &pixel) in patch.pixels.iter().zip(pixels.iter()) {
            let next = &mut next_of[patch.part_of[own.place as usize] as usize];
            sorted[*next as usize] = pixel;
            *next += 1;
        }
        pixels.copy_from_slice(sorted);
    }
}

#[cfg(test)]
impl Parting {
    /// Parts a cluster along creases as given, for each pixel of the image; returns
    /// where its parts end.
    pub(super) fn part_along(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cluster: &mut [u32],
        is_crease: &[bool],
        n_min: u32,
    ) -> Vec<u32> {
        self.patch.lay(cloud, cluster);
        let mut marks = vec![false; self.patch.part_of.len()];
        for (own, &pixel) in self.patch.pixels.iter().zip(cluster.iter()) {
            marks[own.place as usize] = is_crease[pixel as usize];
        }
        self.creases = Creases::from_marks(marks);
        self.starts = vec![0];
        self.part_patch(n_min);
        self.sort(cluster);
        std::mem::take(&mut self.starts)
    }
}
