//! Copies what is whole in a damaged database into a new one, and counts the rest.
//!
//! A view is kept when its facts and its descriptor are whole; its cloud is kept
//! when that is whole too. Its name is what the newest whole record says, its
//! label or an entry of the history: both carry the sequence. The history keeps
//! its order and is numbered anew without gaps; the answers to mutations whose
//! entry is lost go with it, so that such a mutation can be made again.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::ControlFlow;

use learning::{CategoryName, ViewId};

use crate::engine::Engine;
use crate::error::Error;
use crate::examination::category_of;
use crate::history::{HistoryEntry, Operation, PackedEntry};
use crate::keys;
use crate::meta::Meta;
use crate::mutation::{Answer, MutationId};
use crate::perceptual_memory::put_label;
use crate::record::{payload, unseal};
use crate::view::{Facts, PackedLabel};
use crate::watermark::Mark;
use crate::writes::Writes;

/// Bytes gathered before they are written to the copy.
const WRITE_BYTES: usize = 1 << 20;

/// What a rebuilt store no longer has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Loss {
    /// Acknowledged changes that are not in the history any more.
    pub n_history: u64,
    /// Views of which facts or descriptor are gone.
    pub n_views: u64,
    /// Views that are there without their cloud.
    pub n_clouds: u64,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            n_history,
            n_views,
            n_clouds,
        } = self;
        write!(
            f,
            "{n_history} history entries, {n_views} views, {n_clouds} clouds"
        )
    }
}

/// The whole records of a damaged database, without descriptors and clouds.
#[derive(Default)]
struct Found {
    facts: BTreeMap<ViewId, Facts>,
    descriptors: BTreeSet<ViewId>,
    clouds: BTreeSet<ViewId>,
    labels: BTreeMap<ViewId, PackedLabel>,
    history: BTreeMap<u64, HistoryEntry>,
    answers: BTreeMap<MutationId, Answer>,
    /// Views of which any record was met, whole or not.
    met: BTreeSet<ViewId>,
    last_sequence_met: u64,
}

/// Copies everything whole from `damaged` to the empty `copy`, which is on disk
/// afterwards.
///
/// # Errors
///
/// [`Error::Damaged`] when not even the whole records can be walked through;
/// [`Error::Io`] when the copy cannot be written.
pub(crate) fn salvage(
    damaged: &mut Engine,
    copy: &mut Engine,
    meta: Option<&Meta>,
    mark: Option<&Mark>,
    wall_ns: u64,
) -> Result<Loss, Error> {
    let mut found = find(damaged)?;
    let loss = forget_incomplete(&mut found, meta, mark);
    let next_track_id = meta.map_or(1, |meta| meta.next_track_id);
    let mut new_meta = Meta::new(next_track_id.max(mark.map_or(1, |mark| mark.next_track_id)))?;
    new_meta.n_views = found.facts.len() as u64;
    copy_large_parts(damaged, copy, &found)?;
    let mut writes = Writes::default();
    for (&view, facts) in &found.facts {
        writes.put(&keys::view_key(keys::VIEW, view), facts);
        flush_if_large(&mut writes, copy)?;
    }
    let new_sequence = copy_history(copy, &mut writes, &found.history)?;
    copy_labels(copy, &mut writes, &found, &new_sequence)?;
    copy_answers(copy, &mut writes, &found, &new_sequence)?;
    new_meta.sequence = found.history.len() as u64 + 1;
    let entry = rebuild_entry(new_meta.sequence, wall_ns, loss);
    writes.put(&keys::history_key(entry.sequence), &PackedEntry::of(&entry));
    writes.commit(copy, &new_meta)?;
    Ok(loss)
}

/// Walks through all records; one that is not whole is passed by.
fn find(damaged: &mut Engine) -> Result<Found, Error> {
    let mut found = Found::default();
    damaged.reader()?.scan(&[], |key, record| {
        note(&mut found, key, record);
        ControlFlow::Continue(())
    })?;
    Ok(found)
}

fn note(found: &mut Found, key: &[u8], record: &[u8]) -> Option<()> {
    match *key.first()? {
        table @ (keys::VIEW | keys::DESCRIPTOR | keys::POINTS | keys::LABEL) => {
            let view = keys::view_of(key)?;
            found.met.insert(view);
            match table {
                keys::VIEW => {
                    found.facts.insert(view, unseal(key, record).ok()?);
                }
                keys::LABEL => {
                    found.labels.insert(view, unseal(key, record).ok()?);
                }
                keys::DESCRIPTOR => {
                    payload(key, record).ok()?;
                    found.descriptors.insert(view);
                }
                _ => {
                    payload(key, record).ok()?;
                    found.clouds.insert(view);
                }
            }
        }
        keys::HISTORY => {
            let sequence = keys::sequence_of(key)?;
            found.last_sequence_met = found.last_sequence_met.max(sequence);
            let entry = unseal::<PackedEntry>(key, record).ok()?.unpack(sequence)?;
            found.met.extend(&entry.stored);
            found.history.insert(sequence, entry);
        }
        keys::ANSWER => {
            found
                .answers
                .insert(keys::mutation_of(key)?, unseal(key, record).ok()?);
        }
        // The category index is made again from the labels.
        _ => {}
    }
    Some(())
}

/// Leaves only views that are whole, and counts what is gone.
fn forget_incomplete(found: &mut Found, meta: Option<&Meta>, mark: Option<&Mark>) -> Loss {
    let Found {
        facts,
        descriptors,
        clouds,
        ..
    } = found;
    facts.retain(|view, _| descriptors.contains(view));
    let mut n_clouds = 0;
    for (view, facts) in facts.iter_mut() {
        if facts.points.is_some() && !clouds.contains(view) {
            facts.points = None;
            n_clouds += 1;
        }
    }
    let n_facts = facts.len() as u64;
    let n_views = meta
        .map_or(0, |meta| meta.n_views)
        .max(found.met.len() as u64)
        - n_facts;
    let mark = mark.filter(|mark| meta.is_none_or(|meta| meta.store_id().0 == mark.store_id));
    let last = meta
        .map_or(0, |meta| meta.sequence)
        .max(found.last_sequence_met);
    let last = last.max(mark.map_or(0, |mark| mark.sequence));
    Loss {
        n_history: last - found.history.len() as u64,
        n_views,
        n_clouds,
    }
}

/// Copies descriptors and clouds as they are: the keys do not change.
fn copy_large_parts(damaged: &mut Engine, copy: &mut Engine, found: &Found) -> Result<(), Error> {
    let mut writes = Writes::default();
    let mut written = Ok(());
    damaged.reader()?.scan(&[], |key, record| {
        let is_large = matches!(key.first(), Some(&keys::DESCRIPTOR | &keys::POINTS));
        let facts = keys::view_of(key).and_then(|view| found.facts.get(&view));
        let is_kept =
            facts.is_some_and(|facts| key[0] == keys::DESCRIPTOR || facts.points.is_some());
        if is_large && is_kept {
            writes.put_sealed(key, record);
            written = flush_if_large(&mut writes, copy);
        }
        if written.is_ok() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    })?;
    written?;
    writes.flush(copy)
}

/// Copies the history without gaps; returns each old sequence with its new one.
fn copy_history(
    copy: &mut Engine,
    writes: &mut Writes,
    history: &BTreeMap<u64, HistoryEntry>,
) -> Result<BTreeMap<u64, u64>, Error> {
    let mut new_sequence = BTreeMap::new();
    for (new, (&old, entry)) in (1..).zip(history) {
        new_sequence.insert(old, new);
        writes.put(&keys::history_key(new), &PackedEntry::of(entry));
        flush_if_large(writes, copy)?;
    }
    Ok(new_sequence)
}

/// The new sequence of the last entry kept up to an old one.
fn renumbered(new_sequence: &BTreeMap<u64, u64>, old: u64) -> u64 {
    new_sequence
        .range(..=old)
        .next_back()
        .map_or(0, |(_, new)| *new)
}

fn copy_labels(
    copy: &mut Engine,
    writes: &mut Writes,
    found: &Found,
    new_sequence: &BTreeMap<u64, u64>,
) -> Result<(), Error> {
    for (view, (mut label, category)) in newest_labels(found) {
        label.sequence = renumbered(new_sequence, label.sequence);
        put_label(writes, view, &label, category.as_ref());
        flush_if_large(writes, copy)?;
    }
    Ok(())
}

/// What each kept view is called, by the newer of its label and the history.
fn newest_labels(found: &Found) -> BTreeMap<ViewId, (PackedLabel, Option<CategoryName>)> {
    let mut labels = BTreeMap::new();
    for (&view, label) in &found.labels {
        if let Ok(category) = category_of(label) {
            labels.insert(view, (label.clone(), category));
        }
    }
    for (&sequence, entry) in &found.history {
        for change in &entry.changes {
            let known = labels
                .get(&change.id)
                .map_or(0, |(label, _)| label.sequence);
            if sequence > known {
                let label = PackedLabel::given_by(entry, change);
                labels.insert(change.id, (label, change.after.clone()));
            }
        }
    }
    labels.retain(|view, _| found.facts.contains_key(view));
    labels
}

fn copy_answers(
    copy: &mut Engine,
    writes: &mut Writes,
    found: &Found,
    new_sequence: &BTreeMap<u64, u64>,
) -> Result<(), Error> {
    for (&id, answer) in &found.answers {
        let entry = found.history.get(&answer.sequence);
        let is_kept = answer.n_views == 0 || entry.is_some_and(|entry| entry.mutation == Some(id));
        if is_kept {
            let sequence = renumbered(new_sequence, answer.sequence);
            writes.put(
                &keys::answer_key(id),
                &Answer {
                    sequence,
                    ..*answer
                },
            );
            flush_if_large(writes, copy)?;
        }
    }
    Ok(())
}

/// So that the loss is told for as long as the history is kept.
fn rebuild_entry(sequence: u64, wall_ns: u64, loss: Loss) -> HistoryEntry {
    HistoryEntry {
        sequence,
        wall_ns,
        author: format!("the store itself, having lost {loss}"),
        operation: Operation::Rebuild,
        mutation: None,
        stored: Vec::new(),
        changes: Vec::new(),
    }
}

fn flush_if_large(writes: &mut Writes, copy: &mut Engine) -> Result<(), Error> {
    if writes.n_bytes() < WRITE_BYTES {
        return Ok(());
    }
    std::mem::take(writes).flush(copy)
}
