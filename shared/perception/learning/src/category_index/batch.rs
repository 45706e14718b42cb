//! Batch of changes of an index.

use super::category_spreads::MembershipChange;
use super::view_table::IndexedView;
use super::{Category, CategoryIndex, new_revision};
use crate::calibration::DistanceSum;
use crate::{CategoryName, Error, ViewId};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Batch of changes of a [`CategoryIndex`]. When it is dropped, the distances within the
/// categories are brought up to date once for all changes.
#[derive(Debug)]
pub struct IndexBatch<'a> {
    index: &'a mut CategoryIndex,
    memberships: BTreeMap<CategoryName, MembershipChange>,
}

impl<'a> IndexBatch<'a> {
    pub(super) fn new(index: &'a mut CategoryIndex) -> Self {
        Self {
            index,
            memberships: BTreeMap::new(),
        }
    }

    /// Inserts a view into a category. A view with the same id is replaced.
    ///
    /// # Errors
    /// When the descriptor has another length, or a value that the metric does not
    /// take; the index is unchanged then.
    pub fn insert(
        &mut self,
        id: ViewId,
        category: &CategoryName,
        descriptor: &[f32],
    ) -> Result<(), Error> {
        let compared = self.index.compared(&[descriptor])?;
        let descriptor = &compared[0];
        self.log_change(id);
        if let Some(row) = self.index.rows.get(id) {
            self.index.views.describe(row, descriptor);
            self.assign(row, category);
        } else {
            let number = self.add_to_category(category);
            self.index.rows.insert(id, self.index.views.len());
            let view = IndexedView {
                id,
                name: category.clone(),
                category: number,
            };
            self.index.views.push(view, descriptor);
        }
        self.membership(category).add(id);
        Ok(())
    }

    /// Removes a view; `false` if the view is unknown.
    pub fn remove_view(&mut self, id: ViewId) -> bool {
        let Some(row) = self.index.rows.get(id) else {
            return false;
        };
        self.log_change(id);
        self.index.rows.remove(id);
        if let Some(removed) = self.index.views.swap_remove(row) {
            self.membership(&removed.name).remove(id);
            self.remove_from_category(&removed.name);
        }
        if row < self.index.views.len() {
            self.index.rows.insert(self.index.views.view(row).id, row);
        }
        true
    }

    /// Begins a new revision, which changes a view.
    fn log_change(&mut self, view: ViewId) {
        self.index.revision = new_revision();
        self.index.changes.push(self.index.revision, view);
    }

    fn membership(&mut self, category: &CategoryName) -> &mut MembershipChange {
        self.memberships.entry(category.clone()).or_default()
    }

    /// Moves the view of a row, whose descriptor may have changed, to a category.
    fn assign(&mut self, row: usize, category: &CategoryName) {
        let IndexedView { id, name: left, .. } = self.index.views.view(row).clone();
        self.membership(&left).remove(id);
        if left == *category {
            return;
        }
        let number = self.add_to_category(category);
        let view = self.index.views.view_mut(row);
        view.category = number;
        view.name = category.clone();
        self.remove_from_category(&left);
    }

    /// Adds a view to the count of its category, which is created if needed, and returns
    /// its number.
    fn add_to_category(&mut self, category: &CategoryName) -> u64 {
        let next = &mut self.index.next_category;
        let entry = self
            .index
            .categories
            .entry(category.clone())
            .or_insert_with(|| {
                *next += 1;
                Category {
                    number: *next,
                    n_views: 0,
                    spread: Arc::default(),
                }
            });
        entry.n_views += 1;
        entry.number
    }

    /// Subtracts a view from the count of its category, which is removed with the last
    /// view.
    fn remove_from_category(&mut self, category: &CategoryName) {
        let Some(entry) = self.index.categories.get_mut(category) else {
            return;
        };
        entry.n_views -= 1;
        if entry.n_views == 0
            && let Some(ended) = self.index.categories.remove(category)
        {
            let ended = ended.spread.distances();
            self.index.distances.exchange(ended, DistanceSum::default());
        }
    }
}

impl Drop for IndexBatch<'_> {
    fn drop(&mut self) {
        for (category, change) in std::mem::take(&mut self.memberships) {
            self.index.update_spread(&category, &change);
        }
    }
}
