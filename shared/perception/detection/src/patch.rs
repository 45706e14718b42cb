//! Cluster patch: a cluster copied into an image of its own.

use crate::clusters::NO_CLUSTER;
use point_cloud::{OrganizedCloud, Point};

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
        let first_row = cluster
            .first()
            .map_or(0, |&pixel| pixel as usize / image_width);
        let mut row_start = first_row * image_width;
        let (mut row, mut columns) = (MARGIN_PX, [u32::MAX, 0]);
        self.pixels.clear();
        self.pixels.extend(cluster.iter().map(|&pixel| {
            while pixel as usize >= row_start + image_width {
                row_start += image_width;
                row += 1;
            }
            let column = pixel - row_start as u32;
            columns = [columns[0].min(column), columns[1].max(column)];
            PatchPixel {
                index: 0,
                row: row as u32,
                column,
                z: 0.0,
            }
        }));
        let shift = MARGIN_PX as u32;
        self.width = (columns[1] + 1).saturating_sub(columns[0]) as usize + 2 * MARGIN_PX;
        let n_cells = (row + 1 + MARGIN_PX) * self.width;
        self.points
            .resize(n_cells.max(self.points.len()), Point::default());
        self.part_of.clear();
        self.part_of.resize(n_cells, NO_CLUSTER);
        for (own, &pixel) in self.pixels.iter_mut().zip(cluster) {
            let point = &cloud.points()[pixel as usize];
            own.column = own.column - columns[0] + shift;
            own.index = own.row * self.width as u32 + own.column;
            own.z = point.z;
            self.points[own.index as usize] = *point;
            self.part_of[own.index as usize] = UNASSIGNED;
        }
    }
}
