//! Consistency check: loads the index of a database and compares it with its history.

use durable_leveldb::{
    Database, Reader,
    record::{unseal, unseal_any},
};
use learning::ViewId;

use crate::document::DocumentVersion;
use crate::error::{Error, StorageError};
use crate::findings::Findings;
use crate::history::HistoryEntry;
use crate::history_projection::HistoryProjection;
use crate::keys;
use crate::label_status::{DecisionStamp, LwwRegister};
use crate::meta::{Meta, SCHEMA};
use crate::store_index::StoreIndex;
use crate::track_id_counter;
use crate::view_phrase::view_phrase;
use crate::view_record::ViewMetadata;
use crate::watermark::WatermarkRecord;

/// Loaded index and detected inconsistencies.
#[derive(Debug, Default)]
pub(crate) struct ConsistencyReport {
    /// Metadata record; `None` for a database that was just created.
    pub(crate) meta: Option<Meta>,
    pub(crate) index: StoreIndex,
    pub(crate) n_history: u64,
    /// Time of the last history entry, nanoseconds since 1970, UTC.
    pub(crate) last_wall_ns: u64,
    /// Detected inconsistencies; empty for an intact database.
    pub(crate) findings: Findings,
}

impl ConsistencyReport {
    /// `true` if nothing was ever committed to the database.
    pub(crate) fn is_empty(&self) -> bool {
        self.meta.is_none()
            && self.n_history == 0
            && self.index.n_all() == 0
            && self.findings.is_empty()
    }
}

/// Schema version of the database; `None` if it is unreadable.
///
/// # Errors
///
/// [`StorageError::NewerSchema`].
pub(crate) fn schema(engine: &mut Database) -> Result<Option<u32>, Error> {
    let record = engine.reader()?.get(&[keys::META])?;
    record.map_or(Ok(None), |record| schema_of(&record))
}

/// Schema version stated in a metadata record.
pub(crate) fn schema_of(meta: &[u8]) -> Result<Option<u32>, Error> {
    /// Field that every version of the metadata record has.
    #[derive(serde::Deserialize)]
    struct AnyMeta {
        schema: u32,
    }
    match unseal_any::<AnyMeta>(&[keys::META], meta) {
        Ok((_, meta)) if meta.schema > SCHEMA => Err(Error::Storage(StorageError::NewerSchema {
            found: meta.schema,
            known: SCHEMA,
        })),
        Ok((_, meta)) => Ok(Some(meta.schema)),
        Err(_) => Ok(None),
    }
}

/// Loads and checks everything except descriptors, point clouds and document content.
///
/// # Errors
///
/// Only when the database cannot be read at all: damage is among the findings.
pub(crate) fn check_consistency(
    engine: &mut Database,
    mark: Option<&WatermarkRecord>,
) -> Result<ConsistencyReport, Error> {
    let mut reader = engine.reader()?;
    let mut found = ConsistencyReport::default();
    read_meta(&mut reader, &mut found)?;
    read_views(&mut reader, &mut found)?;
    let mut projection = HistoryProjection::default();
    read_history(&mut reader, &mut found, &mut projection)?;
    read_registers(&mut reader, &mut found, &projection)?;
    read_documents(&mut reader, &mut found)?;
    read_tombstones(&mut reader, &mut found)?;
    projection.check_chain(&mut found.findings);
    projection.compare(&found.index, &mut found.findings);
    found.index.lost = projection.lost().to_vec();
    found.n_history = projection.n_entries();
    check_counts(&mut found, &projection, mark);
    let (n_damages, damages) = engine.damages();
    found.findings.extend(n_damages, damages);
    Ok(found)
}

fn read_meta(reader: &mut Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
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

fn read_views(reader: &mut Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
    reader.scan_prefix(&[keys::VIEW], |key, record| {
        match (keys::view_of(key), unseal::<ViewMetadata>(key, record)) {
            (Some(view), Ok(metadata)) => {
                let register = LwwRegister::untouched(0);
                found.index.insert(view, &metadata, register);
            }
            (Some(view), Err(wrong)) => found
                .findings
                .add(|| format!("{}: {wrong}", view_phrase(view))),
            (None, _) => found
                .findings
                .add(|| format!("a view's key is none: {key:?}")),
        }
    })?;
    Ok(())
}

fn read_history(
    reader: &mut Reader,
    found: &mut ConsistencyReport,
    projection: &mut HistoryProjection,
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
                projection.apply(&entry, digest);
                found.last_wall_ns = entry.wall_ns;
                if let Some(id) = entry.mutation {
                    found.index.answered.insert(id, sequence);
                }
            }
            Err(wrong) => found
                .findings
                .add(|| format!("history entry {sequence}: {wrong}")),
        }
    })?;
    Ok(())
}

/// Loads the label registers, after the history, which dates views without one.
fn read_registers(
    reader: &mut Reader,
    found: &mut ConsistencyReport,
    projection: &HistoryProjection,
) -> Result<(), Error> {
    for (&view, projected) in &projection.views {
        let register = LwwRegister::untouched(projected.sequence);
        found.index.set(view, register);
    }
    reader.scan_prefix(&[keys::REGISTER], |key, record| {
        let register = unseal::<LwwRegister>(key, record);
        match (keys::view_of(key), register) {
            (Some(view), Ok(_)) if found.index.get(view).is_none() => found
                .findings
                .add(|| format!("{} is missing, though it has a standing", view_phrase(view))),
            (Some(view), Ok(register)) => check_register(found, projection, view, register),
            (Some(view), Err(wrong)) => found
                .findings
                .add(|| format!("the standing of {}: {wrong}", view_phrase(view))),
            (None, _) => found
                .findings
                .add(|| format!("a standing's key is none: {key:?}")),
        }
    })?;
    Ok(())
}

fn check_register(
    found: &mut ConsistencyReport,
    projection: &HistoryProjection,
    view: ViewId,
    register: LwwRegister,
) {
    let projected = projection.views.get(&view);
    if projected.is_some_and(|projected| projected.sequence != register.sequence) {
        found
            .findings
            .add(|| format!("the standing of {} is an older one", view_phrase(view)));
    }
    found.index.set(view, register);
}

fn read_documents(reader: &mut Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
    reader.scan_prefix(&[keys::DOCUMENT], |key, record| {
        let version = unseal::<DocumentVersion>(key, record);
        match (keys::document_of(key), version) {
            (Some((document, sequence)), Ok(version)) => {
                found.index.insert_version(&document, sequence, version);
            }
            (Some((document, sequence)), Err(wrong)) => found
                .findings
                .add(|| format!("{document}, as of entry {sequence}: {wrong}")),
            (None, _) => found
                .findings
                .add(|| format!("a document's key is none: {key:?}")),
        }
    })?;
    Ok(())
}

fn read_tombstones(reader: &mut Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
    reader.scan_prefix(&[keys::TOMBSTONE], |key, record| {
        match (keys::digest_of(key), unseal::<DecisionStamp>(key, record)) {
            (Some(identity), Ok(decided)) => {
                found.index.tombstones.insert(identity, decided);
            }
            (Some(identity), Err(wrong)) => found
                .findings
                .add(|| format!("the note of the forgotten view {identity}: {wrong}")),
            (None, _) => found
                .findings
                .add(|| format!("a forgotten view's key is none: {key:?}")),
        }
    })?;
    Ok(())
}

/// Compares counts and the track-id counter with the metadata record and the watermark.
fn check_counts(
    found: &mut ConsistencyReport,
    projection: &HistoryProjection,
    mark: Option<&WatermarkRecord>,
) {
    let n_views = found.index.n_all() as u64;
    let findings = &mut found.findings;
    let Some(meta) = &found.meta else {
        if found.n_history > 0 || n_views > 0 {
            findings.add(|| "the record about the store is missing".to_owned());
        }
        return;
    };
    let (sequence, head) = projection.head();
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
