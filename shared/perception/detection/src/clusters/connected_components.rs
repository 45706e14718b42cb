//! Joining pixels to clusters, band by band of the image.
//!
//! The bands know nothing of each other, so that several threads can join; then the
//! bands are joined along their seams. Clusters are what the links connect, in
//! whatever order these are followed.

use super::{Clusters, LINKS, NO_CLUSTER, squared_distance, union};
use crate::parallelism::{Crew, for_each};
use point_cloud::{OrganizedCloud, Point};

/// So many bands, where the image has the rows.
const N_BANDS: usize = 8;

/// PointLabels of a band's pixels.
#[derive(Debug, Default)]
pub(super) struct Band {
    /// Where its pixels are among those that are joined.
    first: usize,
    end: usize,
    /// Per label: the label it was joined with; a root is its own parent.
    parents: Vec<u32>,
}

impl Clusters {
    /// Joins pixels, given in image order, to clusters of neighbours link in
    /// space; those with fewer than `n_min` pixels are left out.
    ///
    /// Union-find in one pass over the pixels (after Wu, Otoo and Suzuki 2009).
    pub(crate) fn label_components(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        parallelism: &dyn Crew,
        pixels: &[u32],
        n_min: u32,
    ) {
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(pixels);
        let n_rows = cloud.height().div_ceil(N_BANDS).max(LINKS.reach_px);
        self.label_bands(cloud, parallelism, n_rows);
        self.merge_seams(cloud, n_rows);
        self.number_large_components(n_min);
        self.sort_by_cluster();
    }

    /// Gives each pixel the label of its cluster within its band of so many rows.
    fn label_bands(&mut self, cloud: &OrganizedCloud<'_>, parallelism: &dyn Crew, n_rows: usize) {
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
        self.cluster_of.resize(cloud.points().len(), NO_CLUSTER);
        let pixels = &self.ungrouped;
        let images = cloud
            .points()
            .chunks(n_pixels)
            .zip(self.cluster_of.chunks_mut(n_pixels));
        let bands = self.bands.iter_mut().zip(images).zip(0..);
        for_each(parallelism, bands, |((band, (points, labels)), number)| {
            labels.fill(NO_CLUSTER);
            let pixels = &pixels[band.first..band.end];
            band.label(points, cloud.width(), pixels, number * n_pixels, labels);
        });
    }

    /// Joins the bands where they meet, after their labels have become those of the
    /// whole image.
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
    /// Joins the pixels of the band; `points` and `labels` are of the band alone, and
    /// its first pixel is the `start`-th of the image.
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
            self.link_pixel(points, width, labels, [pixel - row_start, row]);
        }
    }

    /// Gives a pixel the label of the neighbours before it that are link in
    /// space, or a new one.
    #[inline]
    fn link_pixel(
        &mut self,
        points: &[Point],
        width: usize,
        labels: &mut [u32],
        [column, row]: [usize; 2],
    ) {
        let parents = &mut self.parents;
        let pixel = row * width + column;
        let link = LinkTest::of(points, labels, pixel);
        let left = link.first_label(pixel, 1, LINKS.reach_px.min(column));
        let above = link.first_label(pixel, width, LINKS.reach_px.min(row));
        let mut own = united_label(parents, left, above);
        if row > 0 {
            for diagonal in diagonals(pixel, width, column) {
                // Mostly it has the same label already, and no distance is needed.
                if labels[diagonal] != own {
                    own = united_label(parents, own, link.label(diagonal));
                }
            }
        }
        if own == NO_CLUSTER {
            own = parents.len() as u32;
            parents.push(own);
        }
        labels[pixel] = own;
    }
}

/// The neighbours in the row above, on the left and on the right.
#[inline]
fn diagonals(pixel: usize, width: usize, column: usize) -> impl Iterator<Item = usize> {
    let left = (column > 0).then(|| pixel - width - 1);
    let right = (column + 1 < width).then(|| pixel - width + 1);
    left.into_iter().chain(right)
}

/// What is asked about the neighbours of a point.
struct LinkTest<'a> {
    points: &'a [Point],
    labels: &'a [u32],
    point: Point,
    squared_max: f32,
}

impl<'a> LinkTest<'a> {
    /// Of a pixel.
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

    /// The label of a neighbour that is linked; [`NO_CLUSTER`] for others.
    #[inline]
    fn label(&self, neighbour: usize) -> u32 {
        let label = self.labels[neighbour];
        let squared_distance = squared_distance(&self.point, &self.points[neighbour]);
        if label != NO_CLUSTER && squared_distance <= self.squared_max {
            label
        } else {
            NO_CLUSTER
        }
    }

    /// The label of the first linked one of `n` neighbours, each `step` before the
    /// last.
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

/// Joins the clusters of two labels, either of which may be none.
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
