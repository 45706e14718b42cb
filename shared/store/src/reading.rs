//! What the perceptual memory can be asked.

use std::ops::ControlFlow;

use learning::{CategoryName, ViewChange, ViewId};
use serde::de::DeserializeOwned;

use crate::catalogue::CategorySummary;
use crate::engine::Reader;
use crate::error::Error;
use crate::examination::category_of;
use crate::history::{HistoryEntry, PackedEntry};
use crate::keys;
use crate::meta::StoreId;
use crate::perceptual_memory::PerceptualMemory;
use crate::record::unseal;
use crate::view::{Descriptor, Facts, Label, PackedDescriptor, PackedLabel, StoredView};

/// Unwanted records passed by in the time of one seek; see the bench `load_snapshot`.
const SKIPPED_PER_SEEK: usize = 16;

/// How far a reader has followed a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Position {
    /// Which store.
    pub store_id: StoreId,
    /// The last history entry the reader knows.
    pub sequence: u64,
}

/// A view as recognition needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledView {
    /// Which view.
    pub view: ViewId,
    /// What it is called.
    pub category: CategoryName,
    /// What to compare with.
    pub descriptor: Descriptor,
}

/// A part of all labelled views.
///
/// A reader loads page after page, notes the position of the *first*, and then
/// asks for the changes since that. A change that a later page shows already is
/// then applied once more, which alters nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct SnapshotPage {
    /// The state the page shows.
    pub position: Position,
    /// Labelled views in order.
    pub views: Vec<LabelledView>,
    /// Where the next page begins; none after the last one.
    pub next: Option<ViewId>,
}

/// What changed since a position.
#[derive(Debug, Clone, PartialEq)]
pub enum Changes {
    /// The entries that follow the position, without a gap.
    Entries {
        /// In order; empty when nothing changed.
        entries: Vec<ChangeEntry>,
        /// Sequence of the last entry there is; ask again until it is reached.
        last_sequence: u64,
    },
    /// The position is not one of this store: load the snapshot again.
    Reload,
}

/// One history entry's effect on the names of views.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangeEntry {
    /// Its sequence.
    pub sequence: u64,
    /// Its effects; none when it only stored views.
    pub names: Vec<NameChange>,
}

/// A change of a view's name.
#[derive(Debug, Clone, PartialEq)]
pub enum NameChange {
    /// The view now has this name, and no other.
    Assigned(LabelledView),
    /// The view now has none.
    Unassigned(ViewId),
}

impl PerceptualMemory {
    /// Where the store is now.
    pub fn position(&self) -> Position {
        Position {
            store_id: self.store_id(),
            sequence: self.sequence(),
        }
    }

    /// All categories with their sizes, by name.
    pub fn categories(&self) -> Vec<CategorySummary> {
        self.catalogue.summaries()
    }

    /// Everything stored of a track, in order of the views; empty for an unknown track.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn views_of_track(&mut self, track_id: u64) -> Result<Vec<StoredView>, Error> {
        let views: Vec<ViewId> = self
            .catalogue
            .track(track_id)
            .map(|(view, _)| view)
            .collect();
        self.read(|reader| {
            views
                .into_iter()
                .map(|view| read_view(reader, view))
                .collect()
        })
    }

    /// The page of labelled views from `cursor` on: none for the first, then what
    /// the page before gave as next. Ends with the view that makes its descriptors
    /// exceed `max_bytes`, so it has at least one view.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn snapshot(
        &mut self,
        cursor: Option<ViewId>,
        max_bytes: usize,
    ) -> Result<SnapshotPage, Error> {
        let position = self.position();
        let from = cursor.unwrap_or(ViewId {
            track_id: 0,
            view_id: 0,
        });
        let mut next = None;
        let mut n_bytes = 0;
        let mut n_skipped = 0;
        let mut runs: Vec<Vec<(ViewId, CategoryName)>> = vec![Vec::new()];
        for (view, entry) in self.catalogue.views_from(from) {
            let Some((category, _)) = &entry.label else {
                n_skipped += 1;
                continue;
            };
            if n_bytes > max_bytes {
                next = Some(view);
                break;
            }
            n_bytes += entry.n_descriptor_bytes as usize;
            if std::mem::take(&mut n_skipped) > SKIPPED_PER_SEEK {
                runs.push(Vec::new());
            }
            runs.last_mut()
                .into_iter()
                .for_each(|run| run.push((view, category.clone())));
        }
        let views = self.read(|reader| {
            let mut views = Vec::new();
            runs.into_iter()
                .try_for_each(|run| read_run(reader, run, &mut views))?;
            Ok(views)
        })?;
        Ok(SnapshotPage {
            position,
            views,
            next,
        })
    }

    /// The changes of names after `since`, as many as fit `max_bytes` of
    /// descriptors, and at least one.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn changes(&mut self, since: Position, max_bytes: usize) -> Result<Changes, Error> {
        let now = self.position();
        if since.store_id != now.store_id || since.sequence > now.sequence {
            return Ok(Changes::Reload);
        }
        let mut entries = Vec::new();
        let mut n_bytes = 0;
        let mut sequence = since.sequence;
        while sequence < now.sequence && (entries.is_empty() || n_bytes <= max_bytes) {
            sequence += 1;
            let entry = self.change(sequence)?;
            let size = |change: &NameChange| match change {
                NameChange::Assigned(view) => 4 * view.descriptor.values.len(),
                NameChange::Unassigned(_) => 0,
            };
            n_bytes += entry.names.iter().map(size).sum::<usize>();
            entries.push(entry);
        }
        Ok(Changes::Entries {
            entries,
            last_sequence: now.sequence,
        })
    }

    /// Up to `max` entries of the history from sequence `from` on.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn history(&mut self, from: u64, max: usize) -> Result<Vec<HistoryEntry>, Error> {
        let last = self
            .sequence()
            .min(from.saturating_add(max as u64).saturating_sub(1));
        let sequences = from.max(1)..=last;
        self.read(|reader| {
            sequences
                .map(|sequence| read_entry(reader, sequence))
                .collect()
        })
    }

    /// One history entry's effect on names.
    fn change(&mut self, sequence: u64) -> Result<ChangeEntry, Error> {
        let entry = self.read(|reader| read_entry(reader, sequence))?;
        // A rebuilt store has the history of views that are lost.
        let after = |change: ViewChange| {
            let is_stored = self.catalogue.get(change.id).is_some();
            (change.id, change.after.filter(|_| is_stored))
        };
        let known: Vec<(ViewId, Option<CategoryName>)> =
            entry.changes.into_iter().map(after).collect();
        let names = self.read(|reader| {
            let name = |(view, after)| match after {
                Some(category) => Ok(NameChange::Assigned(read_labelled(reader, view, category)?)),
                None => Ok(NameChange::Unassigned(view)),
            };
            known.into_iter().map(name).collect()
        })?;
        Ok(ChangeEntry { sequence, names })
    }
}

/// Reads a record that must be there.
fn read_record<T: DeserializeOwned>(reader: &mut Reader, key: &[u8]) -> Result<T, Error> {
    let record = reader.get(key)?;
    let value = record
        .ok_or("it is missing")
        .and_then(|record| unseal(key, &record));
    value.map_err(|wrong| Error::record(key, wrong))
}

fn read_descriptor(reader: &mut Reader, view: ViewId) -> Result<Descriptor, Error> {
    let key = keys::view_key(keys::DESCRIPTOR, view);
    Ok(read_record::<PackedDescriptor>(reader, &key)?.into())
}

fn read_labelled(
    reader: &mut Reader,
    view: ViewId,
    category: CategoryName,
) -> Result<LabelledView, Error> {
    Ok(LabelledView {
        view,
        category,
        descriptor: read_descriptor(reader, view)?,
    })
}

/// Reads descriptors that lie close together, in the order of their keys.
fn read_run(
    reader: &mut Reader,
    run: Vec<(ViewId, CategoryName)>,
    views: &mut Vec<LabelledView>,
) -> Result<(), Error> {
    let Some(&(first, _)) = run.first() else {
        return Ok(());
    };
    let mut wanted = run.into_iter().peekable();
    let mut wrong = "it is missing";
    reader.scan(&keys::view_key(keys::DESCRIPTOR, first), |key, record| {
        let is_wanted = |(view, _): &(ViewId, _)| keys::view_key(keys::DESCRIPTOR, *view) == key;
        if wanted.peek().is_some_and(is_wanted) {
            match unseal::<PackedDescriptor>(key, record) {
                Ok(packed) => views.extend(wanted.next().map(|(view, category)| LabelledView {
                    view,
                    category,
                    descriptor: packed.into(),
                })),
                Err(what) => {
                    wrong = what;
                    return ControlFlow::Break(());
                }
            }
        }
        let is_before =
            |(view, _): &(ViewId, _)| &keys::view_key(keys::DESCRIPTOR, *view)[..] > key;
        if wanted.peek().is_some_and(is_before) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    })?;
    match wanted.next() {
        Some((view, _)) => Err(Error::record(
            &keys::view_key(keys::DESCRIPTOR, view),
            wrong,
        )),
        None => Ok(()),
    }
}

fn read_entry(reader: &mut Reader, sequence: u64) -> Result<HistoryEntry, Error> {
    let key = keys::history_key(sequence);
    let packed = read_record::<PackedEntry>(reader, &key)?;
    packed
        .unpack(sequence)
        .ok_or_else(|| Error::record(&key, "a name in it is none"))
}

fn read_view(reader: &mut Reader, view: ViewId) -> Result<StoredView, Error> {
    let facts = read_record::<Facts>(reader, &keys::view_key(keys::VIEW, view))?;
    let descriptor = read_descriptor(reader, view)?;
    let mut points = None;
    if facts.points.is_some() {
        let key = keys::view_key(keys::POINTS, view);
        points = Some(read_record::<serde_bytes::ByteBuf>(reader, &key)?.into_vec());
    }
    let label = read_label(reader, view)?;
    Ok(StoredView {
        view: facts.into_view(view, descriptor, points),
        label,
    })
}

/// A view that never had a name has no record of one.
fn read_label(reader: &mut Reader, view: ViewId) -> Result<Option<Label>, Error> {
    let key = keys::view_key(keys::LABEL, view);
    let Some(record) = reader.get(&key)? else {
        return Ok(None);
    };
    let label = unseal::<PackedLabel>(&key, &record)
        .and_then(|label| Ok((category_of(&label)?, label)))
        .map_err(|wrong| Error::record(&key, wrong))?;
    let (
        category,
        PackedLabel {
            author,
            wall_ns,
            sequence,
            ..
        },
    ) = label;
    Ok(category.map(|category| Label {
        category,
        author,
        wall_ns,
        sequence,
    }))
}
