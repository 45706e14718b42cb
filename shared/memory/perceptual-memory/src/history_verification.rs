//! Verification of the whole history, archived or not: its chain, and the records that it implies.

use durable_leveldb::Reader;

use crate::archive::HistoryArchive;
use crate::error::Error;
use crate::findings::Findings;
use crate::history::HistoryEntry;
use crate::history_chain::HistoryChain;
use crate::history_projection::HistoryProjection;
use crate::keys;
use crate::store_index::StoreIndex;

/// Reads all entries, reports what is wrong with them, and compares the records with them; returns
/// the number of entries. After a part of the history was dropped the records cannot be derived
/// from the rest, and only the chain is checked.
///
/// # Errors
///
/// Only when the database cannot be read at all: damage is among the findings.
pub(crate) fn verify_history(
    archive: &HistoryArchive,
    reader: &Reader,
    index: &StoreIndex,
    findings: &mut Findings,
) -> Result<u64, Error> {
    let mut projection = HistoryProjection::default();
    let mut chain = begin_chain(archive);
    let mut is_complete = archive.record.dropped == 0;
    archive.visit(
        |entry, digest| {
            chain.add(&entry, digest);
            projection.apply(&entry);
        },
        |sentence, lost| {
            // A repair notes the entries as lost, and the rest of the records says what they did.
            if !lost.iter().all(|sequence| index.is_lost(*sequence)) {
                is_complete = false;
                findings.add(|| sentence);
            }
        },
    );
    reader.scan_prefix(&[keys::HISTORY], |key, record| {
        let Some(sequence) = keys::sequence_of(key) else {
            return;
        };
        // A damaged entry was found when the checkpoint was opened.
        if let Ok((entry, digest)) = HistoryEntry::unseal(sequence, record) {
            chain.add(&entry, digest);
            projection.apply(&entry);
        }
    })?;
    chain.report(index.lost(), findings);
    if is_complete {
        projection.compare(index, findings);
    }
    Ok(chain.n_entries())
}

/// Chain that begins with the first entry that was not dropped.
fn begin_chain(archive: &HistoryArchive) -> HistoryChain {
    let dropped = archive.record.dropped;
    let first = archive.extents().into_iter().next();
    let segment = first.and_then(|(first, last)| archive.open_segment(first, last).ok());
    match segment {
        Some(segment) if dropped > 0 => HistoryChain::after(dropped, segment.before()),
        _ => HistoryChain::default(),
    }
}
