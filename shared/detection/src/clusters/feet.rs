//! The foot of an object: too near to the table to be told from it by itself.

use super::{Clusters, OUTSIDE};

/// A foot is at most this high in the image, pixels.
const FOOT_PX: usize = 6;

impl Clusters {
    /// Lets each cluster grow from its pixels by `step`, the neighbour towards
    /// the table, while `is_foot` holds for what no cluster has.
    pub(crate) fn grow_feet(&mut self, step: isize, is_foot: impl Fn(usize) -> bool) {
        let n_grouped = self.pixels.len();
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(&self.pixels);
        for i in 0..n_grouped {
            let mut pixel = self.pixels[i] as usize;
            let cluster = self.cluster_of[pixel];
            for _ in 0..FOOT_PX {
                pixel = pixel.wrapping_add_signed(step);
                if self.cluster_of.get(pixel) != Some(&OUTSIDE) || !is_foot(pixel) {
                    break;
                }
                self.cluster_of[pixel] = cluster;
                self.ungrouped.push(pixel as u32);
            }
        }
        if self.ungrouped.len() > n_grouped {
            self.ungrouped.sort_unstable();
            self.parents.clear();
            self.parents.extend(0..self.len() as u32);
            self.number_large(1);
            self.group();
        }
    }
}
