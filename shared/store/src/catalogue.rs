//! The index in memory: which views there are, what they are called, which
//! mutations were answered. About a hundred bytes a view; descriptors and clouds
//! stay on disk.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use learning::CategoryName;

use crate::mutation::MutationId;
use crate::view::ViewKey;

/// What is kept of each view.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Entry {
    /// Bytes of its descriptor and cloud on disk.
    pub(crate) n_bytes: u64,
    /// Of its content, to tell whether another view with its id is the same.
    pub(crate) fingerprint: u64,
    /// Its name and when that was given.
    pub(crate) label: Option<(CategoryName, u64)>,
}

/// A category and what is stored of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CategorySummary {
    /// Its name.
    pub name: CategoryName,
    /// Number of views that carry it, at least one.
    pub n_views: u64,
    /// Bytes of their descriptors and clouds on disk.
    pub n_bytes: u64,
    /// When one of them was last given the name, nanoseconds since 1970, UTC.
    pub last_taught_ns: u64,
}

/// The index.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Catalogue {
    views: BTreeMap<ViewKey, Entry>,
    categories: BTreeMap<CategoryName, BTreeSet<ViewKey>>,
    pub(crate) answered: HashSet<MutationId>,
}

impl Catalogue {
    pub(crate) fn get(&self, view: ViewKey) -> Option<&Entry> {
        self.views.get(&view)
    }

    pub(crate) fn n_views(&self) -> usize {
        self.views.len()
    }

    pub(crate) fn n_categories(&self) -> usize {
        self.categories.len()
    }

    pub(crate) fn n_labelled(&self) -> usize {
        self.categories.values().map(BTreeSet::len).sum()
    }

    /// All views, in order.
    pub(crate) fn views(&self) -> impl Iterator<Item = (ViewKey, &Entry)> {
        self.views.iter().map(|(view, entry)| (*view, entry))
    }

    /// The views from `from` on, in order.
    pub(crate) fn views_from(&self, from: ViewKey) -> impl Iterator<Item = (ViewKey, &Entry)> {
        self.views.range(from..).map(|(view, entry)| (*view, entry))
    }

    /// The views of a track, in order.
    pub(crate) fn track(&self, track_id: u64) -> impl Iterator<Item = (ViewKey, &Entry)> {
        let first = ViewKey { track_id, view_id: 0 };
        let last = ViewKey { track_id, view_id: u32::MAX };
        self.views.range(first..=last).map(|(view, entry)| (*view, entry))
    }

    /// The views called `name`, in order.
    pub(crate) fn category(&self, name: &CategoryName) -> impl Iterator<Item = ViewKey> {
        self.categories.get(name).into_iter().flatten().copied()
    }

    /// The greatest track-id of any view.
    pub(crate) fn last_track_id(&self) -> Option<u64> {
        self.views.last_key_value().map(|(view, _)| view.track_id)
    }

    pub(crate) fn insert(&mut self, view: ViewKey, n_bytes: u64, fingerprint: u64) {
        self.views.insert(view, Entry { n_bytes, fingerprint, label: None });
    }

    /// Gives a view a name, or takes it away; a view that is not there is left out.
    pub(crate) fn relabel(&mut self, view: ViewKey, label: Option<(CategoryName, u64)>) {
        let Some(entry) = self.views.get_mut(&view) else {
            return;
        };
        if let Some((before, _)) = entry.label.take()
            && let Some(views) = self.categories.get_mut(&before)
        {
            views.remove(&view);
            if views.is_empty() {
                self.categories.remove(&before);
            }
        }
        if let Some((name, _)) = &label {
            self.categories.entry(name.clone()).or_default().insert(view);
        }
        entry.label = label;
    }

    /// Every category that a view carries, by name.
    pub(crate) fn summaries(&self) -> Vec<CategorySummary> {
        let summary = |(name, views): (&CategoryName, &BTreeSet<ViewKey>)| {
            let entries = || views.iter().filter_map(|view| self.views.get(view));
            let taught_ns = |entry: &Entry| entry.label.as_ref().map(|(_, wall_ns)| *wall_ns);
            CategorySummary {
                name: name.clone(),
                n_views: views.len() as u64,
                n_bytes: entries().map(|entry| entry.n_bytes).sum(),
                last_taught_ns: entries().filter_map(taught_ns).max().unwrap_or(0),
            }
        };
        self.categories.iter().map(summary).collect()
    }
}
