//! Readers of single records that must exist: history entries, content, views.

use std::ops::ControlFlow;

use durable_leveldb::{Reader, record::unseal};
use learning::ViewId;
use serde::de::DeserializeOwned;
use serde_bytes::ByteBuf;

use crate::error::Error;
use crate::history::HistoryEntry;
use crate::index_row::IndexedView;
use crate::keys;
use crate::view::StoredView;
use crate::view_record::{ViewMetadata, ViewParts};

/// Reads a database record that must exist.
pub(crate) fn read_record<T: DeserializeOwned>(reader: &Reader, key: &[u8]) -> Result<T, Error> {
    let record = reader.get(key)?;
    let value = record
        .ok_or("it is missing")
        .and_then(|record| unseal(key, &record));
    value.map_err(|wrong| keys::record_error(key, wrong))
}

/// Reads stored content that must exist.
pub(crate) fn read_content(reader: &Reader, key: &[u8]) -> Result<Vec<u8>, Error> {
    Ok(read_record::<ByteBuf>(reader, key)?.into_vec())
}

/// Reads a history entry that must exist.
pub(crate) fn read_entry(reader: &Reader, sequence: u64) -> Result<HistoryEntry, Error> {
    let key = keys::history_key(sequence);
    let record = reader.get(&key)?;
    let entry = record
        .ok_or("it is missing")
        .and_then(|record| HistoryEntry::unseal(sequence, &record));
    Ok(entry.map_err(|wrong| keys::record_error(&key, wrong))?.0)
}

/// Reads history entries that must exist, with one scan. The sequence numbers ascend.
pub(crate) fn read_entries(reader: &Reader, sequences: &[u64]) -> Result<Vec<HistoryEntry>, Error> {
    let Some(&first) = sequences.first() else {
        return Ok(Vec::new());
    };
    let mut wanted = sequences.iter().copied().peekable();
    let mut entries = Vec::with_capacity(sequences.len());
    let mut damage = None;
    reader.scan(&keys::history_key(first), |key, record| {
        let Some(sequence) = wanted.peek().copied() else {
            return ControlFlow::Break(());
        };
        let wanted_key = keys::history_key(sequence);
        if key > &wanted_key[..] {
            return ControlFlow::Break(());
        }
        if key == wanted_key {
            wanted.next();
            match HistoryEntry::unseal(sequence, record) {
                Ok((entry, _)) => entries.push(entry),
                Err(wrong) => {
                    damage = Some(keys::record_error(key, wrong));
                    return ControlFlow::Break(());
                }
            }
        }
        ControlFlow::Continue(())
    })?;
    let missing = wanted.next().map(keys::history_key);
    let missing = missing.map(|key| keys::record_error(&key, "it is missing"));
    damage.or(missing).map_or(Ok(entries), Err)
}

/// Reads all parts of a view that must exist.
pub(crate) fn read_parts(reader: &Reader, view: ViewId) -> Result<ViewParts, Error> {
    let metadata = read_record::<ViewMetadata>(reader, &keys::view_key(keys::VIEW, view))?;
    let key = keys::digest_key(keys::DESCRIPTOR, metadata.descriptor.digest);
    let descriptor = read_content(reader, &key)?;
    let points = match &metadata.points {
        Some(points) => Some(read_content(
            reader,
            &keys::digest_key(keys::BLOB, points.digest),
        )?),
        None => None,
    };
    Ok(ViewParts {
        metadata,
        descriptor,
        points,
    })
}

/// Reads a view; its label status comes from the index.
pub(crate) fn read_view(
    reader: &Reader,
    view: ViewId,
    entry: &IndexedView,
) -> Result<StoredView, Error> {
    let parts = read_parts(reader, view)?;
    let register = &entry.register;
    let is_decided = register.decided.stamp_ns > 0;
    Ok(StoredView {
        origin: parts.metadata.origin(),
        view: parts.into_view(view),
        standing: register.standing.clone(),
        decided: is_decided.then(|| register.decided.clone()),
        sequence: register.sequence,
    })
}
