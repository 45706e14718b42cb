//! Growth to the support plane: adds the base of an object, which is too low for the prism.

use super::{Clusters, NO_CLUSTER};

/// Greatest growth of a cluster in the image, pixels. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const BASE_PX: usize = 6;

impl Clusters {
    /// Grow each cluster from its pixels by `step`, the neighbour towards the table, while
    /// `is_base(next, previous)` holds and the next pixel has no cluster. `joined` are the
    /// pixels from which the clusters were labelled, in image order.
    pub(crate) fn grow_to_support_plane(
        &mut self,
        joined: &[u32],
        step: isize,
        is_base: impl Fn(usize, usize) -> bool,
    ) {
        self.front.clear();
        for &pixel in &self.pixels {
            let mut pixel = pixel as usize;
            let cluster = self.cluster_of[pixel];
            for _ in 0..BASE_PX {
                let next = pixel.wrapping_add_signed(step);
                if self.cluster_of.get(next) != Some(&NO_CLUSTER) || !is_base(next, pixel) {
                    break;
                }
                pixel = next;
                self.cluster_of[pixel] = cluster;
                self.front.push(pixel as u32);
            }
        }
        if self.front.is_empty() {
            return;
        }
        self.front.sort_unstable();
        self.merge_into_ungrouped(joined);
        self.parents.clear();
        self.parents.extend(0..self.len() as u32);
        self.number_large_components(1);
        self.sort_by_cluster();
    }

    /// Merge the clustered ones of `joined` with the grown pixels, in image order, into the
    /// list to be sorted by cluster.
    fn merge_into_ungrouped(&mut self, joined: &[u32]) {
        let Self {
            ungrouped,
            cluster_of,
            front,
            ..
        } = self;
        ungrouped.clear();
        let mut base_pixels = front.iter().copied().peekable();
        for &pixel in joined {
            while let Some(base_pixel) = base_pixels.next_if(|&base_pixel| base_pixel < pixel) {
                ungrouped.push(base_pixel);
            }
            // Pixels of dropped small clusters were listed too, and may have become base
            // pixels.
            let is_base = base_pixels.next_if_eq(&pixel).is_some();
            if is_base || cluster_of[pixel as usize] != NO_CLUSTER {
                ungrouped.push(pixel);
            }
        }
        ungrouped.extend(base_pixels);
    }
}
