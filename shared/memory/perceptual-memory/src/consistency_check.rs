//! Consistency check of an opening: loads the index and compares it with the digest of all records
//! in the metadata; reads the history behind the archived part, and checks its chain.
//!
//! [`crate::history_verification`] compares the records with the whole history.

use std::ops::ControlFlow;

use durable_leveldb::{
    Reader,
    record::{unseal, unseal_any},
};
use serde::de::DeserializeOwned;

use crate::archive::ArchiveRecord;
use crate::digest::Digest;
use crate::document::DocumentVersion;
use crate::error::{Error, StorageError};
use crate::findings::Findings;
use crate::history::HistoryEntry;
use crate::history_chain::HistoryChain;
use crate::index_loading::load_rows;
use crate::keys;
use crate::meta::{Meta, SCHEMA};
use crate::size_record::SizeRecord;
use crate::store_index::StoreIndex;
use crate::tombstone::unseal_tombstone;
use crate::track_id_counter;
use crate::watermark::WatermarkRecord;

/// Loaded index and detected inconsistencies.
#[derive(Debug, Default)]
pub(crate) struct ConsistencyReport {
    /// Metadata record; `None` for a database that was just created.
    pub(crate) meta: Option<Meta>,
    /// Extent of the archived history.
    pub(crate) archived: ArchiveRecord,
    pub(crate) sizes: SizeRecord,
    pub(crate) index: StoreIndex,
    /// Number of history entries in the database.
    pub(crate) n_recent: u64,
    /// Sequence number and digest of the last history entry.
    pub(crate) head: (u64, Digest),
    /// Time of the last history entry, nanoseconds since 1970, UTC.
    pub(crate) last_wall_ns: u64,
    /// Detected inconsistencies; empty for an intact database.
    pub(crate) findings: Findings,
}

impl ConsistencyReport {
    /// `true` if nothing was ever committed to the database.
    pub(crate) fn is_empty(&self) -> bool {
        self.meta.is_none()
            && self.n_recent == 0
            && self.archived.sequence == 0
            && self.index.n_all() == 0
            && self.findings.is_empty()
    }
}

/// Schema version of the database; `None` if it is unreadable.
///
/// # Errors
///
/// [`StorageError::NewerSchema`].
pub(crate) fn schema(reader: &Reader) -> Result<Option<u32>, Error> {
    let record = reader.get(&[keys::META])?;
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

/// Loads and checks everything except metadata of views, descriptors, point clouds, document
/// content and archived entries.
///
/// # Errors
///
/// Only when the database cannot be read at all: damage is among the findings.
pub(crate) fn check_consistency(
    reader: &Reader,
    mark: Option<&WatermarkRecord>,
) -> Result<ConsistencyReport, Error> {
    let mut found = ConsistencyReport::default();
    if let Some(meta) = read_single(reader, keys::META, &mut found.findings)? {
        found.meta = meta;
    }
    if let Some(archived) = read_single(reader, keys::ARCHIVE, &mut found.findings)? {
        found.archived = archived;
    }
    if let Some(sizes) = read_single(reader, keys::SIZES, &mut found.findings)? {
        found.sizes = sizes;
    }
    let (index, damaged_rows) = load_rows(reader)?;
    found.index = index;
    found.findings.merge(&damaged_rows);
    read_history(reader, &mut found)?;
    read_documents(reader, &mut found)?;
    read_tombstones(reader, &mut found)?;
    check_counts(&mut found, mark);
    let (n_damages, damages) = reader.damages();
    found.findings.extend(n_damages, damages);
    Ok(found)
}

/// Reads the record of a table with one record; `None` if it is missing or damaged.
fn read_single<T: DeserializeOwned>(
    reader: &Reader,
    table: u8,
    findings: &mut Findings,
) -> Result<Option<T>, Error> {
    let record = reader.get(&[table])?;
    Ok(match record.map(|record| unseal(&[table], &record)) {
        Some(Ok(value)) => Some(value),
        Some(Err(wrong)) => {
            findings.add(|| format!("{}: {wrong}", keys::in_words(&[table])));
            None
        }
        None => None,
    })
}

/// Reads the entries after the archived ones.
fn read_history(reader: &Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
    let archived = &found.archived;
    let mut chain = HistoryChain::after(archived.sequence, archived.head);
    found.index.add_lost(&archived.lost);
    let first = keys::history_key(archived.sequence + 1);
    reader.scan(&first, |key, record| {
        if !key.starts_with(&[keys::HISTORY]) {
            return ControlFlow::Break(());
        }
        let Some(sequence) = keys::sequence_of(key) else {
            found
                .findings
                .add(|| format!("a history entry's key is none: {key:?}"));
            return ControlFlow::Continue(());
        };
        match HistoryEntry::unseal(sequence, record) {
            Ok((entry, digest)) => {
                chain.add(&entry, digest);
                found.last_wall_ns = entry.wall_ns;
                found.n_recent += 1;
                if let Some(id) = entry.mutation {
                    found.index.answered.insert(id, sequence);
                }
            }
            Err(wrong) => found
                .findings
                .add(|| format!("history entry {sequence}: {wrong}")),
        }
        ControlFlow::Continue(())
    })?;
    found.index.add_lost(chain.newly_lost());
    chain.report(found.index.lost(), &mut found.findings);
    found.head = chain.head();
    Ok(())
}

fn read_documents(reader: &Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
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

fn read_tombstones(reader: &Reader, found: &mut ConsistencyReport) -> Result<(), Error> {
    reader.scan_prefix(&[keys::TOMBSTONE], |key, record| {
        match (keys::digest_of(key), unseal_tombstone(key, record)) {
            (Some(identity), Ok(forgotten_ns)) => found.index.bury(identity, forgotten_ns),
            (Some(_), Err(wrong)) => found
                .findings
                .add(|| format!("{}: {wrong}", keys::in_words(key))),
            (None, _) => found
                .findings
                .add(|| format!("a forgotten view's key is none: {key:?}")),
        }
    })?;
    Ok(())
}

/// Compares the records, counts and the track-id counter with the metadata record and the
/// watermark.
fn check_counts(found: &mut ConsistencyReport, mark: Option<&WatermarkRecord>) {
    let n_views = found.index.n_all() as u64;
    let findings = &mut found.findings;
    let Some(meta) = &found.meta else {
        if found.n_recent > 0 || found.archived.sequence > 0 || n_views > 0 {
            findings.add(|| "the record about the store is missing".to_owned());
        }
        return;
    };
    if (meta.sequence, meta.head) != found.head {
        let (sequence, last) = (found.head.0, meta.sequence);
        findings.add(|| format!("the history ends with entry {sequence}, not {last}"));
    }
    if meta.n_views != n_views {
        let n = meta.n_views;
        findings.add(|| format!("{n_views} of {n} index rows are whole"));
    } else if meta.records != found.index.records_digest() {
        findings.add(|| {
            "the records of views, documents and forgotten views do not match their digest"
                .to_owned()
        });
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
