//! Concavity split: clusters of several objects are separated along concave creases.

use super::{Clusters, LinkDistance, NO_CLUSTER, find_root, squared_distance, union};
use crate::creases::Creases;
use crate::parallelism::{Parallelism, ScratchPool};
use crate::patch::{Patch, UNASSIGNED};
use crate::region_merging::RegionAdjacency;
use crate::split_gate::may_be_several_objects;
use crate::table_reference::TableReference;
use point_cloud::OrganizedCloud;
use std::cmp::Reverse;

/// Least number of pixels of a region between creases. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const REGION_PIXELS_MIN: u32 = 60;

/// Rows and columns between the pixels whose positions describe a region.
const POSITION_STRIDE: u32 = 2;

/// Link rule between creases. Narrow, because growth later restores the pixels that it cuts
/// off. Chosen; sensitivity: see `tabula-lab sweep`.
const NARROW_LINKS: LinkDistance = LinkDistance {
    floor_m: 0.002,
    per_m2: 0.003,
    reach_px: 1,
};

/// Growth steps of a part, columns and rows; a step of two crosses a hole of one pixel.
const GROWTH_STEPS: [[isize; 2]; 8] = [
    [-1, 0],
    [1, 0],
    [0, -1],
    [0, 1],
    [-2, 0],
    [2, 0],
    [0, -2],
    [0, 2],
];

/// Growth steps to the pixels that the others do not reach: those by which the pixels of a
/// cluster are linked.
const LINK_STEPS: [[isize; 2]; 8] = [
    [-1, -1],
    [1, -1],
    [-1, 1],
    [1, 1],
    [-3, 0],
    [3, 0],
    [0, -3],
    [0, 3],
];

/// Concavity splitter: buffers for one cluster after the other, and the clusters split so
/// far.
#[derive(Debug, Default)]
pub(crate) struct ConcavitySplit {
    pub(super) patch: Patch,
    creases: Creases,
    pub(super) adjacency: RegionAdjacency,
    /// Union-find forest, per part label: the parent label.
    pub(super) parents: Vec<u32>,
    /// Per label: number of its pixels, then the number of its part.
    number_of: Vec<u32>,
    /// Pixels of no part, as patch indices.
    unassigned: Vec<u32>,
    /// Growth front of the region, as patch indices.
    front: Vec<u32>,
    /// Per patch index: `true` when it is in the initial front.
    is_queued: Vec<bool>,
    split_clusters: Vec<u32>,
    /// Pixels of the split clusters, part by part.
    sorted: Vec<u32>,
    sizes: Vec<u32>,
}

impl Clusters {
    /// Splits clusters along their concave creases.
    ///
    /// Labels the connected components between creases, keeps the large ones, grows them
    /// over all other pixels, and merges parts again that are one object.
    pub(crate) fn split_at_concavities(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        parallelism: &dyn Parallelism,
        table: &TableReference,
        splits: &mut ScratchPool<ConcavitySplit>,
    ) {
        // Longest job first, so that no thread finishes late with a large cluster.
        let mut by_size = std::mem::take(&mut self.by_size);
        by_size.clear();
        by_size.extend(0..self.len() as u32);
        by_size.sort_unstable_by_key(|&cluster| (Reverse(self.n_pixels(cluster)), cluster));
        splits.all().iter_mut().for_each(ConcavitySplit::clear);
        splits.for_each(parallelism, by_size.iter(), |split, &cluster| {
            let pixels = self.pixels(cluster as usize);
            if split.find_parts(cloud, pixels, table) {
                split.store_parts(cluster, pixels);
            }
        });
        self.by_size = by_size;
        let n_before = self.starts.len();
        for split in splits.all() {
            self.adopt_parts(split, n_before);
        }
        if self.starts.len() > n_before {
            self.starts.sort_unstable();
            self.label_pixels();
        }
    }

    /// Number of pixels of a cluster.
    fn n_pixels(&self, cluster: u32) -> u32 {
        self.starts[cluster as usize + 1] - self.starts[cluster as usize]
    }

    /// Take over the reordered pixels of split clusters. The starts of their parts are
    /// appended behind the first `n_starts` starts.
    fn adopt_parts(&mut self, split: &ConcavitySplit, n_starts: usize) {
        let mut sorted = split.sorted.as_slice();
        let mut sizes = split.sizes.as_slice();
        for &cluster in &split.split_clusters {
            let [mut start, end] = [0, 1].map(|i| self.starts[..n_starts][cluster as usize + i]);
            let (own, others) = sorted.split_at((end - start) as usize);
            self.pixels[start as usize..end as usize].copy_from_slice(own);
            sorted = others;
            while let Some((size, others)) = sizes.split_first() {
                sizes = others;
                start += size;
                if start == end {
                    break;
                }
                self.starts.push(start);
            }
        }
    }

    /// Labels each pixel with its cluster.
    fn label_pixels(&mut self) {
        for (cluster, range) in (0..).zip(self.starts.windows(2)) {
            for &pixel in &self.pixels[range[0] as usize..range[1] as usize] {
                self.cluster_of[pixel as usize] = cluster;
            }
        }
    }
}

impl ConcavitySplit {
    /// Clears the list of split clusters.
    fn clear(&mut self) {
        self.split_clusters.clear();
        self.sorted.clear();
        self.sizes.clear();
    }

    /// Find the parts of a cluster that is larger than a hand. Returns `true` when there are
    /// several.
    fn find_parts(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cluster: &[u32],
        table: &TableReference,
    ) -> bool {
        may_be_several_objects(cloud.points(), cluster, &table.axes)
            && self.find_regions(cloud, cluster, table)
            && self.merge_regions()
    }

    /// Over-segmentation of a cluster into regions between creases, with their adjacency.
    /// Returns `true` when there are several.
    pub(super) fn find_regions(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cluster: &[u32],
        table: &TableReference,
    ) -> bool {
        self.patch.copy_cluster(cloud, cluster);
        self.creases.find(&self.patch, cloud.width(), &table.noise)
            && self.split_patch(REGION_PIXELS_MIN, table)
    }

    /// Split the patch into the regions between the creases, of at least `n_min` pixels
    /// each. Returns `true` when there are several.
    fn split_patch(&mut self, n_min: u32, table: &TableReference) -> bool {
        self.label_between_creases();
        let n_parts = self.keep_large_parts(n_min);
        self.grow(&GROWTH_STEPS);
        self.grow(&LINK_STEPS);
        self.find_boundaries(n_parts, table);
        self.adjacency.n_edges() > 0
    }

    /// Label the connected components of the patch without its crease pixels, and count the
    /// pixels of each label.
    fn label_between_creases(&mut self) {
        let Self {
            patch,
            creases,
            parents,
            number_of,
            ..
        } = self;
        let Patch {
            width,
            pixels,
            points,
            part_of,
        } = patch;
        // As slices, so that their addresses stay in registers.
        let (points, part_of) = (points.as_slice(), part_of.as_mut_slice());
        let is_crease = creases.is_crease.as_slice();
        parents.clear();
        number_of.clear();
        for pixel in pixels {
            let index = pixel.index as usize;
            if is_crease[index] {
                continue;
            }
            let (point, squared_max) = (&points[index], NARROW_LINKS.squared_max(pixel.z));
            let is_linked = |near: usize| squared_distance(point, &points[near]) <= squared_max;
            let above = index - *width;
            let near = [index - 1, above, above - 1, above + 1];
            let labels = near.map(|near| part_of[near]);
            let mut own = UNASSIGNED;
            if labels[0] < UNASSIGNED
                && labels[1..].iter().all(|label| *label == labels[0])
                && is_linked(near[0])
            {
                // Inside a region, one distance is enough.
                own = labels[0];
            } else {
                for (near, other) in near.into_iter().zip(labels) {
                    if other != own && other < UNASSIGNED && is_linked(near) {
                        own = match own {
                            UNASSIGNED => other,
                            own => union(parents, own, other),
                        };
                    }
                }
            }
            if own == UNASSIGNED {
                own = parents.len() as u32;
                parents.push(own);
                number_of.push(0);
            }
            number_of[own as usize] += 1;
            part_of[index] = own;
        }
    }

    /// Number the parts with at least `n_min` pixels in image order, unassign the pixels of the
    /// others, and list the pixels of no part. Returns the number of parts.
    fn keep_large_parts(&mut self, n_min: u32) -> u32 {
        let Self {
            patch,
            parents,
            number_of,
            unassigned,
            ..
        } = self;
        for label in 0..parents.len() {
            // A root precedes its members.
            let root = parents[parents[label] as usize];
            parents[label] = root;
            if root as usize != label {
                number_of[root as usize] += std::mem::take(&mut number_of[label]);
            }
        }
        let mut n_parts = 0;
        for label in 0..parents.len() {
            let root = parents[label] as usize;
            number_of[label] = if root != label {
                number_of[root]
            } else if number_of[label] >= n_min {
                n_parts += 1;
                n_parts - 1
            } else {
                UNASSIGNED
            };
        }
        unassigned.clear();
        let part_of = patch.part_of.as_mut_slice();
        for pixel in &patch.pixels {
            let part = &mut part_of[pixel.index as usize];
            if *part != UNASSIGNED {
                *part = number_of[*part as usize];
            }
            if *part == UNASSIGNED {
                unassigned.push(pixel.index);
            }
        }
        n_parts
    }

    /// Grow the parts breadth-first over unassigned pixels.
    fn grow(&mut self, steps: &[[isize; 2]; 8]) {
        let Self {
            patch,
            unassigned,
            front,
            is_queued,
            ..
        } = self;
        let width = patch.width as isize;
        let steps = steps.map(|[columns, rows]| columns + rows * width);
        let neighbours = |index: u32| steps.map(|step| (index as usize).wrapping_add_signed(step));
        let part_of = &mut patch.part_of;
        if unassigned.is_empty() {
            return;
        }
        is_queued.clear();
        is_queued.resize(part_of.len(), false);
        // Initial front: pixels of parts next to an unassigned pixel.
        front.clear();
        for &index in &*unassigned {
            for near in neighbours(index) {
                if part_of[near] < UNASSIGNED && !is_queued[near] {
                    is_queued[near] = true;
                    front.push(near as u32);
                }
            }
        }
        let mut next = 0;
        while let Some(&index) = front.get(next) {
            next += 1;
            let part = part_of[index as usize];
            for near in neighbours(index) {
                if part_of[near] == UNASSIGNED {
                    part_of[near] = part;
                    front.push(near as u32);
                }
            }
        }
        unassigned.retain(|&index| part_of[index as usize] == UNASSIGNED);
    }

    /// Collect the statistics of parts and boundaries. Pixels that no part reaches form one
    /// more part, the last.
    fn find_boundaries(&mut self, n_parts: u32, table: &TableReference) {
        let Self {
            patch,
            adjacency,
            creases,
            unassigned,
            ..
        } = self;
        for &index in &*unassigned {
            patch.part_of[index as usize] = n_parts;
        }
        adjacency.clear(n_parts as usize + 1);
        let (points, part_of) = (patch.points.as_slice(), patch.part_of.as_slice());
        for pixel in &patch.pixels {
            let index = pixel.index as usize;
            let (part, point) = (part_of[index], &points[index]);
            adjacency.add_pixel(part, point);
            if pixel.row % POSITION_STRIDE == 0 && pixel.column % POSITION_STRIDE == 0 {
                adjacency.add_position(part, point, &table.axes);
            }
            for near in [index + 1, index + patch.width] {
                let other = part_of[near];
                if other != part && other != NO_CLUSTER {
                    adjacency.add_pair([part, other], [index, near]);
                }
            }
        }
        adjacency.connect(patch, &creases.bend, table);
        self.parents.clear();
        self.parents.extend(0..=n_parts);
    }

    /// Merge parts of one object and relabel the pixels. Returns `true` when several parts
    /// remain.
    fn merge_regions(&mut self) -> bool {
        let Self {
            patch,
            adjacency,
            parents,
            number_of,
            ..
        } = self;
        adjacency.merge_regions(|a, b| {
            union(parents, a, b);
        });
        for part in 0..parents.len() as u32 {
            parents[part as usize] = find_root(parents, part);
        }
        number_of.clear();
        number_of.resize(parents.len(), 0);
        let part_of = patch.part_of.as_mut_slice();
        for pixel in &patch.pixels {
            let part = &mut part_of[pixel.index as usize];
            *part = parents[*part as usize];
            number_of[*part as usize] += 1;
        }
        number_of.iter().filter(|&&n| n > 0).count() > 1
    }

    /// Store the pixels of a split cluster, sorted by part.
    fn store_parts(&mut self, cluster: u32, pixels: &[u32]) {
        let Self {
            patch,
            number_of: next_of,
            split_clusters,
            sorted,
            sizes,
            ..
        } = self;
        split_clusters.push(cluster);
        let first = sorted.len();
        sorted.resize(first + pixels.len(), 0);
        let mut next = first as u32;
        for n in next_of.iter_mut() {
            let n_pixels = std::mem::replace(n, next);
            next += n_pixels;
            if n_pixels > 0 {
                sizes.push(n_pixels);
            }
        }
        for (own, &pixel) in patch.pixels.iter().zip(pixels) {
            let next = &mut next_of[patch.part_of[own.index as usize] as usize];
            sorted[*next as usize] = pixel;
            *next += 1;
        }
    }
}

#[cfg(test)]
use crate::affine_form::AffineForm;
#[cfg(test)]
use geometry::RigidTransform;
#[cfg(test)]
use sensor_noise::DepthNoise;

#[cfg(test)]
impl ConcavitySplit {
    /// Split a cluster along given creases, one mark per pixel of the image; returns its
    /// pixels part by part and the sizes of the parts.
    pub(super) fn split_along(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cluster: &[u32],
        is_crease: &[bool],
        n_min: u32,
    ) -> (Vec<u32>, Vec<u32>) {
        self.clear();
        self.patch.copy_cluster(cloud, cluster);
        let mut marks = vec![false; self.patch.part_of.len()];
        for (own, &pixel) in self.patch.pixels.iter().zip(cluster.iter()) {
            marks[own.index as usize] = is_crease[pixel as usize];
        }
        self.creases = Creases::from_marks(marks);
        let table = TableReference {
            axes: AffineForm::coordinates_of(&RigidTransform::identity()),
            noise: DepthNoise::default(),
        };
        self.split_patch(n_min, &table);
        self.merge_regions();
        self.store_parts(0, cluster);
        (self.sorted.clone(), self.sizes.clone())
    }
}
