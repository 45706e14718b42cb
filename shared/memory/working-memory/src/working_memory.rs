//! Working memory on disk: one database record per item of the world model.

use std::fmt;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use durable_leveldb::{
    Database, StoreFolder, WriteBatch,
    record::{seal, unseal},
};
use serde::{Deserialize, Serialize};

use crate::error::{Error, StorageError};
use crate::record_key::{self, RecordKey};
use crate::world_config::WorldConfig;
use crate::world_model::WorldModel;

/// Newest schema version that this program reads.
const SCHEMA: u32 = 3;
/// Maximum number of records in a write batch, which bounds the memory of a full write. Chosen.
const BATCH_RECORDS: usize = 2048;

/// Metadata record: schema and last used numbers, which are never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WorkingMeta {
    pub(crate) schema: u32,
    pub(crate) newest_fact: u64,
    pub(crate) newest_event: u64,
    pub(crate) newest_task: u64,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) newest_surface: u64,
}

fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// Database of the working memory, open in one process. After an error it is closed and opened
/// again.
pub struct WorkingMemory {
    engine: Database,
    /// Locked folder; the last field, so that the database is closed before the lock is released.
    _folder: StoreFolder,
}

/// Report of opening the working memory; `Display` gives a sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorldReport {
    /// Condition in which the database was found.
    pub condition: WorldCondition,
    /// Number of stored objects.
    pub n_objects: usize,
    /// Number of stored facts.
    pub n_facts: usize,
}

/// Condition in which a working memory was found.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum WorldCondition {
    /// Database was missing; a new one was created.
    New,
    /// Intact database.
    Sound,
    /// Database was damaged; an empty one was created.
    Reset {
        /// Detected corruption of the database, as a sentence.
        reason: String,
        /// Path of the damaged database.
        set_aside: PathBuf,
    },
}

/// Database record to write or to delete.
pub(crate) struct RecordWrite {
    key: Vec<u8>,
    record: Option<Vec<u8>>,
}

impl WorldReport {
    fn of(condition: WorldCondition, model: &WorldModel) -> Self {
        Self {
            condition,
            n_objects: model.objects.len(),
            n_facts: model.facts.len(),
        }
    }

    /// `true` if the earlier content was lost; deserves a loud warning.
    pub fn is_loss(&self) -> bool {
        matches!(self.condition, WorldCondition::Reset { .. })
    }
}

impl fmt::Display for WorldReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.condition {
            WorldCondition::New => write!(f, "a new working memory was created")?,
            WorldCondition::Sound => write!(f, "the working memory is sound")?,
            WorldCondition::Reset { reason, set_aside } => write!(
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
    /// Opens or creates the working memory in `folder` and returns a report of its condition.
    ///
    /// Facts of the last process ended when their subject was last observed; tasks continue. A
    /// damaged database is renamed and replaced by an empty one. `wall_ns` is the present time,
    /// nanoseconds since 1970.
    ///
    /// Reads everything: a few seconds for a million facts.
    ///
    /// # Errors
    ///
    /// [`StorageError::InUse`], [`StorageError::NewerSchema`], or [`StorageError::Io`] when the
    /// folder cannot be read and written; nothing was renamed then.
    pub fn open(
        folder: &Path,
        config: WorldConfig,
        wall_ns: u64,
    ) -> Result<(Self, WorldModel, WorldReport), Error> {
        let folder = StoreFolder::hold(folder)?.with_write_buffer(config.write_buffer_bytes);
        let (engine, mut model, condition) = match read_database(&folder, config) {
            Ok((engine, Some(model))) => (engine, model, WorldCondition::Sound),
            Ok((engine, None)) => (engine, WorldModel::new(config), WorldCondition::New),
            Err(Error::Storage(StorageError::Damaged { what: reason })) => {
                let set_aside = folder.set_aside()?;
                let (engine, _) = read_database(&folder, config)?;
                let condition = WorldCondition::Reset { reason, set_aside };
                (engine, WorldModel::new(config), condition)
            }
            Err(error) => return Err(error),
        };
        let report = WorldReport::of(condition, &model);
        model.begin_session(wall_ns);
        let mut memory = Self {
            engine,
            _folder: folder,
        };
        memory.write_changes(&mut model)?;
        Ok((memory, model, report))
    }

    /// Loads the model of a working memory that cannot be written, and changes nothing.
    ///
    /// # Errors
    ///
    /// [`StorageError::InUse`], [`StorageError::Damaged`] or [`StorageError::Io`].
    pub(crate) fn load(
        folder: &Path,
        config: WorldConfig,
        wall_ns: u64,
    ) -> Result<(WorldModel, WorldReport), Error> {
        let folder = StoreFolder::hold_for_reading(folder)?;
        let engine = folder.open_database()?;
        let loaded = load_model(&engine, config)?;
        let mut model = loaded.unwrap_or_else(|| WorldModel::new(config));
        let report = WorldReport::of(WorldCondition::Sound, &model);
        model.begin_session(wall_ns);
        Ok((model, report))
    }

    /// Writes and syncs all changed records.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`] or [`StorageError::Damaged`]; what was to be written may be on disk
    /// or not.
    pub fn write_changes(&mut self, model: &mut WorldModel) -> Result<(), Error> {
        while model.has_changes() {
            self.write(model.take_writes())?;
        }
        Ok(())
    }

    /// Writes and syncs a batch of records atomically.
    pub(crate) fn write(&mut self, writes: Vec<RecordWrite>) -> Result<(), Error> {
        let mut batch = WriteBatch::default();
        for RecordWrite { key, record } in writes {
            match record {
                Some(record) => batch.put(&key, &record),
                None => batch.delete(&key),
            }
        }
        Ok(self.engine.write(batch, true)?)
    }

    /// Closes the working memory's database.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`]; what was written is on disk all the same.
    pub fn close(self) -> Result<(), Error> {
        Ok(self.engine.close()?)
    }
}

/// Opens the database and loads the model; `None` for a new database.
fn read_database(
    folder: &StoreFolder,
    config: WorldConfig,
) -> Result<(Database, Option<WorldModel>), Error> {
    let damaged = |what: String| Error::Storage(StorageError::Damaged { what });
    if folder.database_is_headless()? {
        return Err(damaged("its file CURRENT is missing".to_owned()));
    }
    let mut engine = folder.open_database()?;
    let model = load_model(&engine, config)?;
    engine.accept()?;
    Ok((engine, model))
}

/// Loads the model from an opened database; `None` for a new database.
fn load_model(engine: &Database, config: WorldConfig) -> Result<Option<WorldModel>, Error> {
    let mut loader = ModelLoader::new(config);
    engine.reader().scan(&[], |key, record| {
        loader.take(key, record);
        ControlFlow::Continue(())
    })?;
    let (n_damages, damages) = engine.damages();
    if n_damages > 0 {
        let what = damages.join("; ");
        return Err(Error::Storage(StorageError::Damaged { what }));
    }
    loader.finish()
}

/// Loader of a model from the records in key order.
struct ModelLoader {
    model: WorldModel,
    meta: Option<WorkingMeta>,
    n_records: usize,
    wrong: Option<Error>,
}

impl ModelLoader {
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
            let what = format!("{}: {wrong}", record_key::in_words(key));
            self.wrong
                .get_or_insert(Error::Storage(StorageError::Damaged { what }));
        }
    }

    fn insert(&mut self, key: &[u8], record: &[u8]) -> Result<(), &'static str> {
        match RecordKey::of(key).ok_or("its key is none")? {
            RecordKey::Meta => self.meta = Some(unseal(key, record)?),
            RecordKey::Robot => self.model.robot = Some(unseal(key, record)?),
            RecordKey::Object(_) => self.model.insert_object(unseal(key, record)?),
            RecordKey::Fact(_) => self.model.facts.insert(unseal(key, record)?),
            RecordKey::Event(_) => self.model.events.insert(unseal(key, record)?),
            RecordKey::Task(_) => self.model.tasks.insert(unseal(key, record)?),
            RecordKey::Surface(_) => self.model.surfaces.push(unseal(key, record)?),
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
            return Err(Error::Storage(StorageError::NewerSchema {
                found: meta.schema,
                known: SCHEMA,
            }));
        }
        match (meta, wrong) {
            (_, Some(wrong)) => Err(wrong),
            (None, None) if n_records == 0 => Ok(None),
            (None, None) => Err(Error::Storage(StorageError::Damaged {
                what: "the record about the working memory is missing".to_owned(),
            })),
            (Some(meta), None) => {
                model.facts.newest = model.facts.newest.max(meta.newest_fact);
                model.events.newest = model.events.newest.max(meta.newest_event);
                model.tasks.newest = model.tasks.newest.max(meta.newest_task);
                let newest_surface = model.surfaces.iter().map(|surface| surface.number).max();
                model.newest_surface = newest_surface.unwrap_or(0).max(meta.newest_surface);
                Ok(Some(model))
            }
        }
    }
}

impl WorldModel {
    /// Takes one batch of changed records out of the dirty set.
    pub(crate) fn take_writes(&mut self) -> Vec<RecordWrite> {
        let taken = std::iter::from_fn(|| self.dirty.take()).take(BATCH_RECORDS);
        let taken: Vec<RecordKey> = taken.collect();
        let write = |entry: RecordKey| {
            let key = entry.key();
            let record = self.sealed(entry, &key);
            RecordWrite { key, record }
        };
        taken.into_iter().map(write).collect()
    }

    /// Serialised record under a key; `None` for a removed item.
    fn sealed(&self, entry: RecordKey, key: &[u8]) -> Option<Vec<u8>> {
        match entry {
            RecordKey::Meta => {
                let meta = WorkingMeta {
                    schema: SCHEMA,
                    newest_fact: self.facts.newest,
                    newest_event: self.events.newest,
                    newest_task: self.tasks.newest,
                    newest_surface: self.newest_surface,
                };
                Some(seal(key, &meta))
            }
            RecordKey::Robot => self.robot.as_ref().map(|robot| seal(key, robot)),
            RecordKey::Object(id) => self.objects.get(&id).map(|object| seal(key, object)),
            RecordKey::Fact(number) => self.facts.get(number).map(|fact| seal(key, fact)),
            RecordKey::Event(sequence) => self.events.get(sequence).map(|event| seal(key, event)),
            RecordKey::Task(number) => self.tasks.get(number).map(|task| seal(key, task)),
            RecordKey::Surface(number) => self.surface(number).map(|surface| seal(key, surface)),
        }
    }

    /// Marks all records of this model and of `on_disk` as dirty, which replaces the database
    /// content.
    pub(crate) fn rewrite_over(&mut self, on_disk: &Self) {
        let entries: Vec<RecordKey> = on_disk.entries().chain(self.entries()).collect();
        for entry in entries {
            self.dirty.add(entry);
        }
    }

    fn entries(&self) -> impl Iterator<Item = RecordKey> {
        let objects = self.objects.keys().map(|id| RecordKey::Object(*id));
        let facts = self.facts.all().map(|fact| RecordKey::Fact(fact.number));
        let events = self
            .events
            .all()
            .map(|event| RecordKey::Event(event.sequence));
        let tasks = self.tasks.all().map(|task| RecordKey::Task(task.number));
        let surfaces = self.surfaces().map(|one| RecordKey::Surface(one.number));
        let single = [RecordKey::Meta, RecordKey::Robot].into_iter();
        single
            .chain(objects)
            .chain(facts)
            .chain(events)
            .chain(tasks)
            .chain(surfaces)
    }
}

#[cfg(test)]
mod tests;
