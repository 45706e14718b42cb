//! Watershed of the edge image: an over-segmentation of the cells into regions.

use super::cell_image::{Cell, CellImage};
use super::edge_image::{EdgeImage, NO_EDGE};
use union_find::{find_root, union};

/// Strength up to which an edge is inside of an object: a probability of 0.7 %. Chosen.
const INSIDE_MAX: u8 = 22;

/// Least number of cells of a region, unless its cluster is smaller. Chosen.
pub(super) const CELLS_MIN: u32 = 20;

/// Region of a watershed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WatershedRegion {
    pub(crate) cluster: u32,
    pub(crate) n_pixels: u32,
}

/// Regions of a cell image. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Watershed {
    /// Per cell: the number of its region.
    pub(crate) region_of: Vec<u32>,
    pub(crate) regions: Vec<WatershedRegion>,
    /// Union-find forest of the cells; a root precedes its members.
    parents: Vec<u32>,
    /// Per root: the number of cells of its basin.
    n_cells: Vec<u32>,
    /// Edges within clusters, weakest first, as pairs of cells.
    sorted: Vec<[u32; 2]>,
    /// End of the edges of each strength in `sorted`.
    ends: Vec<u32>,
}

impl Watershed {
    /// Segment the cells into regions that do not cross clusters.
    ///
    /// Edges are flooded from the weakest to the strongest, as in Kruskal's algorithm (watershed
    /// cuts; Cousty et al. 2009). Two basins are united over an edge that is inside of an object,
    /// and when one of them is too small for a region. A cluster that `is_whole` stays one
    /// region.
    pub(crate) fn refill(&mut self, image: &CellImage, edges: &EdgeImage, is_whole: &[bool]) {
        self.flood_inside(image, edges, is_whole);
        self.count_cells();
        self.sort_edges(image, edges);
        self.flood();
        self.number_regions(image);
    }

    /// Unite cells over all edges that are inside of an object, whose order does not matter.
    fn flood_inside(&mut self, image: &CellImage, edges: &EdgeImage, is_whole: &[bool]) {
        self.parents.clear();
        self.parents.extend(0..image.cells.len() as u32);
        for (number, cell) in (0..).zip(&image.cells) {
            for (strength, other) in edges_of(cell, image, edges) {
                if strength <= INSIDE_MAX || is_whole[cell.cluster as usize] {
                    union(&mut self.parents, number, other);
                }
            }
        }
    }

    /// Count the cells of each basin.
    fn count_cells(&mut self) {
        self.n_cells.clear();
        self.n_cells.resize(self.parents.len(), 0);
        for cell in 0..self.parents.len() {
            // A root is its own parent and precedes its members.
            let root = self.parents[self.parents[cell] as usize];
            self.parents[cell] = root;
            self.n_cells[root as usize] += 1;
        }
    }

    /// Unite basins that are too small for a region, over the weakest edges first.
    fn flood(&mut self) {
        for cells in &self.sorted {
            let [a, b] = cells.map(|cell| find_root(&mut self.parents, cell));
            let n = [a, b].map(|root| self.n_cells[root as usize]);
            if a != b && n[0].min(n[1]) < CELLS_MIN {
                let root = union(&mut self.parents, a, b);
                self.n_cells[root as usize] = n[0] + n[1];
            }
        }
    }

    /// Counting sort of the other edges within clusters by strength.
    fn sort_edges(&mut self, image: &CellImage, edges: &EdgeImage) {
        self.ends.clear();
        self.ends.resize(usize::from(NO_EDGE) + 1, 0);
        for cell in &image.cells {
            for (strength, _) in strong_edges_of(cell, image, edges) {
                self.ends[usize::from(strength) + 1] += 1;
            }
        }
        for strength in 0..usize::from(NO_EDGE) {
            self.ends[strength + 1] += self.ends[strength];
        }
        let n_edges = self.ends[usize::from(NO_EDGE)] as usize;
        self.sorted.clear();
        self.sorted.resize(n_edges, [0; 2]);
        for (number, cell) in (0..).zip(&image.cells) {
            for (strength, other) in strong_edges_of(cell, image, edges) {
                let end = &mut self.ends[usize::from(strength)];
                self.sorted[*end as usize] = [number, other];
                *end += 1;
            }
        }
    }

    fn number_regions(&mut self, image: &CellImage) {
        self.region_of.clear();
        self.regions.clear();
        for (number, cell) in image.cells.iter().enumerate() {
            // A root precedes the other cells of its region.
            let root = find_root(&mut self.parents, number as u32) as usize;
            if root == number {
                self.region_of.push(self.regions.len() as u32);
                self.regions.push(WatershedRegion {
                    cluster: cell.cluster,
                    n_pixels: 0,
                });
            } else {
                self.region_of.push(self.region_of[root]);
            }
            self.regions[self.region_of[number] as usize].n_pixels += cell.n_pixels;
        }
    }
}

/// Edges of a cell as [`edges_of`] that were evaluated and are not surely inside of an object.
#[inline]
fn strong_edges_of<'a>(
    cell: &'a Cell,
    image: &'a CellImage,
    edges: &'a EdgeImage,
) -> impl Iterator<Item = (u8, u32)> + 'a {
    let is_strong = |&(strength, _): &(u8, u32)| strength > INSIDE_MAX && strength != NO_EDGE;
    edges_of(cell, image, edges).filter(is_strong)
}

/// Edges from a cell to the next cells of its cluster in its row and column: their strength and
/// the number of the other cell.
#[inline]
fn edges_of<'a>(
    cell: &'a Cell,
    image: &'a CellImage,
    edges: &'a EdgeImage,
) -> impl Iterator<Item = (u8, u32)> + 'a {
    let place = cell.place as usize;
    let edge = move |(strengths, step): (&Vec<u8>, usize)| {
        let is_inside = image.cluster_of[place + step] == cell.cluster;
        is_inside.then(|| (strengths[place], image.number_of[place + step]))
    };
    edges.to_next.iter().zip([1, image.width]).filter_map(edge)
}
