//! Stratified k-fold split of a data set, optionally grouped by object.

use crate::recogniser::{LabelledView, by_category};
use random::Random;

/// Random stream of the fold assignment.
const FOLD_STREAM: u64 = 5;

/// Assignment of a category's views to folds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FoldAssignment {
    /// Views assigned in random order, one by one.
    ByView,
    /// Grouped by object in random order: all views of an object share a fold. A category with
    /// fewer than two known objects is assigned view by view.
    ByInstance,
    /// Sides: the views of each object in contiguous slices of equal length, in their order around
    /// the object, so that each fold shows it from another side.
    BySide,
    /// Contiguous slices of equal length in the given order, the last one with the remainder; as
    /// in the public code of Kasaei's group.
    Contiguous,
}

/// Assignment of the views of a data set to folds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folds {
    /// Index of the fold in which each view is tested.
    pub of_view: Vec<u32>,
    /// Number of cross-validation folds.
    pub n_folds: u32,
    /// Number of categories grouped by object.
    pub n_grouped: usize,
}

/// Error of splitting a data set into folds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Fewer than two folds: nothing would be left for training.
    #[error("a data set cannot be cross-validated in {0} folds: choose two or more, 10 usually")]
    TooFewFolds(u32),
    /// Fewer views than folds: a fold would be empty.
    #[error("a data set of {n_views} views cannot be parted into {n_folds} folds: choose fewer")]
    TooFewViews {
        /// Number of views in the data set.
        n_views: usize,
        /// Number of requested folds.
        n_folds: u32,
    },
}

impl Folds {
    /// Splits the views of each category evenly over the folds (stratification).
    ///
    /// # Errors
    /// If there are fewer than two folds, or fewer views than folds.
    pub fn assign(
        views: &[LabelledView],
        n_folds: u32,
        dealing: FoldAssignment,
        seed: u64,
    ) -> Result<Self, Error> {
        if n_folds < 2 {
            return Err(Error::TooFewFolds(n_folds));
        }
        let n_views = views.len();
        if n_views < n_folds as usize {
            return Err(Error::TooFewViews { n_views, n_folds });
        }
        let mut folds = Self {
            of_view: vec![0; n_views],
            n_folds,
            n_grouped: 0,
        };
        let mut n_of_fold = vec![0_usize; n_folds as usize];
        for (category, of_category) in by_category(views) {
            let mut groups = match dealing {
                FoldAssignment::Contiguous => {
                    folds.assign_slices(&of_category);
                    continue;
                }
                FoldAssignment::BySide => {
                    folds.n_grouped += 1;
                    for object in by_instance(views, &of_category) {
                        folds.assign_slices(&object);
                    }
                    continue;
                }
                FoldAssignment::ByView => ungrouped(&of_category),
                FoldAssignment::ByInstance => grouped_by_instance(views, &of_category),
            };
            folds.n_grouped += usize::from(groups.iter().any(|group| group.len() > 1));
            let stream = FOLD_STREAM | u64::from(category) << 16;
            Random::substream(seed, stream).shuffle(&mut groups);
            folds.assign_groups(&groups, &mut n_of_fold);
        }
        Ok(folds)
    }

    /// Assigns each group to the fold with the fewest views of the category; ties go to the
    /// smallest fold.
    fn assign_groups(&mut self, groups: &[Vec<usize>], n_of_fold: &mut [usize]) {
        let mut n_of_category = vec![0; n_of_fold.len()];
        for group in groups {
            let folds = 0..n_of_fold.len();
            let fold = folds.min_by_key(|&fold| (n_of_category[fold], n_of_fold[fold]));
            let fold = fold.unwrap_or(0);
            n_of_category[fold] += group.len();
            n_of_fold[fold] += group.len();
            for &view in group {
                self.of_view[view] = fold as u32;
            }
        }
    }

    fn assign_slices(&mut self, views: &[usize]) {
        let length = views.len() / self.n_folds as usize;
        for (index, &view) in views.iter().enumerate() {
            // A group with fewer views than folds is tested in the last one.
            let fold = index
                .checked_div(length)
                .map_or(u32::MAX, |fold| fold as u32);
            self.of_view[view] = fold.min(self.n_folds - 1);
        }
    }
}

fn ungrouped(of_category: &[usize]) -> Vec<Vec<usize>> {
    of_category.iter().map(|&view| vec![view]).collect()
}

/// Groups views by object; if objects are unknown or there is only one, each view is a group.
fn grouped_by_instance(views: &[LabelledView], of_category: &[usize]) -> Vec<Vec<usize>> {
    let groups = by_instance(views, of_category);
    if groups.len() < 2 {
        return ungrouped(of_category);
    }
    groups
}

/// Views of each object; a view of an unknown object is a group.
fn by_instance(views: &[LabelledView], of_category: &[usize]) -> Vec<Vec<usize>> {
    let mut sorted = of_category.to_vec();
    sorted.sort_by_key(|&view| views[view].instance);
    let is_same = |a: &usize, b: &usize| {
        let (a, b) = (views[*a].instance, views[*b].instance);
        a.is_some() && a == b
    };
    sorted.chunk_by(is_same).map(<[usize]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn views(counts: &[(u32, Option<u32>, usize)]) -> Vec<LabelledView> {
        let views = |&(category, instance, n): &(u32, Option<u32>, usize)| {
            std::iter::repeat_n(LabelledView { category, instance }, n)
        };
        counts.iter().flat_map(views).collect()
    }

    /// Number of views of each category in each fold.
    fn counts(views: &[LabelledView], folds: &Folds) -> Vec<Vec<usize>> {
        let n_categories = views.iter().map(|view| view.category + 1).max().unwrap();
        let mut counts = vec![vec![0; folds.n_folds as usize]; n_categories as usize];
        for (view, &fold) in views.iter().zip(&folds.of_view) {
            counts[view.category as usize][fold as usize] += 1;
        }
        counts
    }

    #[test]
    fn folds_are_stratified_view_by_view() {
        let views = views(&[(0, None, 25), (1, None, 31), (2, None, 4)]);
        let folds = Folds::assign(&views, 10, FoldAssignment::ByView, 3).unwrap();
        for of_category in counts(&views, &folds) {
            let (least, most) = (of_category.iter().min(), of_category.iter().max());
            assert!(most.unwrap() - least.unwrap() <= 1, "{of_category:?}");
        }
        for fold in 0..10 {
            let n = folds
                .of_view
                .iter()
                .filter(|&&of_view| of_view == fold)
                .count();
            assert_eq!(n, 6);
        }
        assert_eq!(folds.n_grouped, 0);
    }

    #[test]
    fn views_of_an_object_share_a_fold() {
        let views = views(&[
            (0, Some(1), 30),
            (0, Some(2), 31),
            (0, Some(3), 29),
            (1, Some(1), 40),
            (2, None, 20),
        ]);
        let folds = Folds::assign(&views, 3, FoldAssignment::ByInstance, 1).unwrap();
        let of_first = counts(&views[..90], &folds);
        assert_eq!(of_first[0].iter().sum::<usize>(), 90);
        let mut sizes = of_first[0].clone();
        sizes.sort_unstable();
        assert_eq!(sizes, [29, 30, 31]);
        // A single object cannot be in training and test set at once.
        assert!(
            counts(&views, &folds)[1]
                .iter()
                .all(|&n| (13..=14).contains(&n))
        );
        assert!(
            counts(&views, &folds)[2]
                .iter()
                .all(|&n| (6..=7).contains(&n))
        );
        assert_eq!(folds.n_grouped, 1);
    }

    #[test]
    fn folds_by_side_share_the_views_of_each_object_in_their_order() {
        let views = views(&[(0, Some(1), 4), (0, Some(2), 5), (1, Some(1), 1)]);
        let folds = Folds::assign(&views, 2, FoldAssignment::BySide, 1).unwrap();
        assert_eq!(folds.of_view, [0, 0, 1, 1, 0, 0, 1, 1, 1, 1]);
        assert_eq!(folds.n_grouped, 2);
    }

    #[test]
    fn contiguous_slices_are_those_of_the_original() {
        let views = views(&[(0, None, 11), (1, None, 2)]);
        let folds = Folds::assign(&views, 3, FoldAssignment::Contiguous, 1).unwrap();
        assert_eq!(folds.of_view, [0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2]);
    }

    #[test]
    fn folds_depend_on_the_seed_only() {
        let views = views(&[(0, None, 50), (1, None, 50)]);
        let deal = |seed| Folds::assign(&views, 10, FoldAssignment::ByView, seed).unwrap();
        assert_eq!(deal(1), deal(1));
        assert_ne!(deal(1), deal(2));
    }

    #[test]
    fn too_few_folds_or_views_are_refused_by_a_sentence() {
        let views = views(&[(0, None, 3)]);
        for (n_folds, part) in [(1, "in 1 folds"), (4, "3 views")] {
            let error = Folds::assign(&views, n_folds, FoldAssignment::ByView, 1).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
    }
}
