//! Opens a store whatever state it is in, and tells which that was.

use std::fmt;
use std::path::PathBuf;

use crate::engine::Engine;
use crate::error::Error;
use crate::examination::{self, Examination, examine};
use crate::meta::{Meta, SCHEMA};
use crate::perceptual_memory::PerceptualMemory;
use crate::salvage::{Loss, Salvaged, salvage};
use crate::store_folder::StoreFolder;
use crate::track_id_counter;
use crate::watermark::{Mark, Watermark};
use crate::writes::Writes;

/// What was found when the store was opened; `Display` is a sentence for log and health.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenReport {
    /// In which state it was.
    pub condition: Condition,
    /// Number of views now in it, without those that are forgotten.
    pub n_views: u64,
    /// Number of those that have a name.
    pub n_labelled: u64,
    /// Number of different names.
    pub n_categories: u64,
    /// Sequence of the last history entry.
    pub n_history: u64,
    /// What is worth knowing and lost nothing, in words.
    pub notes: Vec<String>,
}

/// The state a store was found in.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condition {
    /// There was none; it was created.
    New,
    /// All is as it was written.
    Sound,
    /// It was damaged; what is whole was copied, under a new store id.
    Rebuilt {
        /// What was wrong, in words.
        findings: Vec<String>,
        /// What could not be copied.
        loss: Loss,
        /// Where the damaged database is kept.
        set_aside: Option<PathBuf>,
    },
    /// It was written by an older version; all of it was brought into the new form.
    Migrated {
        /// The older schema.
        schema: u32,
        /// Where the database of the older version is kept.
        set_aside: Option<PathBuf>,
    },
    /// Nothing in it was whole; an empty one was begun.
    Replaced {
        /// What was wrong, in words.
        reason: String,
        /// What it had.
        loss: Loss,
        /// Where the damaged database is kept, unless there was none left.
        set_aside: Option<PathBuf>,
    },
}

impl OpenReport {
    /// What was acknowledged and is gone.
    pub fn loss(&self) -> Loss {
        match &self.condition {
            Condition::Rebuilt { loss, .. } | Condition::Replaced { loss, .. } => *loss,
            _ => Loss::default(),
        }
    }

    /// Whether anything that was acknowledged is gone: to be told loudly.
    pub fn is_loss(&self) -> bool {
        self.loss() != Loss::default()
    }

    /// Whether anything was damaged, even if all of it could be restored.
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
            Condition::Rebuilt {
                findings,
                loss,
                set_aside,
            } => write!(
                f,
                "the store was made anew from what is whole; lost: {loss}; {}{}",
                kept(set_aside),
                match findings.join("; ") {
                    none if none.is_empty() => none,
                    findings => format!(" ({findings})"),
                }
            )?,
            Condition::Migrated { schema, set_aside } => write!(
                f,
                "the store was brought from schema {schema} to {SCHEMA}; {}",
                match set_aside {
                    Some(path) => format!("the old database is kept as {}", path.display()),
                    None => "the old database is gone".to_owned(),
                }
            )?,
            Condition::Replaced {
                reason,
                loss,
                set_aside,
            } => write!(
                f,
                "nothing in the store was whole and an empty one was begun; lost: {loss}; {} \
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

/// Opens what is in the folder; see [`PerceptualMemory::open`].
pub(crate) fn open(
    folder: StoreFolder,
    wall_ns: u64,
    must_rebuild: bool,
) -> Result<(PerceptualMemory, OpenReport), Error> {
    folder.tidy()?;
    let path = folder.watermark();
    let (watermark, mark) = Watermark::open(&path).map_err(Error::io("opening", path))?;
    let mut notes = Vec::new();
    let mark = mark.unwrap_or_else(|wrong| {
        notes.push(format!(
            "the note of what was acknowledged is unreadable: {wrong}"
        ));
        None
    });
    let opened = open_database(&folder, mark.as_ref(), wall_ns, must_rebuild)?;
    let (engine, examination, condition) = opened;
    let Some(mut meta) = examination.meta else {
        return Err(Error::Damaged {
            what: "a store just begun has no record about it".to_owned(),
        });
    };
    notes.extend(clock_note(wall_ns, examination.last_wall_ns));
    let catalogue = examination.catalogue;
    // A lease is marked before it is answered, and is given once even if the database lost it.
    let next_by_mark = mark.map(|mark| mark.next_track_id);
    if let Some(next) = next_by_mark.filter(|next| track_id_counter::is_plausible(*next)) {
        meta.next_track_id = meta.next_track_id.max(next);
    }
    mark_and_sync(&watermark, &meta.mark()).map_err(Error::io("writing", folder.watermark()))?;
    let report = OpenReport {
        condition,
        n_views: (catalogue.n_all() - catalogue.n_forgotten()) as u64,
        n_labelled: catalogue.n_named() as u64,
        n_categories: catalogue.n_categories() as u64,
        n_history: meta.sequence,
        notes,
    };
    Ok((
        PerceptualMemory::new(engine, catalogue, meta, watermark, folder),
        report,
    ))
}

/// Entries are ordered by their numbers, so a clock that was set back loses nothing;
/// but whoever reads the history should know.
fn clock_note(wall_ns: u64, last_wall_ns: u64) -> Option<String> {
    let behind_s = last_wall_ns.checked_sub(wall_ns)? / 1_000_000_000;
    (behind_s > 0).then(|| {
        format!(
            "the clock is {behind_s} s behind the last history entry: it was set back, or was \
             wrong then; entries keep their order"
        )
    })
}

fn mark_and_sync(watermark: &Watermark, mark: &Mark) -> std::io::Result<()> {
    watermark.write(mark)?;
    watermark.trim()?;
    watermark.sync()
}

type Opened = (Engine, Examination, Condition);

fn open_database(
    folder: &StoreFolder,
    mark: Option<&Mark>,
    wall_ns: u64,
    must_rebuild: bool,
) -> Result<Opened, Error> {
    let rebuild = |findings: Vec<String>| rebuild(folder, mark, wall_ns, findings);
    if folder.database_is_headless()? {
        return rebuild(vec!["its file CURRENT is missing".to_owned()]);
    }
    let mut engine = match folder.open_database() {
        Ok(engine) => engine,
        Err(Error::Damaged { what }) => return rebuild(vec![what]),
        Err(error) => return Err(error),
    };
    // An older schema is rebuilt in the new form.
    let schema = match examination::schema(&mut engine) {
        Err(error @ Error::NewerSchema { .. }) => return Err(error),
        schema => schema.unwrap_or(None),
    };
    let examined = match schema {
        Some(schema) if schema < SCHEMA => None,
        _ => Some(examine(&mut engine, mark)),
    };
    let findings = match examined {
        None => Vec::new(),
        Some(Ok(examination)) if examination.is_empty() => return begin(engine, mark),
        Some(Ok(examination)) if examination.findings.is_empty() && !must_rebuild => {
            engine.accept()?;
            return Ok((engine, examination, Condition::Sound));
        }
        Some(Ok(examination)) => examination.findings.into_words(),
        Some(Err(Error::Damaged { what })) => vec![what],
        Some(Err(error)) => return Err(error),
    };
    // What is damaged cannot be closed cleanly, and is kept as it is.
    drop(engine);
    rebuild(findings)
}

/// An empty database: a new one, or all that is left of one that is gone.
fn begin(mut engine: Engine, mark: Option<&Mark>) -> Result<Opened, Error> {
    engine.accept()?;
    let examination = commit_empty(&mut engine, mark)?;
    let condition = match mark.filter(|mark| mark.sequence > 0) {
        None => Condition::New,
        Some(lost) => Condition::Replaced {
            reason: "the folder of the database is missing or empty".to_owned(),
            loss: all_of(lost),
            set_aside: None,
        },
    };
    Ok((engine, examination, condition))
}

fn all_of(mark: &Mark) -> Loss {
    Loss {
        n_history: mark.sequence,
        n_views: mark.n_views,
        ..Loss::default()
    }
}

/// Commits the record about an empty store.
fn commit_empty(engine: &mut Engine, mark: Option<&Mark>) -> Result<Examination, Error> {
    let memory_id = mark.map(|mark| mark.memory_id);
    let next_track_id = match mark {
        Some(mark) => track_id_counter::recovered([mark.next_track_id], []),
        None => 1,
    };
    let meta = Meta::new(memory_id, next_track_id)?;
    Writes::default().commit(engine, &meta)?;
    Ok(Examination {
        meta: Some(meta),
        ..Examination::default()
    })
}

/// Sets the database aside and begins an empty one.
fn replace(folder: &StoreFolder, mark: Option<&Mark>, reason: String) -> Result<Opened, Error> {
    let set_aside = Some(folder.set_aside()?);
    let mut engine = folder.open_database()?;
    engine.accept()?;
    let examination = commit_empty(&mut engine, mark)?;
    let condition = Condition::Replaced {
        reason,
        loss: mark.map_or_else(Loss::default, all_of),
        set_aside,
    };
    Ok((engine, examination, condition))
}

/// Makes a database of what is whole, sets the other one aside, and opens the new.
fn rebuild(
    folder: &StoreFolder,
    mark: Option<&Mark>,
    wall_ns: u64,
    findings: Vec<String>,
) -> Result<Opened, Error> {
    let mut copy = folder.open_rebuilding()?;
    copy.accept()?;
    let salvaged = salvage(&folder.database(), &mut copy, mark, wall_ns)?;
    let Some(Salvaged {
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
    let copied = examine(&mut engine, None)?;
    if !copied.findings.is_empty() {
        let findings = copied.findings.into_words().join("; ");
        return Err(Error::Damaged {
            what: format!("a copy just made is damaged: {findings}"),
        });
    }
    engine.accept()?;
    let condition = match migrated_from {
        Some(schema) if loss == Loss::default() => Condition::Migrated { schema, set_aside },
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
    use crate::engine::WRITE_BUFFER_BYTES;
    use crate::meta::SCHEMA;
    use crate::reading::Position;
    use std::fs;

    #[test]
    fn a_newer_schema_is_refused_and_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
        let position = memory.position();
        memory.meta.schema = SCHEMA + 1;
        memory.lease_track_ids(1).unwrap();
        drop(memory);
        for must_rebuild in [false, true] {
            let held = StoreFolder::hold(folder.path()).unwrap();
            let refused = open(held, 2, must_rebuild).map(|_| ()).unwrap_err();
            assert!(
                matches!(refused, Error::NewerSchema { found: 3, known: 2 }),
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
        let mut engine = Engine::open(&folder.path().join("database"), WRITE_BUFFER_BYTES).unwrap();
        let record = engine.reader().unwrap().get(b"m").unwrap().unwrap();
        let meta: Meta = crate::record::unseal(b"m", &record).unwrap();
        let found = Position {
            store_id: meta.store_id(),
            sequence: meta.sequence,
        };
        assert_eq!((meta.next_track_id, found), (2, position));
    }
}
