//! History pages: reports of history entries with machine-readable fields.

use crate::{change_text, revision, translate};
use control_protocol::{HistoryOperation, HistoryReport, MAX_MESSAGE_BYTES, MutationId};
use perceptual_memory::{Effect, Error, HistoryEntry, Operation, PerceptualMemory, Target};
use std::collections::BTreeSet;

/// Maximum number of entries on a page.
const PAGE_ENTRIES: u32 = 1000;
/// Maximum estimated size of a page, bytes; the rest of the message needs room too.
const PAGE_BYTES: usize = MAX_MESSAGE_BYTES / 2;
/// Estimated size of an entry in CBOR without its strings, bytes: the field names alone
/// take 180.
const ENTRY_BYTES: usize = 400;

/// Page of at most `max` history entries, bounded by [`PAGE_ENTRIES`] and the message
/// size: from sequence number `from` on, or the last ones.
pub(crate) fn page(
    memory: &mut PerceptualMemory,
    from: Option<u64>,
    max: u32,
) -> Result<Vec<HistoryReport>, Error> {
    let max = max.clamp(1, PAGE_ENTRIES) as usize;
    let first = from.unwrap_or((memory.sequence() + 1).saturating_sub(max as u64));
    let mut entries: Vec<_> = memory.history(first, max)?.iter().map(report).collect();
    let mut n_bytes = 0;
    let mut fits = |entry: &HistoryReport| {
        n_bytes += estimated_bytes(entry);
        n_bytes <= PAGE_BYTES
    };
    if from.is_some() {
        let n_fitting = entries.iter().take_while(|entry| fits(entry)).count();
        entries.truncate(n_fitting.max(1));
    } else {
        let n_fitting = entries.iter().rev().take_while(|entry| fits(entry)).count();
        let n_dropped = entries.len().saturating_sub(n_fitting.max(1));
        entries.drain(..n_dropped);
    }
    Ok(entries)
}

fn estimated_bytes(entry: &HistoryReport) -> usize {
    let optional = [
        &entry.category,
        &entry.from,
        &entry.to,
        &entry.source,
        &entry.contradiction,
        &entry.kept_category,
        &entry.kept_author,
    ];
    let strings = optional.into_iter().flatten().map(String::len);
    let document = entry.document.as_ref().map_or(0, |name| name.name.len());
    ENTRY_BYTES + entry.author.len() + entry.what.len() + document + strings.sum::<usize>()
}

fn report(entry: &HistoryEntry) -> HistoryReport {
    let views: BTreeSet<_> = entry.effects.iter().filter_map(Effect::view).collect();
    let contradiction = entry.contradiction.as_ref();
    let sentence = contradiction.map(|said| {
        let (present, author) = (&said.present, &said.decided.author);
        format!("it stays {present}, as {author} taught it")
    });
    let empty = HistoryReport {
        sequence: entry.sequence,
        wall_ns: entry.wall_ns,
        author: entry.author.to_string(),
        uid: entry.uid,
        what: change_text::describe_operation(&entry.operation),
        operation: HistoryOperation::Other,
        track_id: None,
        view: None,
        category: None,
        from: None,
        to: None,
        undone: None,
        redone: None,
        document: None,
        source: None,
        n_views: views.len() as u64,
        contradiction: sentence,
        kept_category: contradiction.map(|said| said.present.to_string()),
        kept_author: contradiction.map(|said| said.decided.author.to_string()),
        mutation: entry.mutation.map(|id| MutationId(id.0)),
        previous: entry.previous.0,
    };
    with_operation(empty, &entry.operation)
}

/// Report with the fields of the operation.
fn with_operation(mut report: HistoryReport, operation: &Operation) -> HistoryReport {
    report.operation = match operation {
        Operation::StoreViews => HistoryOperation::StoreViews,
        Operation::Teach { track_id, category } => {
            report.track_id = Some(*track_id);
            report.category = Some(category.to_string());
            HistoryOperation::Teach
        }
        Operation::Correct { target, category } => {
            set_target(&mut report, target);
            report.from = report.category.take();
            report.category = Some(category.to_string());
            report.to = Some(category.to_string());
            HistoryOperation::Correct
        }
        Operation::Forget { target } => {
            set_target(&mut report, target);
            HistoryOperation::Forget
        }
        Operation::Rename { from, to } => {
            report.from = Some(from.to_string());
            report.to = Some(to.to_string());
            HistoryOperation::Rename
        }
        Operation::MergeCategories { from, into } => {
            report.from = Some(from.to_string());
            report.to = Some(into.to_string());
            HistoryOperation::Merge
        }
        Operation::NormaliseNames { .. } => HistoryOperation::Merge,
        Operation::Undo { sequence, redone } => {
            report.undone = Some(*sequence);
            report.redone = *redone;
            HistoryOperation::Undo
        }
        Operation::Import { source, .. } => {
            report.source = Some(source.clone());
            HistoryOperation::Import
        }
        Operation::PutDocument { document } => {
            report.document = revision::name(document);
            HistoryOperation::PutDocument
        }
        Operation::RemoveDocument { document } => {
            report.document = revision::name(document);
            HistoryOperation::RemoveDocument
        }
        Operation::Purge => HistoryOperation::Purge,
        Operation::EnforceLimit { category } => {
            report.category = category.as_ref().map(ToString::to_string);
            HistoryOperation::Prune
        }
        Operation::Rebuild { .. } => HistoryOperation::Rebuild,
        Operation::Migrate { .. } => HistoryOperation::Migrate,
        _ => HistoryOperation::Other,
    };
    report
}

fn set_target(report: &mut HistoryReport, target: &Target) {
    match target {
        Target::View(view) => report.view = Some(translate::view_id(*view)),
        Target::Track(track_id) => report.track_id = Some(*track_id),
        Target::Category(name) => report.category = Some(name.to_string()),
    }
}

#[cfg(test)]
mod tests;
