//! Opens a store whatever state it is in, and tells which that was.

use std::fmt;
use std::path::PathBuf;

use crate::engine::Engine;
use crate::error::Error;
use crate::examination::{Examination, examine};
use crate::meta::Meta;
use crate::perceptual_memory::PerceptualMemory;
use crate::salvage::{Loss, salvage};
use crate::store_folder::StoreFolder;
use crate::watermark::{Mark, Watermark};
use crate::writes::Writes;

/// What was found when the store was opened; `Display` is a sentence for log and health.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenReport {
    /// In which state it was.
    pub condition: Condition,
    /// Number of views now in it.
    pub n_views: u64,
    /// Number of those that have a name.
    pub n_labelled: u64,
    /// Number of different names.
    pub n_categories: u64,
    /// Number of history entries.
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
    /// It could not be opened at all; an empty one was begun.
    Replaced {
        /// What was wrong, in words.
        reason: String,
        /// Where the damaged database is kept, unless there was none left.
        set_aside: Option<PathBuf>,
    },
}

impl OpenReport {
    /// Whether anything that was acknowledged may be gone: to be told loudly.
    pub fn is_loss(&self) -> bool {
        matches!(
            self.condition,
            Condition::Rebuilt { .. } | Condition::Replaced { .. }
        )
    }
}

impl fmt::Display for OpenReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kept = |path: &Option<PathBuf>| match path {
            Some(path) => format!("the damaged database is kept as {}", path.display()),
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
                "the store was damaged and has been rebuilt; lost: {loss}; {} ({})",
                kept(set_aside),
                findings.join("; ")
            )?,
            Condition::Replaced { reason, set_aside } => write!(
                f,
                "the store could not be opened and an empty one was begun; {} ({reason})",
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
    folder.finish_interrupted_rebuild()?;
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
    let catalogue = examination.catalogue;
    let next_by_views = catalogue
        .last_track_id()
        .map_or(1, |last| last.saturating_add(1));
    let next_by_mark = mark.map_or(1, |mark| mark.next_track_id);
    meta.next_track_id = meta.next_track_id.max(next_by_views).max(next_by_mark);
    mark_and_sync(&watermark, &meta.mark()).map_err(Error::io("writing", folder.watermark()))?;
    let report = OpenReport {
        condition,
        n_views: catalogue.n_views() as u64,
        n_labelled: catalogue.n_labelled() as u64,
        n_categories: catalogue.n_categories() as u64,
        n_history: meta.sequence,
        notes,
    };
    Ok((
        PerceptualMemory::new(engine, catalogue, meta, watermark, folder),
        report,
    ))
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
    if folder.database_is_headless()? {
        return replace(folder, mark, "its file CURRENT is missing".to_owned());
    }
    let mut engine = match Engine::open(&folder.database()) {
        Ok(engine) => engine,
        Err(Error::Damaged { what }) => return replace(folder, mark, what),
        Err(error) => return Err(error),
    };
    let examination = match examine(&mut engine, mark) {
        Ok(examination) => examination,
        Err(Error::Damaged { what }) => {
            drop(engine);
            return replace(folder, mark, what);
        }
        Err(error) => return Err(error),
    };
    if examination.is_empty() {
        engine.accept()?;
        let lost = mark.is_some_and(|mark| mark.sequence > 0);
        let (engine, examination) = begin(engine, mark)?;
        let condition = if lost {
            let reason = "the folder of the database is missing or empty".to_owned();
            Condition::Replaced {
                reason,
                set_aside: None,
            }
        } else {
            Condition::New
        };
        return Ok((engine, examination, condition));
    }
    if examination.findings.is_empty() && !must_rebuild {
        engine.accept()?;
        return Ok((engine, examination, Condition::Sound));
    }
    rebuild(folder, engine, examination, mark, wall_ns)
}

/// Commits the record about an empty store.
fn begin(mut engine: Engine, mark: Option<&Mark>) -> Result<(Engine, Examination), Error> {
    let meta = Meta::new(mark.map_or(1, |mark| mark.next_track_id))?;
    Writes::default().commit(&mut engine, &meta)?;
    Ok((
        engine,
        Examination {
            meta: Some(meta),
            ..Examination::default()
        },
    ))
}

/// Sets the database aside and begins an empty one.
fn replace(folder: &StoreFolder, mark: Option<&Mark>, reason: String) -> Result<Opened, Error> {
    let set_aside = Some(folder.set_aside()?);
    let mut engine = Engine::open(&folder.database())?;
    engine.accept()?;
    let (engine, examination) = begin(engine, mark)?;
    Ok((
        engine,
        examination,
        Condition::Replaced { reason, set_aside },
    ))
}

/// Copies what is whole, sets the damaged database aside, and opens the copy.
fn rebuild(
    folder: &StoreFolder,
    mut damaged: Engine,
    examination: Examination,
    mark: Option<&Mark>,
    wall_ns: u64,
) -> Result<Opened, Error> {
    let mut copy = Engine::open(&folder.rebuilding())?;
    copy.accept()?;
    let salvaged = salvage(
        &mut damaged,
        &mut copy,
        examination.meta.as_ref(),
        mark,
        wall_ns,
    );
    // What is damaged cannot be closed cleanly, and is kept as it is.
    drop(damaged);
    let loss = match salvaged {
        Ok(loss) => loss,
        Err(Error::Damaged { what }) => {
            drop(copy);
            return replace(folder, mark, what);
        }
        Err(error) => return Err(error),
    };
    copy.close()?;
    let set_aside = folder.replace_by_rebuilding()?;
    let mut engine = Engine::open(&folder.database())?;
    let copied = examine(&mut engine, None)?;
    if let Some(finding) = copied.findings.first() {
        return Err(Error::Damaged {
            what: format!("a copy just made is damaged: {finding}"),
        });
    }
    engine.accept()?;
    let findings = examination.findings;
    Ok((
        engine,
        copied,
        Condition::Rebuilt {
            findings,
            loss,
            set_aside,
        },
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
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
                matches!(refused, Error::NewerSchema { found: 2, known: 1 }),
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
        let mut engine = Engine::open(&folder.path().join("database")).unwrap();
        let record = engine.reader().unwrap().get(b"m").unwrap().unwrap();
        let meta: Meta = crate::record::unseal(b"m", &record).unwrap();
        let found = Position {
            store_id: meta.store_id(),
            sequence: meta.sequence,
        };
        assert_eq!((meta.next_track_id, found), (2, position));
    }
}
