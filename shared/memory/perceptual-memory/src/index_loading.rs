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

/// Keys and records, one after the other in one buffer.
#[derive(Default)]
struct RawBatch {
    bytes: Vec<u8>,
    /// Length of each key and of its record.
    lengths: Vec<(usize, usize)>,
}

impl RawBatch {
    fn push(&mut self, key: &[u8], record: &[u8]) {
        self.bytes.extend_from_slice(key);
        self.bytes.extend_from_slice(record);
        self.lengths.push((key.len(), record.len()));
    }

    /// Visits each key with its record.
    fn visit(&self, mut visit: impl FnMut(&[u8], &[u8])) {
        let mut rest = &self.bytes[..];
        for &(n_key_bytes, n_record_bytes) in &self.lengths {
            let (key, behind) = rest.split_at(n_key_bytes);
            let (record, behind) = behind.split_at(n_record_bytes);
            visit(key, record);
            rest = behind;
        }
    }
}

/// Row of a view with the digest of its record.
pub(crate) type DigestedRow = (ViewId, IndexedView, Digest);

/// Reads all index rows; damaged ones are findings.
///
/// # Errors
///
/// Only when the database cannot be read at all.
pub(crate) fn load_rows(reader: &Reader) -> Result<(StoreIndex, Findings), Error> {
    std::thread::scope(|scope| {
        let (sender, batches) = sync_channel(QUEUE_BATCHES);
        let builder = scope.spawn(move || build(&batches));
        let mut batch = RawBatch::default();
        let scanned = reader.scan(&[keys::ROW], |key, record| {
            if key.first() != Some(&keys::ROW) {
                return ControlFlow::Break(());
            }
            batch.push(key, record);
            if batch.lengths.len() < BATCH_RECORDS {
                return ControlFlow::Continue(());
            }
            match sender.send(std::mem::take(&mut batch)) {
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

fn build(batches: &Receiver<RawBatch>) -> (StoreIndex, Findings) {
    let mut findings = Findings::default();
    let mut rows = Vec::new();
    for batch in batches {
        batch.visit(
            |key, record| match (keys::view_of(key), IndexedView::unseal(key, record)) {
                (Some(view), Ok(row)) => rows.push((view, row, record_digest(key, record))),
                (Some(_), Err(wrong)) => {
                    findings.add(|| format!("{}: {wrong}", keys::in_words(key)));
                }
                (None, _) => findings.add(|| format!("an index row's key is none: {key:?}")),
            },
        );
    }
    (StoreIndex::of_rows(rows), findings)
}
