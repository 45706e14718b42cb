//! Loading of the index rows: the engine is read in one thread, and the index is built in another
//! one meanwhile.

use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, sync_channel};

use durable_leveldb::Reader;
use learning::ViewId;

use crate::digest::Digest;
use crate::error::Error;
use crate::findings::Findings;
use crate::index_row::IndexedView;
use crate::keys;
use crate::set_digest::record_digest;
use crate::store_index::StoreIndex;

/// Number of records that are passed on at once.
const BATCH_RECORDS: usize = 512;
/// Number of batches that may wait for the builder of the index.
const QUEUE_BATCHES: usize = 64;

/// Key and record.
type RawRecord = (Box<[u8]>, Box<[u8]>);

/// Row of a view with the digest of its record.
pub(crate) type DigestedRow = (ViewId, IndexedView, Digest);

/// Reads all index rows; damaged ones are findings.
///
/// # Errors
///
/// Only when the database cannot be read at all.
pub(crate) fn load_rows(reader: &mut Reader) -> Result<(StoreIndex, Findings), Error> {
    std::thread::scope(|scope| {
        let (sender, batches) = sync_channel(QUEUE_BATCHES);
        let builder = scope.spawn(move || build(&batches));
        let mut batch = Vec::with_capacity(BATCH_RECORDS);
        let scanned = reader.scan(&[keys::ROW], |key, record| {
            if key.first() != Some(&keys::ROW) {
                return ControlFlow::Break(());
            }
            batch.push((key.into(), record.into()));
            if batch.len() < BATCH_RECORDS {
                return ControlFlow::Continue(());
            }
            let full = std::mem::replace(&mut batch, Vec::with_capacity(BATCH_RECORDS));
            match sender.send(full) {
                Ok(()) => ControlFlow::Continue(()),
                // A panic of the builder is passed on below.
                Err(_) => ControlFlow::Break(()),
            }
        });
        // Fails only after a panic of the builder.
        let _ = sender.send(batch);
        drop(sender);
        let built = builder.join();
        scanned?;
        Ok(built.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

fn build(batches: &Receiver<Vec<RawRecord>>) -> (StoreIndex, Findings) {
    let mut findings = Findings::default();
    let mut rows = Vec::new();
    for (key, record) in batches.iter().flatten() {
        match (keys::view_of(&key), IndexedView::unseal(&key, &record)) {
            (Some(view), Ok(row)) => rows.push((view, row, record_digest(&key, &record))),
            (Some(_), Err(wrong)) => {
                findings.add(|| format!("{}: {wrong}", keys::in_words(&key)));
            }
            (None, _) => findings.add(|| format!("an index row's key is none: {key:?}")),
        }
    }
    (StoreIndex::of_rows(rows), findings)
}
