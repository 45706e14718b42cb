//! Cluster patch: a cluster copied into an image of its own.

use crate::clusters::NO_CLUSTER;
use point_cloud::{OrganizedCloud, Point};
use std::ops::Range;

/// Label of a patch pixel that belongs to the cluster but to no part yet.
pub(crate) const UNASSIGNED: u32 = u32::MAX - 1;

/// Empty margin around the cluster, pixels, so that neighbour access up to this distance
/// needs no bounds check.
pub(crate) const MARGIN_PX: usize = 3;

/// Cluster patch: the image region of a cluster, copied so that neighbour access stays in
/// the nearest caches. Reused from cluster to cluster.
#[derive(Debug, Default)]
pub(crate) struct Patch {
    /// Row stride of the patch, pixels.
    pub(crate) width: usize,
    /// Pixels of the cluster in image order.
    pub(crate) pixels: Vec<PatchPixel>,
    /// Per index: the point; stale outside of the cluster.
    pub(crate) points: Vec<Point>,
    /// Per index: [`NO_CLUSTER`], [`UNASSIGNED`] or the number of its part.
    pub(crate) part_of: Vec<u32>,
}

/// Pixel of a cluster patch.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PatchPixel {
    /// Index of the pixel in the patch.
    pub(crate) index: u32,
    pub(crate) row: u32,
    pub(crate) column: u32,
    /// Depth of the pixel, metres.
    pub(crate) z: f32,
}

impl Patch {
    /// Copy a cluster, given by its pixels in image order.
    pub(crate) fn copy_cluster(&mut self, cloud: &OrganizedCloud<'_>, cluster: &[u32]) {
        let image_width = cloud.width();
        let (columns, rows) = pixel_range(cluster, image_width);
        self.width = columns.len() + 2 * MARGIN_PX;
        let n_cells = (rows.len() + 2 * MARGIN_PX) * self.width;
        self.points
            .resize(n_cells.max(self.points.len()), Point::default());
        self.part_of.clear();
        self.part_of.resize(n_cells, NO_CLUSTER);
        let (points, part_of) = (self.points.as_mut_slice(), self.part_of.as_mut_slice());
        let (mut row, mut row_start) = (MARGIN_PX, rows.start * image_width);
        self.pixels.clear();
        self.pixels.extend(cluster.iter().map(|&pixel| {
            while pixel as usize >= row_start + image_width {
                row_start += image_width;
                row += 1;
            }
            let column = pixel as usize - row_start - columns.start + MARGIN_PX;
            let index = row * self.width + column;
            let point = &cloud.points()[pixel as usize];
            points[index] = *point;
            part_of[index] = UNASSIGNED;
            PatchPixel {
                index: index as u32,
                row: row as u32,
                column: column as u32,
                z: point.z,
            }
        }));
    }
}

/// Columns and rows of a cluster in the image, given by its pixels in image order.
fn pixel_range(cluster: &[u32], image_width: usize) -> (Range<usize>, Range<usize>) {
    let [Some(&first), Some(&last)] = [cluster.first(), cluster.last()] else {
        return (0..0, 0..0);
    };
    let rows = first as usize / image_width..last as usize / image_width + 1;
    let (mut columns, mut others) = (image_width..0, cluster);
    for row in rows.clone() {
        let row_start = row * image_width;
        let n = others.partition_point(|&pixel| (pixel as usize) < row_start + image_width);
        let own;
        (own, others) = others.split_at(n);
        // The outermost pixels of the row.
        if let (Some(&first), Some(&last)) = (own.first(), own.last()) {
            columns.start = columns.start.min(first as usize - row_start);
            columns.end = columns.end.max(last as usize - row_start + 1);
        }
    }
    (columns, rows)
}
