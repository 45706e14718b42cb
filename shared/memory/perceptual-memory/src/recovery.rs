//! Recovery of the intact records of a damaged database, or of one with an older schema.

use durable_leveldb::{RawDatabase, record::unseal};

use crate::archive::HistoryArchive;
use crate::consistency_check::schema_of;
use crate::error::{Error, StorageError};
use crate::history::HistoryEntry;
use crate::index_row::IndexedView;
use crate::keys;
use crate::label_status::DecisionStamp;
use crate::meta::{Meta, SCHEMA};
use crate::recovered_records::{RecordedTotals, RecoveredRecords};
use crate::schema_1;
use crate::tombstone::unseal_tombstone;
use crate::view_record::ViewMetadata;
use crate::watermark::WatermarkRecord;

/// Reads all intact records; `None` if there are none.
///
/// # Errors
///
/// [`StorageError::NewerSchema`].
pub(crate) fn recover(
    raw: &RawDatabase,
    archive: &HistoryArchive,
    mark: Option<&WatermarkRecord>,
) -> Result<Option<RecoveredRecords>, Error> {
    let record = raw.get(&[keys::META]);
    let totals = record.as_deref().map_or(Ok(None), schema_of)?;
    let is_archived = archive.record.sequence > 0;
    let known = totals.or_else(|| schema_of_tables(raw));
    let Some(schema) = known.or_else(|| is_archived.then_some(SCHEMA)) else {
        return Ok(None);
    };
    if schema > SCHEMA {
        return Err(Error::Storage(StorageError::NewerSchema {
            found: schema,
            known: SCHEMA,
        }));
    }
    let mut recovered = RecoveredRecords::default();
    recovered.migrated_from = (schema < SCHEMA).then_some(schema);
    let counts = if schema > 1 {
        read_records(raw, &mut recovered);
        let meta = record.and_then(|record| unseal::<Meta>(&[keys::META], &record).ok());
        meta.map(|meta| RecordedTotals {
            memory_id: Some(meta.memory_id()),
            next_track_id: meta.next_track_id,
            sequence: meta.sequence,
            n_views: meta.n_views,
        })
    } else {
        schema_1::read_records(raw, &mut recovered)
    };
    recovered.read_history(archive);
    recovered.derive_totals(counts.as_ref(), mark)?;
    Ok(Some(recovered))
}

/// Schema version without a record that states it: the present one has index rows.
fn schema_of_tables(raw: &RawDatabase) -> Option<u32> {
    if raw.table(keys::ROW).next().is_some() {
        return Some(SCHEMA);
    }
    raw.version().map(u32::from)
}

/// Reads all intact records of the present schema, or of schema 2, which has label registers and
/// tombstones of another format instead of index rows and tombstones.
fn read_records(raw: &RawDatabase, recovered: &mut RecoveredRecords) {
    for (key, record) in raw.table(keys::HISTORY) {
        if let Some(sequence) = keys::sequence_of(key)
            && let Ok((entry, _)) = HistoryEntry::unseal(sequence, &record)
        {
            recovered.history.insert(sequence, entry);
        }
    }
    for (key, record) in raw.table(keys::VIEW) {
        if let Some(view) = keys::view_of(key)
            && let Ok(metadata) = unseal::<ViewMetadata>(key, &record)
            && raw.contains(&keys::digest_key(
                keys::DESCRIPTOR,
                metadata.descriptor.digest,
            ))
        {
            let identity = metadata.identity();
            recovered.views.insert(view, identity);
            recovered.metadata.insert(identity, metadata);
        }
    }
    for (key, record) in raw.table(keys::ROW) {
        if let (Some(view), Ok(row)) = (keys::view_of(key), IndexedView::unseal(key, &record)) {
            recovered.registers.insert(view, row.register);
        }
    }
    for (key, record) in raw.table(keys::REGISTER_2) {
        if let (Some(view), Ok(register)) = (keys::view_of(key), unseal(key, &record)) {
            recovered.registers.insert(view, register);
        }
    }
    for (key, record) in raw.table(keys::DOCUMENT) {
        if let (Some(version), Ok(content)) = (keys::document_of(key), unseal(key, &record)) {
            recovered.documents.insert(version, content);
        }
    }
    for (key, record) in raw.table(keys::TOMBSTONE) {
        let forgotten_ns = unseal_tombstone(key, &record);
        if let (Some(identity), Ok(forgotten_ns)) = (keys::digest_of(key), forgotten_ns) {
            recovered.tombstones.insert(identity, forgotten_ns);
        }
    }
    for (key, record) in raw.table(keys::TOMBSTONE_2) {
        let decided = unseal::<DecisionStamp>(key, &record);
        if let (Some(identity), Ok(decided)) = (keys::digest_of(key), decided) {
            recovered.tombstones.insert(identity, decided.stamp_ns);
        }
    }
}
