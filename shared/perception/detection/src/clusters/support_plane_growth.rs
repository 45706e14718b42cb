//! Growth to the support plane: adds the base of an object, which is too low for the prism.

use super::{Clusters, NO_CLUSTER};

/// Greatest growth of a cluster in the image, pixels. Chosen.
const BASE_PX: usize = 6;

impl Clusters {
    /// Grow each cluster from its pixels by `step`, the neighbour towards the table, while
    /// `is_base(next, previous)` holds and the next pixel has no cluster.
    pub(crate) fn grow_to_support_plane(
        &mut self,
        step: isize,
        is_base: impl Fn(usize, usize) -> bool,
    ) {
        let Self {
            cluster_of,
            starts,
            pixels,
            front,
            grown,
            ..
        } = self;
        grown.clear();
        let mut first = 0;
        for (cluster, end) in (0..).zip(starts.iter_mut().skip(1)) {
            let own = &pixels[first..*end as usize];
            first = *end as usize;
            front.clear();
            for &pixel in own {
                let mut pixel = pixel as usize;
                for _ in 0..BASE_PX {
                    let next = pixel.wrapping_add_signed(step);
                    if cluster_of.get(next) != Some(&NO_CLUSTER) || !is_base(next, pixel) {
                        break;
                    }
                    pixel = next;
                    cluster_of[pixel] = cluster;
                    front.push(pixel as u32);
                }
            }
            front.sort_unstable();
            merge(own, front, grown);
            *end = grown.len() as u32;
        }
        std::mem::swap(pixels, grown);
    }
}

/// Append two sorted lists in sorted order, of which the second is short and both have no value
/// in common.
fn merge(mut long: &[u32], short: &[u32], merged: &mut Vec<u32>) {
    for &value in short {
        let (before, after) = long.split_at(long.partition_point(|&other| other < value));
        merged.extend_from_slice(before);
        merged.push(value);
        long = after;
    }
    merged.extend_from_slice(long);
}
