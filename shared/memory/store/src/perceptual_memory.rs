//! The perceptual memory: the database, its index in memory, and its changes.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use crate::applying::Target;
use crate::catalogue::Catalogue;
use crate::decision::{Contents, Decision, decide};
use crate::economy::Limits;
use crate::engine::{Engine, Reader};
use crate::error::{Error, Refusal};
use crate::history::{Effect, HistoryEntry};
use crate::meta::{Meta, StoreId};
use crate::mutation::{Answer, Change, Mutation, MutationId};
use crate::opening::{self, OpenReport};
use crate::reading::read_entry;
use crate::standing::Decided;
use crate::store_folder::StoreFolder;
use crate::undo;
use crate::watermark::Watermark;
use crate::writes::Writes;

/// Most track-ids one lease gives.
pub const MAX_LEASE: u64 = 1 << 20;

/// Entries among which somebody's last lesson is looked for.
const UNDO_LOOKS_BACK: u64 = 4096;

/// The store, open in this process alone.
///
/// After an [`Error::Io`] or [`Error::Damaged`] it answers every call with
/// [`Error::Failed`]; drop it and open it again.
pub struct PerceptualMemory {
    pub(crate) engine: Engine,
    pub(crate) catalogue: Catalogue,
    pub(crate) meta: Meta,
    pub(crate) limits: Limits,
    /// When the last change was asked for, for entries the store makes by itself.
    pub(crate) last_wall_ns: u64,
    watermark: Watermark,
    staged: Staged,
    failure: Option<Arc<Error>>,
    /// Last, so that the folder is held until the database is closed.
    pub(crate) folder: StoreFolder,
}

/// Changes made to the index and not yet to the disk.
#[derive(Default)]
struct Staged {
    writes: Writes,
    /// By sequence.
    entries: HashMap<u64, HistoryEntry>,
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
            limits: Limits::default(),
            last_wall_ns: 0,
            watermark,
            staged,
            failure: None,
            folder,
        }
    }

    /// Which store this is.
    pub fn store_id(&self) -> StoreId {
        self.meta.store_id()
    }

    /// Whose memory this is: what was stored here says so on every robot. It stays
    /// when the store is rebuilt.
    pub fn memory_id(&self) -> u128 {
        self.meta.memory_id()
    }

    /// Has the store hold limits from the next change on; there are none at first.
    pub fn set_limits(&mut self, limits: Limits) {
        self.limits = limits;
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
        if let Some(&sequence) = self.catalogue.answered.get(&mutation.id) {
            return Ok(self.entry(sequence)?.answer());
        }
        mutation.check()?;
        let decision = match &mutation.change {
            Change::Undo { sequence } => self.decide_undo(*sequence, &mutation.author)?,
            change => decide(&self.catalogue, &self.meta, change)?,
        };
        let id = Some(mutation.id);
        self.last_wall_ns = mutation.wall_ns;
        Ok(self.stage_decision(id, &mutation.author, mutation.wall_ns, decision))
    }

    /// Stages what was decided, as the next entry of the history.
    pub(crate) fn stage_decision(
        &mut self,
        mutation: Option<MutationId>,
        author: &str,
        wall_ns: u64,
        mut decision: Decision,
    ) -> Answer {
        self.date_documents(&mut decision.effects, author, wall_ns);
        self.meta.next_track_id = self.meta.next_track_id.max(decision.next_track_id);
        let entry = HistoryEntry {
            sequence: self.meta.sequence + 1,
            previous: self.meta.head,
            wall_ns,
            author: author.into(),
            operation: decision.operation,
            mutation,
            effects: decision.effects,
            contradiction: decision.contradiction,
        };
        self.stage_entry(entry, &decision.contents)
    }

    /// Where the clock has stepped back, a document's version is dated by the one before.
    /// A purge may take that one away, so the history itself says what the date is.
    fn date_documents(&self, effects: &mut [Effect], author: &str, wall_ns: u64) {
        for effect in effects {
            let Effect::Document {
                document, decided, ..
            } = effect
            else {
                continue;
            };
            let last_ns = self.catalogue.document_stamp_ns(document);
            if decided.is_none() && last_ns >= wall_ns {
                *decided = Some(Decided::after(last_ns, author.into(), wall_ns));
            }
        }
    }

    /// Stages an entry as it is.
    pub(crate) fn stage_entry(&mut self, entry: HistoryEntry, contents: &Contents) -> Answer {
        let mut target = Target {
            catalogue: &mut self.catalogue,
            meta: &mut self.meta,
            writes: &mut self.staged.writes,
        };
        target.apply(&entry, contents);
        let answer = entry.answer();
        self.staged.entries.insert(entry.sequence, entry);
        answer
    }

    /// Has an empty store be another one.
    pub(crate) fn begin_as(&mut self, meta: Meta) -> Result<(), Error> {
        self.meta = meta;
        self.staged.writes.touch();
        self.commit()
    }

    fn decide_undo(&mut self, sequence: Option<u64>, author: &str) -> Result<Decision, Error> {
        let sequence = match sequence {
            Some(sequence) => sequence,
            None => self.last_lesson(author)?,
        };
        let entry = self.entry(sequence)?;
        Ok(undo::decide(&self.catalogue, &entry)?)
    }

    /// The last entry in which this author taught something that still holds.
    fn last_lesson(&mut self, author: &str) -> Result<u64, Error> {
        let first = self.meta.sequence.saturating_sub(UNDO_LOOKS_BACK);
        for sequence in (first + 1..=self.meta.sequence).rev() {
            if self.catalogue.is_lost(sequence) {
                continue;
            }
            let entry = self.entry(sequence)?;
            let is_own = &*entry.author == author && undo::is_lesson(&entry.operation);
            if is_own && undo::decide(&self.catalogue, &entry).is_ok() {
                return Ok(sequence);
            }
        }
        Err(Refusal::NothingToUndo.into())
    }

    /// An entry, staged or on disk.
    fn entry(&mut self, sequence: u64) -> Result<HistoryEntry, Error> {
        if let Some(entry) = self.staged.entries.get(&sequence) {
            return Ok(entry.clone());
        }
        let is_known = (1..=self.meta.sequence).contains(&sequence);
        if !is_known || self.catalogue.is_lost(sequence) {
            return Err(Refusal::UnknownEntry { sequence }.into());
        }
        self.read(|reader| read_entry(reader, sequence))
    }

    /// Makes a lease; [`Self::commit`] makes it on disk.
    pub(crate) fn stage_lease(&mut self, count: u64) -> Result<u64, Error> {
        self.usable()?;
        let first = self.meta.next_track_id;
        if !(1..=MAX_LEASE).contains(&count) {
            return Err(Refusal::LeaseSize {
                count,
                most: MAX_LEASE,
            }
            .into());
        }
        let end = first.checked_add(count).ok_or(Refusal::TrackIdsExhausted)?;
        self.meta.next_track_id = end;
        // The record about the store alone is the lease.
        self.staged.writes.touch();
        Ok(first)
    }

    /// Has all staged changes on disk, with one sync; none when nothing is staged.
    /// What exceeds a limit then is given up, with another.
    pub(crate) fn commit(&mut self) -> Result<(), Error> {
        self.commit_staged()?;
        if self.stage_economies()? {
            self.commit_staged()?;
        }
        Ok(())
    }

    fn commit_staged(&mut self) -> Result<(), Error> {
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
}
