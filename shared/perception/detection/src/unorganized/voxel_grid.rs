//! Hashed voxel grid with point sums.

use super::label_groups::UNLABELLED;

/// Greatest absolute coordinate of a point, metres; it bounds the voxel keys.
pub(super) const REACH_M: f32 = 100.0;

/// Greatest number of voxels; a cloud that fills more gets larger ones.
const N_VOXELS_MAX: usize = 1 << 21;

/// Bits per axis of a voxel key.
const AXIS_BITS: u32 = 21;

/// Empty voxels around the reach, so that neighbour keys need no check.
const MARGIN: u64 = 1;

/// Steps to one half of the 26 neighbours; the opposite steps lead to the other half.
const HALF_NEIGHBOURS: [[i64; 3]; 13] = [
    [1, 0, 0],
    [-1, 1, 0],
    [0, 1, 0],
    [1, 1, 0],
    [-1, -1, 1],
    [0, -1, 1],
    [1, -1, 1],
    [-1, 0, 1],
    [0, 0, 1],
    [1, 0, 1],
    [-1, 1, 1],
    [0, 1, 1],
    [1, 1, 1],
];

/// Hashed voxel grid with open addressing. Voxels are numbered in the order of their first
/// points, so equal input gives equal numbers.
#[derive(Debug, Default)]
pub(super) struct VoxelGrid {
    size_m: f32,
    /// Hash table: a power of two of slots, at least half of them empty.
    slots: Vec<u32>,
    keys: Vec<u64>,
    sums: Vec<VoxelSum>,
    voxel_of: Vec<u32>,
}

/// Sum of the points of a voxel, relative to its corner.
#[derive(Debug, Clone, Copy, Default)]
struct VoxelSum {
    offset_m: [f32; 3],
    n_points: f32,
}

impl VoxelGrid {
    /// Fill the grid with `n` points. Points without a position or beyond the reach have no
    /// voxel. Voxels are `size_m` wide, or a power of two wider where there would be too
    /// many of them.
    ///
    /// O(n); memory for one index per point and at most 2^21 voxels.
    pub(super) fn fill(
        &mut self,
        n: usize,
        position: impl Fn(usize) -> Option<[f32; 3]>,
        size_m: f32,
    ) {
        self.size_m = size_m;
        while !self.try_fill(n, &position) {
            self.size_m *= 2.0;
        }
    }

    fn try_fill(&mut self, n: usize, position: &impl Fn(usize) -> Option<[f32; 3]>) -> bool {
        self.voxel_of.clear();
        self.keys.clear();
        self.sums.clear();
        self.slots.clear();
        self.slots.resize(1 << 12, UNLABELLED);
        let (mut last_key, mut last_voxel) = (u64::MAX, UNLABELLED);
        for i in 0..n {
            let Some(p) = position(i).filter(|p| p.iter().all(|x| x.abs() <= REACH_M)) else {
                self.voxel_of.push(UNLABELLED);
                continue;
            };
            let cell = p.map(|x| ((x + REACH_M) / self.size_m) as u64);
            let key = key_of(cell);
            if key != last_key {
                if self.keys.len() == N_VOXELS_MAX {
                    return false;
                }
                (last_key, last_voxel) = (key, self.voxel_or_new(key));
            }
            let sum = &mut self.sums[last_voxel as usize];
            for axis in 0..3 {
                sum.offset_m[axis] += p[axis] + REACH_M - cell[axis] as f32 * self.size_m;
            }
            sum.n_points += 1.0;
            self.voxel_of.push(last_voxel);
        }
        true
    }

    /// Side of a voxel, metres.
    pub(super) fn size_m(&self) -> f32 {
        self.size_m
    }

    /// Number of occupied voxels.
    pub(super) fn len(&self) -> usize {
        self.keys.len()
    }

    /// Voxel of each point, or [`UNLABELLED`].
    pub(super) fn voxel_of(&self) -> &[u32] {
        &self.voxel_of
    }

    /// Mean of the points of a voxel.
    pub(super) fn centroid(&self, voxel: usize) -> [f32; 3] {
        let (key, sum) = (self.keys[voxel], &self.sums[voxel]);
        std::array::from_fn(|axis| {
            let cell = ((key >> (AXIS_BITS * axis as u32)) & ((1 << AXIS_BITS) - 1)) - MARGIN;
            let corner_m = cell as f32 * self.size_m - REACH_M;
            corner_m + sum.offset_m[axis] / sum.n_points
        })
    }

    /// Occupied neighbours of a voxel, at faces, edges and corners, in the positive half
    /// space of steps.
    pub(super) fn later_neighbours(&self, voxel: usize) -> impl Iterator<Item = usize> + '_ {
        HALF_NEIGHBOURS
            .iter()
            .filter_map(move |step| self.neighbour(voxel, *step))
    }

    /// Occupied neighbours of a voxel, at faces, edges and corners, with the steps to them.
    pub(super) fn neighbours(&self, voxel: usize) -> impl Iterator<Item = (usize, [i64; 3])> + '_ {
        let before = HALF_NEIGHBOURS.iter().map(|step| step.map(|part| -part));
        before
            .chain(HALF_NEIGHBOURS)
            .filter_map(move |step| Some((self.neighbour(voxel, step)?, step)))
    }

    fn neighbour(&self, voxel: usize, [x, y, z]: [i64; 3]) -> Option<usize> {
        let step = x + (y << AXIS_BITS) + (z << (2 * AXIS_BITS));
        let found = self.slots[self.slot_of(self.keys[voxel].wrapping_add_signed(step))];
        (found != UNLABELLED).then_some(found as usize)
    }

    fn voxel_or_new(&mut self, key: u64) -> u32 {
        let slot = self.slot_of(key);
        if self.slots[slot] != UNLABELLED {
            return self.slots[slot];
        }
        let voxel = self.keys.len() as u32;
        self.slots[slot] = voxel;
        self.keys.push(key);
        self.sums.push(VoxelSum::default());
        if 2 * self.keys.len() >= self.slots.len() {
            self.grow();
        }
        voxel
    }

    fn grow(&mut self) {
        let n_slots = 2 * self.slots.len();
        self.slots.clear();
        self.slots.resize(n_slots, UNLABELLED);
        for voxel in 0..self.keys.len() {
            let slot = self.slot_of(self.keys[voxel]);
            self.slots[slot] = voxel as u32;
        }
    }

    /// Slot of a key, or the empty slot for it (linear probing).
    #[inline]
    fn slot_of(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mixed = (key ^ (key >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut slot = (mixed >> 32) as usize & mask;
        while self.slots[slot] != UNLABELLED && self.keys[self.slots[slot] as usize] != key {
            slot = (slot + 1) & mask;
        }
        slot
    }
}

#[inline]
fn key_of(cell: [u64; 3]) -> u64 {
    let [x, y, z] = cell.map(|index| index + MARGIN);
    x | y << AXIS_BITS | z << (2 * AXIS_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn voxels_are_what_a_map_of_cells_holds(
            points in prop::collection::vec(prop::array::uniform3(-0.2..0.2_f32), 1..3000),
            far in prop::collection::vec((0..3000_usize, any::<u32>()), 0..20),
        ) {
            let mut points = points;
            let n = points.len();
            for (i, bits) in far {
                points[i % n][0] = f32::from_bits(bits);
            }
            let mut voxels = VoxelGrid::default();
            voxels.fill(points.len(), |i| Some(points[i]), 0.05);
            let mut cells: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
            for (i, p) in points.iter().enumerate() {
                let inside = p.iter().all(|x| x.abs() <= REACH_M);
                prop_assert_eq!(inside, voxels.voxel_of()[i] != UNLABELLED);
                if inside {
                    cells.entry(p.map(|x| ((x + REACH_M) / 0.05) as u64)).or_default().push(i);
                }
            }
            prop_assert_eq!(voxels.len(), cells.len());
            for (cell, members) in &cells {
                let voxel = voxels.voxel_of()[members[0]] as usize;
                for (axis, found) in voxels.centroid(voxel).into_iter().enumerate() {
                    let sum: f64 = members.iter().map(|&i| f64::from(points[i][axis])).sum();
                    prop_assert!((f64::from(found) - sum / members.len() as f64).abs() < 1e-4);
                }
                let touching = |other: &[u64; 3]| {
                    other != cell && (0..3).all(|axis| other[axis].abs_diff(cell[axis]) <= 1)
                };
                let mut expected: Vec<usize> = cells
                    .iter()
                    .filter(|(other, _)| touching(other))
                    .map(|(_, members)| voxels.voxel_of()[members[0]] as usize)
                    .collect();
                let mut found: Vec<usize> = voxels.neighbours(voxel).map(|(near, _)| near).collect();
                expected.sort_unstable();
                found.sort_unstable();
                prop_assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn too_many_voxels_become_larger() {
        let n = 3_000_000;
        let at = |i: usize| {
            let part = |k: f64| ((i as f64 * k).fract() * 180.0 - 90.0) as f32;
            Some([
                part(0.618_033_988),
                part(0.414_213_562),
                part(0.732_050_807),
            ])
        };
        let mut voxels = VoxelGrid::default();
        voxels.fill(n, at, 0.005);
        assert!(voxels.len() <= N_VOXELS_MAX && voxels.size_m() > 0.005);
        assert!(
            voxels
                .voxel_of()
                .iter()
                .all(|&voxel| (voxel as usize) < voxels.len())
        );
    }
}
