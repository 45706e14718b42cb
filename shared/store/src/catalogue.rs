//! The index in memory: which views there are, what they are called, which
//! mutations were answered. About a hundred bytes a view; descriptors and clouds
//! stay on disk.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use learning::{CategoryName, ViewId, ViewRecord};

use crate::mutation::MutationId;
use crate::view::Facts;

/// What is kept of each view.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Entry {
    /// Bytes of its descriptor on disk.
    pub(crate) n_descriptor_bytes: u32,
    /// Bytes of its cloud on disk.
    n_points_bytes: u32,
    /// Of its content, to tell whether another view with its id is the same.
    pub(crate) fingerprint: u64,
    /// Its name and when that was given.
    pub(crate) label: Option<(CategoryName, u64)>,
}

impl Entry {
    /// For a view without a name, by its small record, which names the checksums
    /// of the large ones.
    pub(crate) fn of(record: &[u8], facts: &Facts) -> Self {
        Self {
            n_descriptor_bytes: facts.descriptor.n_bytes,
            n_points_bytes: facts.points.map_or(0, |extent| extent.n_bytes),
            fingerprint: (crc32fast::hash(record) as u64) << 32 | facts.descriptor.crc32 as u64,
            label: None,
        }
    }

    fn n_bytes(&self) -> u64 {
        self.n_descriptor_bytes as u64 + self.n_points_bytes as u64
    }
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
    views: BTreeMap<ViewId, Entry>,
    categories: BTreeMap<CategoryName, BTreeSet<ViewId>>,
    pub(crate) answered: HashSet<MutationId>,
}

impl Catalogue {
    pub(crate) fn get(&self, view: ViewId) -> Option<&Entry> {
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

    /// The views from `from` on, in order.
    pub(crate) fn views_from(&self, from: ViewId) -> impl Iterator<Item = (ViewId, &Entry)> {
        self.views.range(from..).map(|(view, entry)| (*view, entry))
    }

    /// The views of a track, in order.
    pub(crate) fn track(&self, track_id: u64) -> impl Iterator<Item = (ViewId, &Entry)> + Clone {
        let first = ViewId {
            track_id,
            view_id: 0,
        };
        let last = ViewId {
            track_id,
            view_id: u32::MAX,
        };
        self.views
            .range(first..=last)
            .map(|(view, entry)| (*view, entry))
    }

    /// The views of a track as the rules of teaching want them.
    pub(crate) fn records_of_track(
        &self,
        track_id: u64,
    ) -> impl Iterator<Item = ViewRecord<'_>> + Clone {
        self.track(track_id).map(|(id, entry)| {
            let category = entry.label.as_ref().map(|(name, _)| name);
            ViewRecord { id, category }
        })
    }

    /// The views called `name` as the rules of teaching want them.
    pub(crate) fn records_of_category(
        &self,
        name: &CategoryName,
    ) -> impl Iterator<Item = ViewRecord<'_>> {
        let views = self.categories.get_key_value(name).into_iter();
        views.flat_map(|(name, views)| {
            views.iter().map(move |&id| ViewRecord {
                id,
                category: Some(name),
            })
        })
    }

    /// The greatest track-id of any view.
    pub(crate) fn last_track_id(&self) -> Option<u64> {
        self.views.last_key_value().map(|(view, _)| view.track_id)
    }

    pub(crate) fn insert(&mut self, view: ViewId, entry: Entry) {
        self.views.insert(view, entry);
    }

    /// Gives a view a name, or takes it away; a view that is not there is left out.
    pub(crate) fn relabel(&mut self, view: ViewId, label: Option<(CategoryName, u64)>) {
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
            self.categories
                .entry(name.clone())
                .or_default()
                .insert(view);
        }
        entry.label = label;
    }

    /// Every category that a view carries, by name.
    pub(crate) fn summaries(&self) -> Vec<CategorySummary> {
        let summary = |(name, views): (&CategoryName, &BTreeSet<ViewId>)| {
            let entries = || views.iter().filter_map(|view| self.views.get(view));
            let taught_ns = |entry: &Entry| entry.label.as_ref().map(|(_, wall_ns)| *wall_ns);
            CategorySummary {
                name: name.clone(),
                n_views: views.len() as u64,
                n_bytes: entries().map(Entry::n_bytes).sum(),
                last_taught_ns: entries().filter_map(taught_ns).max().unwrap_or(0),
            }
        };
        self.categories.iter().map(summary).collect()
    }
}
