//! Reads the whole index of a database just opened, and checks it against itself.

use learning::ViewId;

use crate::catalogue::Catalogue;
use crate::document::DocumentVersion;
use crate::engine::{Engine, Reader};
use crate::error::{Error, in_words};
use crate::facts::Facts;
use crate::findings::Findings;
use crate::fold::Fold;
use crate::history::HistoryEntry;
use crate::keys;
use crate::meta::{Meta, SCHEMA};
use crate::record::{unseal, unseal_any};
use crate::standing::{Decided, Register};
use crate::track_id_counter;
use crate::watermark::Mark;

/// What a database holds, and what is wrong with it.
#[derive(Debug, Default)]
pub(crate) struct Examination {
    /// Missing in a database that was just created.
    pub(crate) meta: Option<Meta>,
    pub(crate) catalogue: Catalogue,
    pub(crate) n_history: u64,
    /// When the last entry was made.
    pub(crate) last_wall_ns: u64,
    /// Empty when all is as it was written.
    pub(crate) findings: Findings,
}

impl Examination {
    /// Whether nothing was ever committed.
    pub(crate) fn is_empty(&self) -> bool {
        self.meta.is_none()
            && self.n_history == 0
            && self.catalogue.n_all() == 0
            && self.findings.is_empty()
    }
}

/// The schema by which the database was written; none when that cannot be told.
///
/// # Errors
///
/// [`Error::NewerSchema`].
pub(crate) fn schema(engine: &mut Engine) -> Result<Option<u32>, Error> {
    let record = engine.reader()?.get(&[keys::META])?;
    record.map_or(Ok(None), |record| schema_of(&record))
}

/// The schema that the record about a store tells.
pub(crate) fn schema_of(meta: &[u8]) -> Result<Option<u32>, Error> {
    /// What every version of the record has.
    #[derive(serde::Deserialize)]
    struct AnyMeta {
        schema: u32,
    }
    match unseal_any::<AnyMeta>(&[keys::META], meta) {
        Ok((_, meta)) if meta.schema > SCHEMA => Err(Error::NewerSchema {
            found: meta.schema,
            known: SCHEMA,
        }),
        Ok((_, meta)) => Ok(Some(meta.schema)),
        Err(_) => Ok(None),
    }
}

/// Reads everything but descriptors, clouds and the content of documents.
///
/// # Errors
///
/// Only when the database cannot be read at all: damage is among the findings.
pub(crate) fn examine(engine: &mut Engine, mark: Option<&Mark>) -> Result<Examination, Error> {
    let mut reader = engine.reader()?;
    let mut found = Examination::default();
    read_meta(&mut reader, &mut found)?;
    read_views(&mut reader, &mut found)?;
    let mut fold = Fold::default();
    read_history(&mut reader, &mut found, &mut fold)?;
    read_registers(&mut reader, &mut found, &fold)?;
    read_documents(&mut reader, &mut found)?;
    read_tombstones(&mut reader, &mut found)?;
    fold.check_chain(&mut found.findings);
    fold.compare(&found.catalogue, &mut found.findings);
    found.catalogue.lost = fold.lost().to_vec();
    found.n_history = fold.n_entries();
    check_counts(&mut found, &fold, mark);
    let (n_damages, damages) = engine.damages();
    found.findings.extend(n_damages, damages);
    Ok(found)
}

fn read_meta(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    let Some(record) = reader.get(&[keys::META])? else {
        return Ok(());
    };
    match unseal::<Meta>(&[keys::META], &record) {
        Ok(meta) => found.meta = Some(meta),
        Err(wrong) => found
            .findings
            .add(|| format!("the record about the store: {wrong}")),
    }
    Ok(())
}

fn read_views(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    reader.scan_prefix(&[keys::VIEW], |key, record| {
        match (keys::view_of(key), unseal::<Facts>(key, record)) {
            (Some(view), Ok(facts)) => {
                let register = Register::untouched(0);
                found.catalogue.insert(view, &facts, register);
            }
            (Some(view), Err(wrong)) => found
                .findings
                .add(|| format!("{}: {wrong}", in_words(view))),
            (None, _) => found
                .findings
                .add(|| format!("a view's key is none: {key:?}")),
        }
    })
}

fn read_history(
    reader: &mut Reader,
    found: &mut Examination,
    fold: &mut Fold,
) -> Result<(), Error> {
    reader.scan_prefix(&[keys::HISTORY], |key, record| {
        let Some(sequence) = keys::sequence_of(key) else {
            found
                .findings
                .add(|| format!("a history entry's key is none: {key:?}"));
            return;
        };
        match HistoryEntry::unseal(sequence, record) {
            Ok((entry, digest)) => {
                fold.apply(&entry, digest);
                found.last_wall_ns = entry.wall_ns;
                if let Some(id) = entry.mutation {
                    found.catalogue.answered.insert(id, sequence);
                }
            }
            Err(wrong) => found
                .findings
                .add(|| format!("history entry {sequence}: {wrong}")),
        }
    })
}

/// After the history, which tells what touched the views that nobody has decided on.
fn read_registers(reader: &mut Reader, found: &mut Examination, fold: &Fold) -> Result<(), Error> {
    for (&view, folded) in &fold.views {
        let register = Register::untouched(folded.sequence);
        found.catalogue.set(view, register);
    }
    reader.scan_prefix(&[keys::REGISTER], |key, record| {
        let register = unseal::<Register>(key, record);
        match (keys::view_of(key), register) {
            (Some(view), Ok(_)) if found.catalogue.get(view).is_none() => found
                .findings
                .add(|| format!("{} is missing, though it has a standing", in_words(view))),
            (Some(view), Ok(register)) => check_register(found, fold, view, register),
            (Some(view), Err(wrong)) => found
                .findings
                .add(|| format!("the standing of {}: {wrong}", in_words(view))),
            (None, _) => found
                .findings
                .add(|| format!("a standing's key is none: {key:?}")),
        }
    })
}

fn check_register(found: &mut Examination, fold: &Fold, view: ViewId, register: Register) {
    let folded = fold.views.get(&view);
    if folded.is_some_and(|folded| folded.sequence != register.sequence) {
        found
            .findings
            .add(|| format!("the standing of {} is an older one", in_words(view)));
    }
    found.catalogue.set(view, register);
}

fn read_documents(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    reader.scan_prefix(&[keys::DOCUMENT], |key, record| {
        let version = unseal::<DocumentVersion>(key, record);
        match (keys::document_of(key), version) {
            (Some((document, sequence)), Ok(version)) => {
                found.catalogue.insert_version(&document, sequence, version);
            }
            (Some((document, sequence)), Err(wrong)) => found
                .findings
                .add(|| format!("{document}, as of entry {sequence}: {wrong}")),
            (None, _) => found
                .findings
                .add(|| format!("a document's key is none: {key:?}")),
        }
    })
}

fn read_tombstones(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    reader.scan_prefix(&[keys::TOMBSTONE], |key, record| {
        match (keys::digest_of(key), unseal::<Decided>(key, record)) {
            (Some(identity), Ok(decided)) => {
                found.catalogue.tombstones.insert(identity, decided);
            }
            (Some(identity), Err(wrong)) => found
                .findings
                .add(|| format!("the note of the forgotten view {identity}: {wrong}")),
            (None, _) => found
                .findings
                .add(|| format!("a forgotten view's key is none: {key:?}")),
        }
    })
}

/// Compares with what was counted when it was written.
fn check_counts(found: &mut Examination, fold: &Fold, mark: Option<&Mark>) {
    let n_views = found.catalogue.n_all() as u64;
    let findings = &mut found.findings;
    let Some(meta) = &found.meta else {
        if found.n_history > 0 || n_views > 0 {
            findings.add(|| "the record about the store is missing".to_owned());
        }
        return;
    };
    let (sequence, head) = fold.head();
    if (meta.sequence, meta.head) != (sequence, head) {
        let last = meta.sequence;
        findings.add(|| format!("the history ends with entry {sequence}, not {last}"));
    }
    if meta.n_views != n_views {
        let n = meta.n_views;
        findings.add(|| format!("{n_views} of {n} views are whole"));
    }
    if !track_id_counter::is_plausible(meta.next_track_id) {
        let next = meta.next_track_id;
        findings.add(|| format!("the next track-id is {next}, which no lease can have reached"));
    }
    if let Some(mark) = mark
        && mark.store_id == meta.store_id().0
        && mark.sequence > meta.sequence
    {
        let (first, last) = (meta.sequence + 1, mark.sequence);
        findings.add(|| format!("acknowledged history entries {first} to {last} are missing"));
    }
}
