//! Cell image: the clustered pixels at about half the resolution of a Kinect, in which objects are
//! separated.

use crate::clusters::{Clusters, NO_CLUSTER};
use point_cloud::{OrganizedCloud, Point};

/// Target number of cells of an image.
const N_CELLS_TARGET: f64 = 76_800.0;

/// Empty margin around the image, cells, so that neighbour access up to this distance needs
/// no bounds check.
pub(crate) const MARGIN: usize = 6;

/// Greatest depth step within a cell, metres at 1 m, growing with squared depth. Of a cell on
/// an occlusion boundary the nearer surface counts. Chosen.
pub(super) const STEP_M: f32 = 0.012;

/// Number of a cell without clustered pixels.
pub(crate) const NO_CELL: u32 = u32::MAX;

/// Image of the clustered pixels in square cells. Reused from frame to frame.
///
/// Arrays are row-major, with a margin of [`MARGIN`] cells on each side, and cover only the rows
/// with clustered pixels.
#[derive(Debug, Default)]
pub(crate) struct CellImage {
    /// Side of a cell, pixels.
    pub(crate) stride_px: usize,
    /// Cells of a row, with both margins.
    pub(crate) width: usize,
    /// Cells of a column, with both margins.
    pub(crate) height: usize,
    /// First row of cells of the whole image that is covered.
    first_row: usize,
    /// Inverse depth of each place, 1/metre; 0 without a cell.
    pub(crate) inverse_depth: Vec<f32>,
    /// Lightness, red minus green, and yellow minus blue of each place; 0 without a cell. A
    /// channel is 0 to 1.
    pub(crate) colors: [Vec<f32>; 3],
    /// Number of the cell at each place, or [`NO_CELL`].
    pub(crate) number_of: Vec<u32>,
    /// Cluster of each place, or [`NO_CLUSTER`].
    pub(crate) cluster_of: Vec<u32>,
    /// Cells in image order.
    pub(crate) cells: Vec<Cell>,
    /// Place of the first column of cells, less the margin, of each row of pixels.
    row_place: Vec<u32>,
    /// Column of cells, with the margin, of each column of pixels.
    column_of: Vec<u32>,
    /// Sums of the cells of one row.
    sums: Vec<CellSum>,
}

/// Cell with clustered pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cell {
    /// Place in the arrays of the image.
    pub(crate) place: u32,
    /// Pixel of the cloud that stands for the cell.
    pub(crate) pixel: u32,
    /// Cluster of that pixel.
    pub(crate) cluster: u32,
    pub(crate) n_pixels: u32,
    /// Mean depth, metres.
    pub(crate) depth_m: f32,
    /// Mean colour, 0 to 255 per channel.
    pub(crate) rgb: [u8; 3],
}

/// Sums of the pixels of a cell on its nearest surface.
#[derive(Debug, Clone, Copy, Default)]
struct CellSum {
    n: u32,
    pixel: u32,
    nearest_m: f32,
    depth_m: f32,
    rgb: [u32; 3],
}

impl CellSum {
    /// Add a pixel, unless it is on a farther surface; a nearer surface replaces the others.
    #[inline]
    fn add(&mut self, pixel: u32, point: &Point) {
        let step_m = STEP_M * point.z * point.z;
        if self.n == 0 || point.z < self.nearest_m - step_m {
            *self = Self {
                pixel,
                nearest_m: point.z,
                ..Self::default()
            };
        } else if point.z > self.nearest_m + step_m {
            return;
        }
        self.n += 1;
        self.depth_m += point.z;
        for (sum, value) in self.rgb.iter_mut().zip(point.color.rgb()) {
            *sum += u32::from(value);
        }
    }
}

impl CellImage {
    /// Copy the pixels of the clusters into cells.
    pub(crate) fn refill(&mut self, cloud: &OrganizedCloud<'_>, clusters: &Clusters) {
        self.cover(cloud, clusters);
        self.clear();
        let mut last = None;
        for (row, pixels) in clusters.pixel_rows(cloud.width()) {
            let row_place = self.row_place[row - self.first_row * self.stride_px];
            if let Some(last) = last.filter(|last| *last != row_place) {
                self.finish_row(last, clusters);
            }
            last = Some(row_place);
            for &pixel in pixels {
                if clusters.cluster_of[pixel as usize] != NO_CLUSTER {
                    let column = self.column_of[pixel as usize - row * cloud.width()];
                    let point = &cloud.points()[pixel as usize];
                    self.sums[column as usize].add(pixel, point);
                }
            }
        }
        if let Some(last) = last {
            self.finish_row(last, clusters);
        }
    }

    /// Image of all pixels of a cloud, in the clusters that they form.
    #[cfg(test)]
    pub(crate) fn of_cloud(cloud: &OrganizedCloud<'_>) -> Self {
        let pixels: Vec<u32> = (0..cloud.points().len() as u32).collect();
        let mut clusters = Clusters::default();
        clusters.label_components(cloud, &crate::parallelism::Sequential, &pixels, 1);
        let mut image = Self::default();
        image.refill(cloud, &clusters);
        image
    }

    /// Place of the cell of a pixel of the cloud.
    #[inline]
    pub(crate) fn place_of(&self, column: usize, row: usize) -> usize {
        let row_place = self.row_place[row - self.first_row * self.stride_px];
        (row_place + self.column_of[column]) as usize
    }

    /// Column and row of the first pixel of a place within the margins.
    #[inline]
    pub(crate) fn first_pixel(&self, place: usize) -> [usize; 2] {
        let [column, row] = [place % self.width - MARGIN, place / self.width - MARGIN];
        [column, row + self.first_row].map(|at| at * self.stride_px)
    }

    /// Width of a cell, metres at 1 m, from the tangent of the angle between neighbouring pixels.
    pub(crate) fn pitch(&self, pixel_pitch: f32) -> f32 {
        pixel_pitch * self.stride_px as f32
    }

    /// Number of places, with those of the margins.
    pub(crate) fn n_places(&self) -> usize {
        self.width * self.height
    }

    /// Set the size to the rows of cells with clustered pixels.
    fn cover(&mut self, cloud: &OrganizedCloud<'_>, clusters: &Clusters) {
        let stride = (cloud.points().len() as f64 / N_CELLS_TARGET)
            .sqrt()
            .round();
        let stride = (stride as usize).max(1);
        let row =
            |pixel: Option<&u32>| pixel.map_or(0, |&pixel| pixel as usize / cloud.width() / stride);
        let pixels = clusters.labelled();
        let rows = [row(pixels.first()), row(pixels.last())];
        self.stride_px = stride;
        self.first_row = rows[0];
        self.width = cloud.width().div_ceil(stride) + 2 * MARGIN;
        self.height = rows[1] - rows[0] + 1 + 2 * MARGIN;
        let n_rows_px = (rows[1] - rows[0] + 1) * stride;
        let row_place = (0..n_rows_px).map(|row| ((row / stride + MARGIN) * self.width) as u32);
        self.row_place.clear();
        self.row_place.extend(row_place);
        let column_of = (0..cloud.width()).map(|column| (column / stride + MARGIN) as u32);
        self.column_of.clear();
        self.column_of.extend(column_of);
    }

    /// Empty all places.
    fn clear(&mut self) {
        let n_places = self.n_places();
        for values in self.colors.iter_mut().chain([&mut self.inverse_depth]) {
            values.clear();
            values.resize(n_places, 0.0);
        }
        self.number_of.clear();
        self.number_of.resize(n_places, NO_CELL);
        self.cluster_of.clear();
        self.cluster_of.resize(n_places, NO_CLUSTER);
        self.cells.clear();
        self.sums.clear();
        self.sums.resize(self.width, CellSum::default());
    }

    /// List the cells of a row, write them into the arrays, and reset the sums.
    fn finish_row(&mut self, row_place: u32, clusters: &Clusters) {
        let [lightness, red_green, yellow_blue] = &mut self.colors;
        for (place, sum) in (row_place..).zip(&mut self.sums) {
            if sum.n == 0 {
                continue;
            }
            let sum = std::mem::take(sum);
            let n = sum.n as f32;
            let at = place as usize;
            let [r, g, b] = sum.rgb.map(|value| value as f32 / (255.0 * n));
            self.inverse_depth[at] = n / sum.depth_m;
            lightness[at] = (r + g + b) / 3.0;
            red_green[at] = r - g;
            yellow_blue[at] = 0.5 * (r + g) - b;
            self.number_of[at] = self.cells.len() as u32;
            let cluster = clusters.cluster_of[sum.pixel as usize];
            self.cluster_of[at] = cluster;
            self.cells.push(Cell {
                place,
                pixel: sum.pixel,
                cluster,
                n_pixels: sum.n,
                depth_m: sum.depth_m / n,
                rgb: sum.rgb.map(|value| (value / sum.n) as u8),
            });
        }
    }
}
