//! Opening of a store in any condition: examination, recovery, migration, and a report.

use std::fmt;
use std::path::{Path, PathBuf};

use durable_leveldb::{Database, StoreFolder};

use crate::archive::{self, ArchiveRecord, HistoryArchive};
use crate::consistency_check::{self, ConsistencyReport, check_consistency};
use crate::error::{Error, StorageError};
use crate::meta::{Meta, SCHEMA};
use crate::model::{DataLoss, RetentionLimits};
use crate::perceptual_memory::PerceptualMemory;
use crate::record_batch::RecordBatch;
use crate::salvage::{SalvageOutcome, salvage};
use crate::store_index::StoreIndex;
use crate::track_id_counter;
use crate::watermark::{self, Watermark, WatermarkRecord};

/// Report of opening a store; `Display` gives a sentence for log and health status.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenReport {
    /// Condition in which the store was found.
    pub condition: Condition,
    /// Number of stored views, without forgotten ones.
    pub n_views: u64,
    /// Number of labelled views.
    pub n_labelled: u64,
    /// Number of categories.
    pub n_categories: u64,
    /// Sequence number of the last history entry.
    pub n_history: u64,
    /// Observations that are no losses, as sentences.
    pub notes: Vec<String>,
}

/// Condition in which a store was found.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condition {
    /// Store was missing; a new one was created.
    New,
    /// Intact store.
    Sound,
    /// Damaged; all intact records were copied, under a new store id.
    Rebuilt {
        /// Detected corruptions of the store, as sentences.
        findings: Vec<String>,
        /// Content that could not be copied.
        loss: DataLoss,
        /// Path of the damaged database.
        set_aside: Option<PathBuf>,
    },
    /// Store with an older schema, migrated without loss.
    Migrated {
        /// Schema version before the migration.
        schema: u32,
        /// Path of the database before the migration.
        set_aside: Option<PathBuf>,
    },
    /// Intact store whose disk cannot be written; it is only read.
    ReadOnly {
        /// Error that keeps the store from being written, as a sentence.
        reason: String,
    },
    /// Damaged without any intact record; an empty store was created.
    Replaced {
        /// Detected corruption of the store, as a sentence.
        reason: String,
        /// Content lost with the old store.
        loss: DataLoss,
        /// Path of the damaged database, if anything of it was left.
        set_aside: Option<PathBuf>,
    },
}

impl OpenReport {
    pub(crate) fn of(
        condition: Condition,
        index: &StoreIndex,
        n_history: u64,
        notes: Vec<String>,
    ) -> Self {
        Self {
            condition,
            n_views: (index.n_all() - index.n_forgotten()) as u64,
            n_labelled: index.n_named() as u64,
            n_categories: index.n_categories() as u64,
            n_history,
            notes,
        }
    }

    /// Acknowledged content that was lost.
    pub fn loss(&self) -> DataLoss {
        match &self.condition {
            Condition::Rebuilt { loss, .. } | Condition::Replaced { loss, .. } => *loss,
            _ => DataLoss::default(),
        }
    }

    /// `true` if acknowledged content was lost; deserves a loud warning.
    pub fn is_loss(&self) -> bool {
        self.loss() != DataLoss::default()
    }

    /// `true` if the store can only be read.
    pub fn is_read_only(&self) -> bool {
        matches!(self.condition, Condition::ReadOnly { .. })
    }

    /// `true` if anything was damaged, even if all of it could be restored.
    pub fn is_damage(&self) -> bool {
        matches!(
            self.condition,
            Condition::Rebuilt { .. } | Condition::Replaced { .. }
        )
    }
}

impl fmt::Display for OpenReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kept = |path: &Option<PathBuf>| match path {
            Some(path) => format!("the old database is kept as {}", path.display()),
            None => "nothing of the old database is left".to_owned(),
        };
        match &self.condition {
            Condition::New => write!(f, "a new store was created")?,
            Condition::Sound => write!(f, "the store is sound")?,
            Condition::ReadOnly { reason } => write!(
                f,
                "the store can only be read, and nothing can be stored: {reason}"
            )?,
            Condition::Rebuilt {
                findings,
                loss,
                set_aside,
            } => write!(
                f,
                "the store was rebuilt from its intact records; lost: {loss}; {}{}",
                kept(set_aside),
                match findings.join("; ") {
                    none if none.is_empty() => none,
                    findings => format!(" ({findings})"),
                }
            )?,
            Condition::Migrated { schema, set_aside } => write!(
                f,
                "the store was migrated from schema {schema} to {SCHEMA}; {}",
                match set_aside {
                    Some(path) => format!("the old database is kept as {}", path.display()),
                    None => "the old database was not kept".to_owned(),
                }
            )?,
            Condition::Replaced {
                reason,
                loss,
                set_aside,
            } => write!(
                f,
                "the store had no intact record and was replaced by an empty one; lost: {loss}; {} \
                 ({reason})",
                kept(set_aside)
            )?,
        }
        let Self {
            n_views,
            n_labelled,
            n_categories,
            n_history,
            ..
        } = self;
        write!(
            f,
            ": {n_views} views, {n_labelled} of them in {n_categories} categories, {n_history} \
             history entries"
        )?;
        self.notes.iter().try_for_each(|note| write!(f, "; {note}"))
    }
}

impl PerceptualMemory {
    /// Opens or creates the store in `folder` and returns a report of its condition.
    ///
    /// A damaged database never stops the daemon: its intact records are copied, the damaged
    /// database is renamed, and the report counts the losses. `wall_ns` is the
    /// present time, nanoseconds since 1970, UTC, for the history entry about a rebuild.
    ///
    /// Reads the index rows, and the history behind its archived part.
    ///
    /// # Errors
    ///
    /// [`StorageError::InUse`], [`StorageError::NewerSchema`], or [`StorageError::Io`] when the
    /// folder cannot be read and written; nothing was renamed then.
    pub fn open(folder: &Path, wall_ns: u64) -> Result<(Self, OpenReport), Error> {
        open(
            StoreFolder::hold(folder)?,
            wall_ns,
            RetentionLimits::default(),
            false,
        )
    }

    /// Opens the store like [`Self::open`], but also reads descriptors and point clouds and
    /// rebuilds the database from all intact records. For use after [`StorageError::Damaged`].
    ///
    /// # Errors
    ///
    /// As [`Self::open`].
    pub fn open_and_rebuild(folder: &Path, wall_ns: u64) -> Result<(Self, OpenReport), Error> {
        open(
            StoreFolder::hold(folder)?,
            wall_ns,
            RetentionLimits::default(),
            true,
        )
    }
}

/// Opens the store in a locked folder; see [`PerceptualMemory::open`].
pub(crate) fn open(
    folder: StoreFolder,
    wall_ns: u64,
    limits: RetentionLimits,
    must_rebuild: bool,
) -> Result<(PerceptualMemory, OpenReport), Error> {
    folder.clean_up()?;
    let path = watermark::path(&folder);
    let (watermark, mark) = Watermark::open(&path).map_err(StorageError::io("opening", path))?;
    let mut notes = Vec::new();
    let mark = mark.unwrap_or_else(|wrong| {
        notes.push(format!(
            "the watermark of acknowledged changes is unreadable: {wrong}"
        ));
        None
    });
    let opened = open_database(&folder, mark.as_ref(), wall_ns, must_rebuild)?;
    let (engine, examination, condition) = opened;
    let Some(mut meta) = examination.meta else {
        return Err(Error::Storage(StorageError::Damaged {
            what: "a store just begun has no record about it".to_owned(),
        }));
    };
    notes.extend(clock_note(wall_ns, examination.last_wall_ns));
    let index = examination.index;
    let mut archive = open_archive(&folder, examination.archived, &mut notes)?;
    notes.extend(archive.load_answered(wall_ns.saturating_sub(limits.history.answered_kept_ns)));
    // The watermark records a lease before it is answered, so that it stays unique even if
    // the database lost it.
    let next_by_mark = mark.map(|mark| mark.next_track_id);
    if let Some(next) = next_by_mark.filter(|next| track_id_counter::is_plausible(*next)) {
        meta.next_track_id = meta.next_track_id.max(next);
    }
    mark_and_sync(&watermark, &meta.mark())
        .map_err(StorageError::io("writing", watermark::path(&folder)))?;
    let report = OpenReport::of(condition, &index, meta.sequence, notes);
    let mut memory = PerceptualMemory::new((engine, archive), index, meta, watermark, folder);
    memory.set_limits(limits);
    memory.sizes = examination.sizes;
    memory.last_wall_ns = wall_ns;
    Ok((memory, report))
}

/// Opens the archive of the history; missing segments are noted.
fn open_archive(
    folder: &StoreFolder,
    record: ArchiveRecord,
    notes: &mut Vec<String>,
) -> Result<HistoryArchive, Error> {
    let archive = HistoryArchive::open(archive::path(folder), record)?;
    archive.clean_up()?;
    for (first, last) in archive.missing() {
        notes.push(format!(
            "history entries {first} to {last} are missing in {}; restore that folder, or note \
             them as lost: tabula memory repair",
            archive::path(folder).display()
        ));
    }
    Ok(archive)
}

/// Note about a clock behind the last history entry. Entries are ordered by sequence number, so a
/// clock that was set back loses nothing.
fn clock_note(wall_ns: u64, last_wall_ns: u64) -> Option<String> {
    let behind_s = last_wall_ns.checked_sub(wall_ns)? / 1_000_000_000;
    (behind_s > 0).then(|| {
        format!(
            "the clock is {behind_s} s behind the last history entry: it was set back, or was \
             wrong then; entries keep their order"
        )
    })
}

fn mark_and_sync(watermark: &Watermark, mark: &WatermarkRecord) -> std::io::Result<()> {
    watermark.write(mark)?;
    watermark.trim()?;
    watermark.sync()
}

type Opened = (Database, ConsistencyReport, Condition);

fn open_database(
    folder: &StoreFolder,
    mark: Option<&WatermarkRecord>,
    wall_ns: u64,
    must_rebuild: bool,
) -> Result<Opened, Error> {
    let rebuild = |findings: Vec<String>| rebuild(folder, mark, wall_ns, findings);
    if folder.database_is_headless()? {
        return rebuild(vec!["its file CURRENT is missing".to_owned()]);
    }
    let mut engine = match folder.open_database().map_err(Error::from) {
        Ok(engine) => engine,
        Err(Error::Storage(StorageError::Damaged { what })) => return rebuild(vec![what]),
        Err(error) => return Err(error),
    };
    // An older schema is migrated by a rebuild.
    let schema = match consistency_check::schema(&engine.reader()) {
        Err(error @ Error::Storage(StorageError::NewerSchema { .. })) => return Err(error),
        schema => schema.unwrap_or(None),
    };
    let examined = match schema {
        Some(schema) if schema < SCHEMA => None,
        _ => Some(check_consistency(&engine.reader(), mark)),
    };
    let findings = match examined {
        None => Vec::new(),
        Some(Ok(examination)) if examination.is_empty() => match remains(folder)? {
            Some(finding) => vec![finding],
            None => match begin(&mut engine, mark) {
                Ok((examination, condition)) => return Ok((engine, examination, condition)),
                Err(Error::Storage(StorageError::Damaged { what })) => vec![what],
                Err(error) => return Err(error),
            },
        },
        Some(Ok(examination)) if examination.findings.is_empty() && !must_rebuild => {
            match engine.accept().map_err(Error::from) {
                Ok(()) => return Ok((engine, examination, Condition::Sound)),
                Err(Error::Storage(StorageError::Damaged { what })) => vec![what],
                Err(error) => return Err(error),
            }
        }
        Some(Ok(examination)) => examination.findings.into_words(),
        Some(Err(Error::Storage(StorageError::Damaged { what }))) => vec![what],
        Some(Err(error)) => return Err(error),
    };
    // A damaged database cannot be closed cleanly; its files stay as they are.
    drop(engine);
    rebuild(findings)
}

/// Finding about a database without records from which something can be rebuilt; `None` if nothing
/// is left of it.
fn remains(folder: &StoreFolder) -> Result<Option<String>, Error> {
    let finding = if folder.database_has_tables()? {
        "the tables of the database are missing in its manifest"
    } else if archive::has_segments(folder)? {
        // The archive has the history of a database that is gone.
        "the folder of the database is missing or empty"
    } else {
        return Ok(None);
    };
    Ok(Some(finding.to_owned()))
}

/// Initialises an empty database: a new one, or the replacement of a missing one.
fn begin(
    engine: &mut Database,
    mark: Option<&WatermarkRecord>,
) -> Result<(ConsistencyReport, Condition), Error> {
    engine.accept()?;
    let examination = commit_empty(engine, mark)?;
    let condition = match mark.filter(|mark| mark.sequence > 0) {
        None => Condition::New,
        Some(lost) => Condition::Replaced {
            reason: "the folder of the database is missing or empty".to_owned(),
            loss: all_of(lost),
            set_aside: None,
        },
    };
    Ok((examination, condition))
}

fn all_of(mark: &WatermarkRecord) -> DataLoss {
    DataLoss {
        n_history: mark.sequence,
        n_views: mark.n_views,
        ..DataLoss::default()
    }
}

/// Commits the metadata record of an empty store.
fn commit_empty(
    engine: &mut Database,
    mark: Option<&WatermarkRecord>,
) -> Result<ConsistencyReport, Error> {
    let memory_id = mark.map(|mark| mark.memory_id);
    let next_track_id = match mark {
        Some(mark) => track_id_counter::recovered([mark.next_track_id], []),
        None => 1,
    };
    let meta = Meta::new(memory_id, next_track_id)?;
    RecordBatch::default().commit(engine, &meta)?;
    Ok(ConsistencyReport {
        meta: Some(meta),
        ..ConsistencyReport::default()
    })
}

/// Sets the database aside and creates an empty one.
fn replace(
    folder: &StoreFolder,
    mark: Option<&WatermarkRecord>,
    reason: String,
) -> Result<Opened, Error> {
    let set_aside = Some(folder.set_aside()?);
    let mut engine = folder.open_database()?;
    engine.accept()?;
    let examination = commit_empty(&mut engine, mark)?;
    let condition = Condition::Replaced {
        reason,
        loss: mark.map_or_else(DataLoss::default, all_of),
        set_aside,
    };
    Ok((engine, examination, condition))
}

/// Rebuilds the database from its intact records, sets the old one aside, and opens the new one.
fn rebuild(
    folder: &StoreFolder,
    mark: Option<&WatermarkRecord>,
    wall_ns: u64,
    findings: Vec<String>,
) -> Result<Opened, Error> {
    let mut copy = folder.open_rebuilding()?;
    copy.accept()?;
    let salvaged = salvage(folder, &mut copy, mark, wall_ns)?;
    let Some(SalvageOutcome {
        loss,
        migrated_from,
    }) = salvaged
    else {
        drop(copy);
        return replace(folder, mark, findings.join("; "));
    };
    copy.close()?;
    let set_aside = folder.replace_by_rebuilding()?;
    let mut engine = folder.open_database()?;
    let copied = check_consistency(&engine.reader(), None)?;
    if !copied.findings.is_empty() {
        let findings = copied.findings.into_words().join("; ");
        return Err(Error::Storage(StorageError::Damaged {
            what: format!("a copy just made is damaged: {findings}"),
        }));
    }
    engine.accept()?;
    let condition = match migrated_from {
        Some(schema) if loss == DataLoss::default() => Condition::Migrated { schema, set_aside },
        _ => Condition::Rebuilt {
            findings,
            loss,
            set_aside,
        },
    };
    Ok((engine, copied, condition))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meta::SCHEMA;
    use crate::queries::Position;
    use durable_leveldb::WRITE_BUFFER_BYTES;
    use std::fs;

    #[test]
    fn newer_schema_is_refused_and_left_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
        let position = memory.position();
        memory.meta.schema = SCHEMA + 1;
        memory.lease_track_ids(1).unwrap();
        drop(memory);
        for must_rebuild in [false, true] {
            let held = StoreFolder::hold(folder.path()).unwrap();
            let limits = RetentionLimits::default();
            let refused = open(held, 2, limits, must_rebuild).map(|_| ()).unwrap_err();
            assert!(
                matches!(
                    refused,
                    Error::Storage(StorageError::NewerSchema { found: 4, known: 3 })
                ),
                "{refused}"
            );
        }
        let names = fs::read_dir(folder.path())
            .unwrap()
            .flatten()
            .map(|entry| entry.file_name());
        assert!(
            !names
                .into_iter()
                .any(|name| name.to_string_lossy().contains("damaged"))
        );
        // The newer program finds everything as it was.
        let engine = Database::open(&folder.path().join("database"), WRITE_BUFFER_BYTES).unwrap();
        let record = engine.reader().get(b"m").unwrap().unwrap();
        let meta: Meta = durable_leveldb::record::unseal(b"m", &record).unwrap();
        let found = Position {
            store_id: meta.store_id(),
            sequence: meta.sequence,
        };
        assert_eq!((meta.next_track_id, found), (2, position));
    }
}
