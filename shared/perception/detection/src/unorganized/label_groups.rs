//! Counting sort of indices into groups by label.

/// Label of a point in no pixel, voxel or cluster.
pub(super) const UNLABELLED: u32 = u32::MAX;

/// Index groups made last, with buffers.
#[derive(Debug, Default)]
pub(super) struct LabelGroups {
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl LabelGroups {
    /// Group the indices of `labels` by label below `n_groups`, ascending within each
    /// group; [`UNLABELLED`] indices are dropped.
    pub(super) fn refill(&mut self, labels: &[u32], n_groups: usize) {
        self.starts.clear();
        self.starts.resize(n_groups + 2, 0);
        for &label in labels {
            if label != UNLABELLED {
                self.starts[label as usize + 2] += 1;
            }
        }
        for group in 2..self.starts.len() {
            self.starts[group] += self.starts[group - 1];
        }
        self.members.clear();
        self.members.resize(self.starts[n_groups + 1] as usize, 0);
        for (index, &label) in (0..).zip(labels) {
            if label != UNLABELLED {
                // Write position of a group; finally the start of the next group.
                let place = &mut self.starts[label as usize + 1];
                self.members[*place as usize] = index;
                *place += 1;
            }
        }
    }

    /// Number of label groups.
    pub(super) fn len(&self) -> usize {
        self.starts.len().saturating_sub(2)
    }

    /// Members of a label group.
    pub(super) fn members(&self, group: usize) -> &[u32] {
        &self.members[self.starts[group] as usize..self.starts[group + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn groups_hold_the_indices_of_their_labels(
            labels in prop::collection::vec(prop::option::of(0..7_u32), 0..200),
        ) {
            let labels: Vec<u32> = labels.iter().map(|label| label.unwrap_or(UNLABELLED)).collect();
            let mut groups = LabelGroups::default();
            for _ in 0..2 {
                groups.refill(&labels, 7);
            }
            prop_assert_eq!(groups.len(), 7);
            for group in 0..7 {
                let expected: Vec<u32> = (0..labels.len() as u32)
                    .filter(|&i| labels[i as usize] == group as u32)
                    .collect();
                prop_assert_eq!(groups.members(group), &expected[..]);
            }
        }
    }
}
