//! Union-find (disjoint sets).

/// Disjoint sets of the integers from 0 to `n` - 1.
pub(crate) struct UnionFind {
    parent: Vec<u32>,
    is_used: Vec<bool>,
}

impl UnionFind {
    /// Union-find structure of `n` sets with one element each.
    pub(crate) fn new(n: usize) -> Self {
        Self {
            parent: (0..n as u32).collect(),
            is_used: vec![false; n],
        }
    }

    /// Representative of an element's set, with path halving.
    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    /// Merges the sets of two elements.
    pub(crate) fn union(&mut self, a: u32, b: u32) {
        self.is_used[a as usize] = true;
        self.is_used[b as usize] = true;
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a as usize] = b;
    }

    /// Number of sets, without elements that were never united with any.
    pub(crate) fn n_components(&self) -> usize {
        let is_root = |&i: &usize| self.is_used[i] && self.parent[i] == i as u32;
        (0..self.parent.len()).filter(is_root).count()
    }
}
