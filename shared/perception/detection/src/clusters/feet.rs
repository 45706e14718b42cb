//! The foot of an object: too near to the table to be told from it by itself.

use super::{Clusters, OUTSIDE};

/// A foot is at most this high in the image, pixels.
const FOOT_PX: usize = 6;

impl Clusters {
    /// Lets each cluster grow from its pixels by `step`, the neighbour towards
    /// the table, while `is_foot` holds for what no cluster has and the pixel
    /// before. `joined` are the pixels the clusters were joined from, in image
    /// order.
    pub(crate) fn grow_feet(
        &mut self,
        joined: &[u32],
        step: isize,
        is_foot: impl Fn(usize, usize) -> bool,
    ) {
        self.front.clear();
        for &pixel in &self.pixels {
            let mut pixel = pixel as usize;
            let cluster = self.cluster_of[pixel];
            for _ in 0..FOOT_PX {
                let next = pixel.wrapping_add_signed(step);
                if self.cluster_of.get(next) != Some(&OUTSIDE) || !is_foot(next, pixel) {
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
        self.number_large(1);
        self.group();
    }

    /// Makes the clustered ones of `joined`, and the pixels of the front, the
    /// pixels to be grouped, in image order.
    fn merge_into_ungrouped(&mut self, joined: &[u32]) {
        let Self {
            ungrouped,
            cluster_of,
            front,
            ..
        } = self;
        ungrouped.clear();
        let mut feet = front.iter().copied().peekable();
        for &pixel in joined {
            while let Some(foot) = feet.next_if(|&foot| foot < pixel) {
                ungrouped.push(foot);
            }
            // Pixels of clusters too small to be kept were listed, too, and may
            // have become someone's foot.
            let is_foot = feet.next_if_eq(&pixel).is_some();
            if is_foot || cluster_of[pixel as usize] != OUTSIDE {
                ungrouped.push(pixel);
            }
        }
        ungrouped.extend(feet);
    }
}
