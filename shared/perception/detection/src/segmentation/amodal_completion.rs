//! Amodal completion: the visible parts of one body on both sides of an occluder become one object.
//!
//! Two parts belong together when they continue one another
//! ([`RegionAdjacency::may_continue`]) and all that lies between them in the image is hidden:
//! nearer than the straight way from one to the other, or without depth beside that.

use super::cell_image::{CellImage, NO_CELL};
use super::has_depth;
use crate::region_merging::RegionAdjacency;
use point_cloud::OrganizedCloud;
use sensor_noise::DepthNoise;
use union_find::{find_root, union};

/// Least number of cells of a part. Chosen.
const CELLS_MIN: u32 = 12;

/// Least distance of an occluder before what it hides, metres. Chosen.
const OCCLUDER_DISTANCE_MIN_M: f32 = 0.015;

/// As [`OCCLUDER_DISTANCE_MIN_M`], in sigmas of the depth noise. Chosen.
const OCCLUDER_SIGMAS: f32 = 3.0;

/// Least share of the cells between two parts that an occluder covers; of the others all but a few
/// have no depth. Chosen.
const HIDDEN_SHARE_MIN: f32 = 0.5;

/// Greatest share of the cells between two parts through which the space behind is seen. Chosen.
const FREE_SHARE_MAX: f32 = 0.1;

/// Middle of an object in the image of cells.
#[derive(Debug, Clone, Copy, Default)]
struct PartCentre {
    n: u32,
    column: f32,
    row: f32,
    inverse_depth: f32,
}

/// Objects with their middles. Reused from frame to frame.
#[derive(Debug, Default)]
pub(super) struct AmodalCompletion {
    centres: Vec<PartCentre>,
    roots: Vec<u32>,
    pairs: Vec<[u32; 2]>,
}

/// Image of cells with the region of each cell.
#[derive(Clone, Copy)]
pub(super) struct RegionImage<'a> {
    pub(super) cloud: &'a OrganizedCloud<'a>,
    pub(super) cells: &'a CellImage,
    pub(super) region_of: &'a [u32],
    pub(super) noise: &'a DepthNoise,
}

impl AmodalCompletion {
    /// Unite the parts of objects that are divided by occluders; `parents` is the union-find
    /// forest of the regions.
    pub(super) fn unite_parts(
        &mut self,
        image: &RegionImage<'_>,
        adjacency: &RegionAdjacency,
        parents: &mut [u32],
    ) {
        self.find_centres(image, parents);
        self.roots.clear();
        let large = (0..).zip(&self.centres);
        let large = large.filter(|(_, centre)| centre.n >= CELLS_MIN);
        self.roots.extend(large.map(|(root, _)| root));
        self.pairs.clear();
        for (i, &a) in self.roots.iter().enumerate() {
            for &b in &self.roots[i + 1..] {
                if adjacency.may_continue(a, b) && self.is_hidden_between([a, b], image, parents) {
                    self.pairs.push([a, b]);
                }
            }
        }
        for [a, b] in self.pairs.drain(..) {
            union(parents, a, b);
        }
    }

    /// Mean place and inverse depth of the cells of each object, by its root.
    fn find_centres(&mut self, image: &RegionImage<'_>, parents: &mut [u32]) {
        self.centres.clear();
        self.centres.resize(parents.len(), PartCentre::default());
        let width = image.cells.width;
        for (cell, &region) in image.cells.cells.iter().zip(image.region_of) {
            let root = find_root(parents, region);
            let centre = &mut self.centres[root as usize];
            let place = cell.place as usize;
            centre.n += 1;
            centre.column += (place % width) as f32;
            centre.row += (place / width) as f32;
            centre.inverse_depth += image.cells.inverse_depth[place];
        }
        for centre in self.centres.iter_mut().filter(|centre| centre.n > 0) {
            let n = centre.n as f32;
            centre.column /= n;
            centre.row /= n;
            centre.inverse_depth /= n;
        }
    }

    /// True if an occluder hides the straight way from the middle of a part to that of another
    /// one, where it leaves both.
    fn is_hidden_between(
        &self,
        parts: [u32; 2],
        image: &RegionImage<'_>,
        parents: &mut [u32],
    ) -> bool {
        let [from, to] = parts.map(|root| self.centres[root as usize]);
        let n_steps = (to.column - from.column)
            .abs()
            .max((to.row - from.row).abs())
            .ceil();
        let (mut n_hidden, mut n_free, mut n_unknown) = (0_u32, 0_u32, 0_u32);
        for step in 0..=n_steps as u32 {
            let t = step as f32 / n_steps.max(1.0);
            let at = |a: f32, b: f32| a + t * (b - a);
            let (column, row) = (at(from.column, to.column), at(from.row, to.row));
            let place = row.round() as usize * image.cells.width + column.round() as usize;
            let number = image.cells.number_of[place];
            if number != NO_CELL {
                let region = image.region_of[number as usize];
                if parts.contains(&find_root(parents, region)) {
                    continue;
                }
            }
            let expected_m = 1.0 / at(from.inverse_depth, to.inverse_depth);
            match image.depth_m(place) {
                None => n_unknown += 1,
                Some(depth_m) => {
                    let least_m =
                        OCCLUDER_DISTANCE_MIN_M.max(OCCLUDER_SIGMAS * image.noise.sigma_m(depth_m));
                    if depth_m < expected_m - least_m {
                        n_hidden += 1;
                    } else {
                        n_free += 1;
                    }
                }
            }
        }
        let n = (n_hidden + n_free + n_unknown) as f32;
        n_hidden as f32 >= HIDDEN_SHARE_MIN * n && n_free as f32 <= FREE_SHARE_MAX * n && n > 0.0
    }
}

impl RegionImage<'_> {
    /// Depth at a place, metres; `None` without one.
    fn depth_m(&self, place: usize) -> Option<f32> {
        if self.cells.number_of[place] != NO_CELL {
            return Some(1.0 / self.cells.inverse_depth[place]);
        }
        has_depth(self.cloud, self.cells, place).then(|| {
            let [column, row] = self.cells.first_pixel(place);
            self.cloud.points()[row * self.cloud.width() + column].z
        })
    }
}
