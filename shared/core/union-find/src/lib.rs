//! Union-find: a forest of disjoint sets over the elements 0 to n - 1 (Galler and Fischer 1964).
//!
//! The forest is a slice with the parent of each element; a root is its own parent. The root of
//! a set is its least element, so that it does not depend on the order of unions. The slice is
//! the caller's, who reuses it.
//!
//! # Example
//!
//! ```
//! use union_find::{find_root, union};
//!
//! let mut parents: Vec<u32> = (0..5).collect();
//! union(&mut parents, 4, 2);
//! union(&mut parents, 4, 1);
//! assert_eq!(find_root(&mut parents, 2), 1);
//! assert_eq!(find_root(&mut parents, 3), 3);
//! ```

/// Union of the sets of two elements; returns the root.
///
/// # Panics
/// When an element is not in the forest.
#[inline]
pub fn union(parents: &mut [u32], a: u32, b: u32) -> u32 {
    let (a, b) = (find_root(parents, a), find_root(parents, b));
    let (first, second) = (a.min(b), a.max(b));
    parents[second as usize] = first;
    first
}

/// Root of an element's set, with path halving.
///
/// # Panics
/// When the element is not in the forest.
#[inline]
pub fn find_root(parents: &mut [u32], mut element: u32) -> u32 {
    while parents[element as usize] != element {
        parents[element as usize] = parents[parents[element as usize] as usize];
        element = parents[element as usize];
    }
    element
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn union_find_has_the_sets_of_a_relabelling(
            unions in prop::collection::vec((0..20_u32, 0..20_u32), 0..30),
        ) {
            let mut parents: Vec<u32> = (0..20).collect();
            let mut labels = parents.clone();
            for (a, b) in unions {
                let root = union(&mut parents, a, b);
                let [a, b] = [labels[a as usize], labels[b as usize]];
                for label in labels.iter_mut().filter(|label| [a, b].contains(label)) {
                    *label = a.min(b);
                }
                prop_assert_eq!(root, a.min(b));
            }
            let roots: Vec<u32> = (0..20).map(|i| find_root(&mut parents, i)).collect();
            prop_assert_eq!(roots, labels);
        }
    }
}
