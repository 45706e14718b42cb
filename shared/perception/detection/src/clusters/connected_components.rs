//! Connected-component labelling of pixels by union-find.
//!
//! The image is cut into bands of rows that are labelled independently, possibly in
//! parallel, and merged along their seams. The components do not depend on the order in
//! which links are followed.

use super::{Clusters, LINKS, NO_CLUSTER, squared_distance};
use crate::parallelism::{Parallelism, for_each};
use point_cloud::{OrganizedCloud, Point};
use union_find::union;

/// Number of bands, unless the image has fewer rows.
const N_BANDS: usize = 8;

/// Union-find labels of one image band.
#[derive(Debug, Default)]
pub(super) struct Band {
    /// Index of its first pixel in the list of pixels.
    first: usize,
    end: usize,
    /// Union-find forest, per label: the parent label; a root is its own parent.
    parents: Vec<u32>,
}

impl Clusters {
    /// Label the connected components of pixels, given in image order; components with
    /// fewer than `n_min` pixels are dropped.
    ///
    /// Union-find in one pass over the pixels (after Wu, Otoo and Suzuki 2009).
    pub(crate) fn label_components(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        parallelism: &dyn Parallelism,
        pixels: &[u32],
        n_min: u32,
    ) {
        self.clear_labels(cloud.points().len());
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(pixels);
        let n_rows = cloud.height().div_ceil(N_BANDS).max(LINKS.reach_px);
        self.label_bands(cloud, parallelism, n_rows);
        self.merge_seams(cloud, n_rows);
        self.number_large_components(n_min);
        self.sort_by_cluster();
    }

    /// Clear the labels of an image of `n_pixels`: only those of the clusters found last, when it
    /// had the same size.
    fn clear_labels(&mut self, n_pixels: usize) {
        if self.cluster_of.len() == n_pixels {
            for &pixel in &self.pixels {
                self.cluster_of[pixel as usize] = NO_CLUSTER;
            }
        } else {
            self.cluster_of.clear();
            self.cluster_of.resize(n_pixels, NO_CLUSTER);
        }
    }

    /// Labels the components of each band of `n_rows` rows.
    fn label_bands(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        parallelism: &dyn Parallelism,
        n_rows: usize,
    ) {
        let n_pixels = n_rows * cloud.width();
        self.bands
            .resize_with(cloud.height().div_ceil(n_rows), Band::default);
        let mut first = 0;
        for (band, end_pixel) in self.bands.iter_mut().zip((n_pixels..).step_by(n_pixels)) {
            band.first = first;
            band.end =
                first + self.ungrouped[first..].partition_point(|&p| (p as usize) < end_pixel);
            first = band.end;
        }
        let pixels = &self.ungrouped;
        let images = cloud
            .points()
            .chunks(n_pixels)
            .zip(self.cluster_of.chunks_mut(n_pixels));
        let bands = self.bands.iter_mut().zip(images).zip(0..);
        for_each(parallelism, bands, |((band, (points, labels)), number)| {
            let pixels = &pixels[band.first..band.end];
            band.label(points, cloud.width(), pixels, number * n_pixels, labels);
        });
    }

    /// Merge the bands along their seams, after their labels are made unique in the image.
    fn merge_seams(&mut self, cloud: &OrganizedCloud<'_>, n_rows: usize) {
        let Self {
            cluster_of,
            bands,
            parents,
            ungrouped,
            ..
        } = self;
        parents.clear();
        for band in bands.iter() {
            let n_before = parents.len() as u32;
            parents.extend(band.parents.iter().map(|parent| n_before + parent));
            for &pixel in &ungrouped[band.first..band.end] {
                cluster_of[pixel as usize] += n_before;
            }
        }
        let width = cloud.width();
        for (number, band) in bands.iter().enumerate().skip(1) {
            let top = number * n_rows;
            let end = (top + LINKS.reach_px) * width;
            let pixels = ungrouped[band.first..band.end].iter();
            for pixel in pixels.map(|&p| p as usize).take_while(|&p| p < end) {
                let link = LinkTest::of(cloud.points(), cluster_of, pixel);
                let above = link.first_label(pixel, width, LINKS.reach_px);
                let mut own = united_label(parents, cluster_of[pixel], above);
                if pixel < (top + 1) * width {
                    for diagonal in diagonals(pixel, width, pixel % width) {
                        own = united_label(parents, own, link.label(diagonal));
                    }
                }
            }
        }
    }
}

impl Band {
    /// Label the pixels of the band; `points` and `labels` cover the band only, `start` is
    /// the index of its first pixel in the image.
    fn label(
        &mut self,
        points: &[Point],
        width: usize,
        pixels: &[u32],
        start: usize,
        labels: &mut [u32],
    ) {
        self.parents.clear();
        let (mut row, mut row_start) = (0, 0);
        for &pixel in pixels {
            let pixel = pixel as usize - start;
            while pixel >= row_start + width {
                row_start += width;
                row += 1;
            }
            let column = pixel - row_start;
            let link = LinkTest::of(points, labels, pixel);
            let is_inner = row > 0 && column > 0 && column + 1 < width;
            labels[pixel] = if is_inner && link.is_surrounded(pixel, width) {
                labels[pixel - 1]
            } else {
                self.linked_label(points, width, labels, [column, row])
            };
        }
    }

    /// Label of a pixel: that of its linked neighbours to the left and above, whose components
    /// are united, or a new one.
    fn linked_label(
        &mut self,
        points: &[Point],
        width: usize,
        labels: &[u32],
        [column, row]: [usize; 2],
    ) -> u32 {
        let parents = &mut self.parents;
        let pixel = row * width + column;
        let link = LinkTest::of(points, labels, pixel);
        let left = link.first_label(pixel, 1, LINKS.reach_px.min(column));
        let above = link.first_label(pixel, width, LINKS.reach_px.min(row));
        let mut own = united_label(parents, left, above);
        if row > 0 {
            for diagonal in diagonals(pixel, width, column) {
                // Usually the label is the same already, and no distance is needed.
                if labels[diagonal] != own {
                    own = united_label(parents, own, link.label(diagonal));
                }
            }
        }
        if own == NO_CLUSTER {
            own = parents.len() as u32;
            parents.push(own);
        }
        own
    }
}

/// Diagonal neighbours in the row above, left and right.
#[inline]
fn diagonals(pixel: usize, width: usize, column: usize) -> impl Iterator<Item = usize> {
    let left = (column > 0).then(|| pixel - width - 1);
    let right = (column + 1 < width).then(|| pixel - width + 1);
    left.into_iter().chain(right)
}

/// Link test between a pixel and its neighbours.
struct LinkTest<'a> {
    points: &'a [Point],
    labels: &'a [u32],
    point: Point,
    squared_max: f32,
}

impl<'a> LinkTest<'a> {
    /// Link test of a pixel with its neighbours.
    #[inline]
    fn of(points: &'a [Point], labels: &'a [u32], pixel: usize) -> Self {
        let point = points[pixel];
        Self {
            points,
            labels,
            point,
            squared_max: LINKS.squared_max(point.z),
        }
    }

    /// Label of a neighbour when it is linked, else [`NO_CLUSTER`].
    #[inline]
    fn label(&self, neighbour: usize) -> u32 {
        let label = self.labels[neighbour];
        if label != NO_CLUSTER && self.is_linked(neighbour) {
            label
        } else {
            NO_CLUSTER
        }
    }

    /// `true` when the neighbours to the left and above and the diagonal ones have the same
    /// label, and the former two are linked: then the pixel has that label too. So it is for
    /// most pixels.
    #[inline]
    fn is_surrounded(&self, pixel: usize, width: usize) -> bool {
        let above = pixel - width;
        let near = [pixel - 1, above, above - 1, above + 1];
        let labels = near.map(|near| self.labels[near]);
        labels[0] != NO_CLUSTER
            && labels[1..].iter().all(|label| *label == labels[0])
            && self.is_linked(near[0])
            && self.is_linked(near[1])
    }

    /// `true` when a neighbour is near enough in space.
    #[inline]
    fn is_linked(&self, neighbour: usize) -> bool {
        squared_distance(&self.point, &self.points[neighbour]) <= self.squared_max
    }

    /// Label of the first linked one of `n` neighbours at multiples of `step` before the
    /// pixel.
    #[inline]
    fn first_label(&self, mut pixel: usize, step: usize, n: usize) -> u32 {
        for _ in 0..n {
            pixel -= step;
            let label = self.label(pixel);
            if label != NO_CLUSTER {
                return label;
            }
        }
        NO_CLUSTER
    }
}

/// Union of the components of two labels, either of which may be [`NO_CLUSTER`].
#[inline]
fn united_label(parents: &mut [u32], a: u32, b: u32) -> u32 {
    if a == NO_CLUSTER || a == b {
        b
    } else if b == NO_CLUSTER {
        a
    } else {
        union(parents, a, b)
    }
}
