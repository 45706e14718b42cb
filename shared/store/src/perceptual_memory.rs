//! The perceptual memory: the database, its index in memory, and its changes.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use learning::{CategoryName, ViewChange, ViewId};

use crate::catalogue::{Catalogue, Entry};
use crate::engine::{Engine, Reader};
use crate::error::{Error, Refusal};
use crate::history::{HistoryEntry, Operation, PackedEntry};
use crate::keys;
use crate::meta::{Meta, StoreId};
use crate::mutation::{Answer, Change, Mutation, MutationId};
use crate::opening::{self, OpenReport};
use crate::record::{seal, unseal};
use crate::store_folder::StoreFolder;
use crate::view::{Extent, Facts, PackedDescriptor, PackedLabel, View};
use crate::watermark::Watermark;
use crate::writes::Writes;

/// Most track-ids one lease gives.
pub const MAX_LEASE: u64 = 1 << 20;

/// The store, open in this process alone.
///
/// After an [`Error::Io`] or [`Error::Damaged`] it answers every call with
/// [`Error::Failed`]; drop it and open it again.
pub struct PerceptualMemory {
    pub(crate) engine: Engine,
    pub(crate) catalogue: Catalogue,
    pub(crate) meta: Meta,
    watermark: Watermark,
    staged: Staged,
    failure: Option<Arc<Error>>,
    /// Last, so that the folder is held until the database is closed.
    _folder: StoreFolder,
}

/// Changes made to the index and not yet to the disk.
#[derive(Default)]
struct Staged {
    writes: Writes,
    answers: HashMap<MutationId, Answer>,
}

impl PerceptualMemory {
    /// Opens or creates the store in `folder`, and tells what was found there.
    ///
    /// A damaged database is never deleted and never stops the daemon: what is
    /// whole in it is copied, the damaged one is set aside under another name,
    /// and the report says what is lost. `wall_ns` is now, nanoseconds since
    /// 1970, UTC, for the history's entry about that.
    ///
    /// Reads all of the index, none of the descriptors.
    ///
    /// # Errors
    ///
    /// [`Error::InUse`], [`Error::NewerSchema`], or [`Error::Io`] when the folder
    /// cannot be read and written; nothing was set aside then.
    pub fn open(folder: &Path, wall_ns: u64) -> Result<(Self, OpenReport), Error> {
        opening::open(StoreFolder::hold(folder)?, wall_ns, false)
    }

    /// As [`Self::open`], but reads the descriptors and clouds too, and makes a
    /// new copy of everything that is whole: after [`Error::Damaged`].
    ///
    /// # Errors
    ///
    /// As [`Self::open`].
    pub fn open_and_rebuild(folder: &Path, wall_ns: u64) -> Result<(Self, OpenReport), Error> {
        opening::open(StoreFolder::hold(folder)?, wall_ns, true)
    }

    pub(crate) fn new(
        engine: Engine,
        catalogue: Catalogue,
        meta: Meta,
        watermark: Watermark,
        folder: StoreFolder,
    ) -> Self {
        let staged = Staged::default();
        Self {
            engine,
            catalogue,
            meta,
            watermark,
            staged,
            failure: None,
            _folder: folder,
        }
    }

    /// Which store this is.
    pub fn store_id(&self) -> StoreId {
        self.meta.store_id()
    }

    /// Sequence of the last history entry; zero when there is none.
    pub fn sequence(&self) -> u64 {
        self.meta.sequence
    }

    /// Makes one change and has it on disk before it returns.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] when nothing changed; otherwise the change may be on
    /// disk or not: open the store again and repeat it with the same id.
    pub fn apply(&mut self, mutation: &Mutation) -> Result<Answer, Error> {
        let answer = self.stage(mutation)?;
        self.commit()?;
        Ok(answer)
    }

    /// Leases `count` track-ids, from the returned one on, that were never given
    /// out before and never will be again. On disk before it returns.
    ///
    /// # Errors
    ///
    /// As [`Self::apply`].
    pub fn lease_track_ids(&mut self, count: u64) -> Result<u64, Error> {
        let first = self.stage_lease(count)?;
        self.commit()?;
        Ok(first)
    }

    /// Writes everything out and closes the store.
    ///
    /// # Errors
    ///
    /// [`Error::Io`]; what was acknowledged is on disk all the same.
    pub fn close(self) -> Result<(), Error> {
        self.watermark
            .sync()
            .map_err(Error::io("syncing", "acknowledged"))?;
        self.engine.close()
    }

    /// Makes a change in the index; [`Self::commit`] makes it on disk. A change
    /// staged later sees it.
    pub(crate) fn stage(&mut self, mutation: &Mutation) -> Result<Answer, Error> {
        self.usable()?;
        if self.catalogue.answered.contains(&mutation.id) {
            return self.first_answer(mutation.id);
        }
        mutation.check()?;
        let catalogue = &self.catalogue;
        let (operation, stored, changes) = match &mutation.change {
            Change::StoreViews(views) => (Operation::StoreViews, self.stage_views(views)?, vec![]),
            Change::Teach { track_id, category } => {
                let records = catalogue.records_of_track(*track_id);
                (
                    Operation::Teach,
                    vec![],
                    learning::teach(records, *track_id, category)?,
                )
            }
            Change::Correct { track_id, category } => {
                let records = catalogue.records_of_track(*track_id);
                (
                    Operation::Correct,
                    vec![],
                    learning::correct(records, *track_id, category)?,
                )
            }
            Change::Forget { category } => {
                let records = catalogue.records_of_category(category);
                (
                    Operation::Forget,
                    vec![],
                    learning::forget(records, category)?,
                )
            }
        };
        let entry = HistoryEntry {
            sequence: self.meta.sequence + 1,
            wall_ns: mutation.wall_ns,
            author: mutation.author.clone(),
            operation,
            mutation: Some(mutation.id),
            stored,
            changes,
        };
        Ok(self.stage_history(mutation.id, &entry))
    }

    /// Makes a lease; [`Self::commit`] makes it on disk.
    pub(crate) fn stage_lease(&mut self, count: u64) -> Result<u64, Error> {
        self.usable()?;
        let first = self.meta.next_track_id;
        let end = first.checked_add(count);
        let (Some(end), 1..=MAX_LEASE) = (end, count) else {
            return Err(Refusal::LeaseSize {
                count,
                most: MAX_LEASE,
            }
            .into());
        };
        self.meta.next_track_id = end;
        // The record about the store alone is the lease.
        self.staged.writes.touch();
        Ok(first)
    }

    /// Has all staged changes on disk, with one sync; none when nothing is staged.
    pub(crate) fn commit(&mut self) -> Result<(), Error> {
        self.usable()?;
        let staged = std::mem::take(&mut self.staged);
        if staged.writes.is_empty() {
            return Ok(());
        }
        let written = staged
            .writes
            .commit(&mut self.engine, &self.meta)
            .and_then(|()| {
                let marked = self.watermark.write(&self.meta.mark());
                marked.map_err(Error::io("writing", "acknowledged"))
            });
        written.map_err(|error| self.fail(error))
    }

    /// Bytes staged so far.
    pub(crate) fn n_staged_bytes(&self) -> usize {
        self.staged.writes.n_bytes()
    }

    /// The error that made the store unusable.
    pub(crate) fn failure(&self) -> Option<&Error> {
        self.failure.as_deref()
    }

    pub(crate) fn usable(&self) -> Result<(), Error> {
        match &self.failure {
            Some(source) => Err(Error::Failed {
                source: Arc::clone(source),
            }),
            None => Ok(()),
        }
    }

    /// Remembers an error after which index and disk may differ.
    pub(crate) fn fail(&mut self, error: Error) -> Error {
        self.failure.get_or_insert_with(|| Arc::new(error.clone()));
        error
    }

    fn first_answer(&mut self, id: MutationId) -> Result<Answer, Error> {
        if let Some(answer) = self.staged.answers.get(&id) {
            return Ok(*answer);
        }
        let key = keys::answer_key(id);
        self.read(|reader| {
            let record = reader.get(&key)?.ok_or("it is missing");
            let answer = record.and_then(|record| unseal(&key, &record));
            answer.map_err(|wrong| Error::record(&key, wrong))
        })
    }

    /// Reads something; an error makes the store unusable until it is opened again.
    pub(crate) fn read<T>(
        &mut self,
        read: impl FnOnce(&mut Reader) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.usable()?;
        let found = self
            .engine
            .reader()
            .and_then(|mut reader| read(&mut reader));
        found.map_err(|error| self.fail(error))
    }

    /// Stages those of the views that are new, or refuses all.
    fn stage_views(&mut self, views: &[View]) -> Result<Vec<ViewId>, Refusal> {
        let mut new = BTreeMap::new();
        for view in views {
            let packed = PackedView::of(view);
            let known = self.catalogue.get(view.id);
            let known = known.or(new.get(&view.id).map(|packed: &PackedView| &packed.entry));
            match known {
                None => {
                    new.insert(view.id, packed);
                }
                Some(known) if known.fingerprint == packed.entry.fingerprint => {}
                Some(_) => return Err(Refusal::ViewDiffers { view: view.id }),
            }
        }
        let stored = new.keys().copied().collect();
        for (id, packed) in new {
            packed.stage(&mut self.staged.writes);
            self.catalogue.insert(id, packed.entry);
            self.meta.n_views += 1;
            // A view may come with an id this store never leased: that of a lost one.
            self.meta.next_track_id = self.meta.next_track_id.max(id.track_id + 1);
        }
        Ok(stored)
    }

    /// Stages an entry of the history with the labels it changes, unless it
    /// changes nothing, and the answer.
    fn stage_history(&mut self, id: MutationId, entry: &HistoryEntry) -> Answer {
        let n_views = (entry.stored.len() + entry.changes.len()) as u64;
        if n_views > 0 {
            self.meta.sequence = entry.sequence;
            for change in &entry.changes {
                self.stage_label(entry, change);
            }
            let key = keys::history_key(entry.sequence);
            self.staged.writes.put(&key, &PackedEntry::of(entry));
        }
        let answer = Answer {
            sequence: self.meta.sequence,
            n_views,
        };
        self.staged.writes.put(&keys::answer_key(id), &answer);
        self.staged.answers.insert(id, answer);
        self.catalogue.answered.insert(id);
        answer
    }

    fn stage_label(&mut self, entry: &HistoryEntry, change: &ViewChange) {
        let label = PackedLabel::given_by(entry, change);
        put_label(
            &mut self.staged.writes,
            change.id,
            &label,
            change.after.as_ref(),
        );
        if let Some(before) = &change.before {
            self.staged
                .writes
                .delete(&keys::category_key(before, change.id));
        }
        let label = change.after.clone().map(|name| (name, entry.wall_ns));
        self.catalogue.relabel(change.id, label);
    }
}

/// Writes a label, and its entry in the category index.
pub(crate) fn put_label(
    writes: &mut Writes,
    view: ViewId,
    label: &PackedLabel,
    category: Option<&CategoryName>,
) {
    writes.put(&keys::view_key(keys::LABEL, view), label);
    if let Some(name) = category {
        writes.put(&keys::category_key(name, view), &());
    }
}

/// A view's records.
struct PackedView {
    /// Key and record of facts, descriptor and cloud.
    records: Vec<([u8; 13], Vec<u8>)>,
    entry: Entry,
}

impl PackedView {
    fn of(view: &View) -> Self {
        let key = keys::view_key(keys::DESCRIPTOR, view.id);
        let descriptor = seal(&key, &PackedDescriptor::from(&view.descriptor));
        let descriptor_extent = Extent::of(&descriptor);
        let mut records = vec![(key, descriptor)];
        let mut points_extent = None;
        if let Some(points) = &view.points {
            let key = keys::view_key(keys::POINTS, view.id);
            let record = seal(&key, &serde_bytes::Bytes::new(points));
            points_extent = Some(Extent::of(&record));
            records.push((key, record));
        }
        let facts = Facts::of(view, descriptor_extent, points_extent);
        let key = keys::view_key(keys::VIEW, view.id);
        let record = seal(&key, &facts);
        let entry = Entry::of(&record, &facts);
        records.push((key, record));
        Self { records, entry }
    }

    fn stage(&self, writes: &mut Writes) {
        for (key, record) in &self.records {
            writes.put_sealed(key, record);
        }
    }
}
