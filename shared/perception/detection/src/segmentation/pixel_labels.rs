//! Pixel labels: each clustered pixel takes the object of its cell.

use super::cell_image::{CellImage, STEP_M};
use crate::clusters::Clusters;
use point_cloud::OrganizedCloud;

/// Depth of a pixel from that of all cells around it, in greatest steps within a cell, beyond
/// which it belongs to none of them. Chosen.
const OUTLIER_STEPS: f32 = 1.5;

/// Object of each cell, and of each cluster that is not divided. Reused from frame to frame.
#[derive(Debug, Default)]
pub(super) struct CellLabels {
    /// Per cell: the new cluster.
    pub(super) of_cell: Vec<u32>,
    /// Per cluster: the new cluster of all its cells, or [`NO_CLUSTER`](crate::clusters::NO_CLUSTER)
    /// when it is divided.
    pub(super) of_cluster: Vec<u32>,
}

impl CellLabels {
    /// Give the pixels of the clusters the `n_labels` new clusters of their cells.
    ///
    /// On an occlusion boundary, where a cell shows the nearer surface, a pixel of the farther one
    /// takes that of the neighbouring cell of its own cluster of nearest depth. A pixel without such a cell
    /// keeps to its cluster if this is not divided, as in a strip that is narrower than a cell;
    /// otherwise it is noise and leaves the clusters.
    pub(super) fn relabel(
        &self,
        clusters: &mut Clusters,
        n_labels: usize,
        cloud: &OrganizedCloud<'_>,
        image: &CellImage,
    ) {
        clusters.relabel(cloud.width(), n_labels, |pixel| {
            let z = cloud.points()[pixel.index].z;
            let step_m = STEP_M * z * z;
            let place = image.place_of(pixel.column, pixel.row);
            let miss_m = |place: usize| {
                if image.cluster_of[place] == pixel.cluster {
                    (image.cells[image.number_of[place] as usize].depth_m - z).abs()
                } else {
                    f32::INFINITY
                }
            };
            let mut nearest = (miss_m(place), place);
            if nearest.0 > step_m {
                let [above, below] = [place - image.width, place + image.width];
                for other in [place, above, below]
                    .into_iter()
                    .flat_map(|row| row - 1..=row + 1)
                {
                    let miss_m = miss_m(other);
                    if miss_m < nearest.0 {
                        nearest = (miss_m, other);
                    }
                }
            }
            if nearest.0 <= OUTLIER_STEPS * step_m {
                self.of_cell[image.number_of[nearest.1] as usize]
            } else {
                self.of_cluster[pixel.cluster as usize]
            }
        });
    }
}
