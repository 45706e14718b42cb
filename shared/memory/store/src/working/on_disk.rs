//! The world model's copy on disk: one record for each thing known.

use std::fmt;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use rusty_leveldb::WriteBatch;
use serde::{Deserialize, Serialize};

use super::keys::Entry;
use super::world_config::WorldConfig;
use super::world_model::WorldModel;
use crate::engine::Engine;
use crate::error::Error;
use crate::record::{seal, unseal};
use crate::store_folder::StoreFolder;

/// The newest schema of the database that this version knows.
const SCHEMA: u32 = 1;
/// Most records of a batch, so that writing everything takes little memory.
const BATCH_RECORDS: usize = 2048;

/// The record about the database: numbers that were given are not given again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Meta {
    schema: u32,
    newest_fact: u64,
    newest_event: u64,
    newest_task: u64,
}

/// The database, open in this process alone. After an error it is closed and
/// opened again.
pub struct WorkingMemory {
    engine: Engine,
    /// Last, so that the folder is held until the database is closed.
    _folder: StoreFolder,
}

/// What was found when the working memory was opened; `Display` is a sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorldReport {
    /// In which state it was.
    pub condition: WorldCondition,
    /// Number of objects now in it.
    pub n_objects: usize,
    /// Number of facts.
    pub n_facts: usize,
}

/// The state a working memory was found in.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum WorldCondition {
    /// There was none; it was created.
    New,
    /// All is as it was written.
    Sound,
    /// It was damaged; an empty one was begun.
    BegunAnew {
        /// What was wrong, in words.
        reason: String,
        /// Where the damaged database is kept.
        set_aside: PathBuf,
    },
}

/// A record to write, or to delete.
pub(super) struct Write {
    key: Vec<u8>,
    record: Option<Vec<u8>>,
}

impl WorldReport {
    /// Whether what was known before is lost: to be told loudly.
    pub fn is_loss(&self) -> bool {
        matches!(self.condition, WorldCondition::BegunAnew { .. })
    }
}

impl fmt::Display for WorldReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.condition {
            WorldCondition::New => write!(f, "a new working memory was created")?,
            WorldCondition::Sound => write!(f, "the working memory is sound")?,
            WorldCondition::BegunAnew { reason, set_aside } => write!(
                f,
                "the working memory was damaged and has been begun anew; the damaged database is \
                 kept as {} ({reason})",
                set_aside.display()
            )?,
        }
        let Self {
            n_objects, n_facts, ..
        } = self;
        write!(f, ": {n_facts} facts, {n_objects} objects")
    }
}

impl WorkingMemory {
    /// Opens or creates the working memory in `folder`, and tells what was found.
    ///
    /// What the last process held to be true has ended when it was last seen;
    /// tasks run on. A damaged database is set aside under another name and an
    /// empty one begun. `wall_ns` is now, nanoseconds since 1970.
    ///
    /// Reads everything: a few seconds for a million facts.
    ///
    /// # Errors
    ///
    /// [`Error::InUse`], [`Error::NewerSchema`], or [`Error::Io`] when the folder
    /// cannot be read and written; nothing was set aside then.
    pub fn open(
        folder: &Path,
        config: WorldConfig,
        wall_ns: u64,
    ) -> Result<(Self, WorldModel, WorldReport), Error> {
        let folder = StoreFolder::hold(folder)?.with_write_buffer(config.write_buffer_bytes);
        let (engine, mut model, condition) = match read_database(&folder, config) {
            Ok((engine, Some(model))) => (engine, model, WorldCondition::Sound),
            Ok((engine, None)) => (engine, WorldModel::new(config), WorldCondition::New),
            Err(Error::Damaged { what: reason }) => {
                let set_aside = folder.set_aside()?;
                let (engine, _) = read_database(&folder, config)?;
                let condition = WorldCondition::BegunAnew { reason, set_aside };
                (engine, WorldModel::new(config), condition)
            }
            Err(error) => return Err(error),
        };
        let report = WorldReport {
            condition,
            n_objects: model.objects.len(),
            n_facts: model.facts.len(),
        };
        model.begin_session(wall_ns);
        let mut memory = Self {
            engine,
            _folder: folder,
        };
        memory.write_changes(&mut model)?;
        Ok((memory, model, report))
    }

    /// Writes and syncs all that has changed.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`]; what was to be written may be on disk
    /// or not.
    pub fn write_changes(&mut self, model: &mut WorldModel) -> Result<(), Error> {
        while model.has_changes() {
            self.write(model.take_writes())?;
        }
        Ok(())
    }

    /// Writes and syncs all of the records or none.
    pub(super) fn write(&mut self, writes: Vec<Write>) -> Result<(), Error> {
        let mut batch = WriteBatch::default();
        for Write { key, record } in writes {
            match record {
                Some(record) => batch.put(&key, &record),
                None => batch.delete(&key),
            }
        }
        self.engine.write(batch, true)
    }

    /// Closes the database.
    ///
    /// # Errors
    ///
    /// [`Error::Io`]; what was written is on disk all the same.
    pub fn close(self) -> Result<(), Error> {
        self.engine.close()
    }
}

/// Opens the database and reads all of it; no model when it was just created.
fn read_database(
    folder: &StoreFolder,
    config: WorldConfig,
) -> Result<(Engine, Option<WorldModel>), Error> {
    let damaged = |what: String| Error::Damaged { what };
    if folder.database_is_headless()? {
        return Err(damaged("its file CURRENT is missing".to_owned()));
    }
    let mut engine = folder.open_database()?;
    let mut reading = Reading::new(config);
    engine.reader()?.scan(&[], |key, record| {
        reading.take(key, record);
        ControlFlow::Continue(())
    })?;
    let (n_damages, damages) = engine.damages();
    if n_damages > 0 {
        return Err(damaged(damages.join("; ")));
    }
    let model = reading.finish()?;
    engine.accept()?;
    Ok((engine, model))
}

/// A model in the making, from the records in the order of their keys.
struct Reading {
    model: WorldModel,
    meta: Option<Meta>,
    n_records: usize,
    wrong: Option<Error>,
}

impl Reading {
    fn new(config: WorldConfig) -> Self {
        Self {
            model: WorldModel::new(config),
            meta: None,
            n_records: 0,
            wrong: None,
        }
    }

    fn take(&mut self, key: &[u8], record: &[u8]) {
        self.n_records += 1;
        if let Err(wrong) = self.insert(key, record) {
            self.wrong.get_or_insert(Error::record(key, wrong));
        }
    }

    fn insert(&mut self, key: &[u8], record: &[u8]) -> Result<(), &'static str> {
        match Entry::of(key).ok_or("its key is none")? {
            Entry::Meta => self.meta = Some(unseal(key, record)?),
            Entry::Robot => self.model.robot = Some(unseal(key, record)?),
            Entry::Object(_) => self.model.insert_object(unseal(key, record)?),
            Entry::Fact(_) => self.model.facts.insert(unseal(key, record)?),
            Entry::Event(_) => self.model.events.insert(unseal(key, record)?),
            Entry::Task(_) => self.model.tasks.insert(unseal(key, record)?),
        }
        Ok(())
    }

    fn finish(self) -> Result<Option<WorldModel>, Error> {
        let Self {
            mut model,
            meta,
            n_records,
            wrong,
        } = self;
        if let Some(meta) = meta
            && meta.schema > SCHEMA
        {
            return Err(Error::NewerSchema {
                found: meta.schema,
                known: SCHEMA,
            });
        }
        match (meta, wrong) {
            (_, Some(wrong)) => Err(wrong),
            (None, None) if n_records == 0 => Ok(None),
            (None, None) => Err(Error::Damaged {
                what: "the record about the working memory is missing".to_owned(),
            }),
            (Some(meta), None) => {
                model.facts.newest = model.facts.newest.max(meta.newest_fact);
                model.events.newest = model.events.newest.max(meta.newest_event);
                model.tasks.newest = model.tasks.newest.max(meta.newest_task);
                Ok(Some(model))
            }
        }
    }
}

impl WorldModel {
    /// Takes out what is to be written next, as much as makes one batch.
    pub(super) fn take_writes(&mut self) -> Vec<Write> {
        let taken = std::iter::from_fn(|| self.touched.take()).take(BATCH_RECORDS);
        let taken: Vec<Entry> = taken.collect();
        let write = |entry: Entry| {
            let key = entry.key();
            let record = self.sealed(entry, &key);
            Write { key, record }
        };
        taken.into_iter().map(write).collect()
    }

    /// The record of an entry; `None` when it is forgotten.
    fn sealed(&self, entry: Entry, key: &[u8]) -> Option<Vec<u8>> {
        match entry {
            Entry::Meta => {
                let meta = Meta {
                    schema: SCHEMA,
                    newest_fact: self.facts.newest,
                    newest_event: self.events.newest,
                    newest_task: self.tasks.newest,
                };
                Some(seal(key, &meta))
            }
            Entry::Robot => self.robot.as_ref().map(|robot| seal(key, robot)),
            Entry::Object(id) => self.objects.get(&id).map(|object| seal(key, object)),
            Entry::Fact(number) => self.facts.get(number).map(|fact| seal(key, fact)),
            Entry::Event(sequence) => self.events.get(sequence).map(|event| seal(key, event)),
            Entry::Task(number) => self.tasks.get(number).map(|task| seal(key, task)),
        }
    }

    /// Has everything written anew, over what `on_disk` was read from.
    pub(super) fn rewrite_over(&mut self, on_disk: &Self) {
        let entries: Vec<Entry> = on_disk.entries().chain(self.entries()).collect();
        for entry in entries {
            self.touched.add(entry);
        }
    }

    fn entries(&self) -> impl Iterator<Item = Entry> {
        let objects = self.objects.keys().map(|id| Entry::Object(*id));
        let facts = self.facts.all().map(|fact| Entry::Fact(fact.number));
        let events = self.events.all().map(|event| Entry::Event(event.sequence));
        let tasks = self.tasks.all().map(|task| Entry::Task(task.number));
        let single = [Entry::Meta, Entry::Robot].into_iter();
        single
            .chain(objects)
            .chain(facts)
            .chain(events)
            .chain(tasks)
    }
}

#[cfg(test)]
mod tests;
