//! Looking into the memory.

use crate::{revision, translate, words};
use message::control::{
    DocumentReport, HistoryReport, MemoryAnswer, MemoryQuery, MemoryStats, MutationId, Refusal,
    RefusalKind, ViewReport,
};
use std::collections::BTreeSet;
use store::{
    DocumentSummary, Effect, Error, HistoryEntry, PerceptualMemory, Stats, Target, ViewSummary,
};

/// Views of one page.
const PAGE_VIEWS: usize = 500;
/// Entries of one page.
const PAGE_ENTRIES: usize = 1000;

/// The answer, or a refusal; an error when the store fails.
pub(crate) fn answer(
    memory: &mut PerceptualMemory,
    query: MemoryQuery,
) -> Result<Result<MemoryAnswer, Refusal>, Error> {
    match query {
        MemoryQuery::Stats => Ok(Ok(MemoryAnswer::Stats(stats(&memory.stats()?)))),
        MemoryQuery::Views {
            category,
            track_id,
            after,
        } => {
            let target = match category.as_deref().map(translate::category).transpose() {
                Ok(name) => name.map(Target::Category).or(track_id.map(Target::Track)),
                Err(refusal) => return Ok(Err(refusal)),
            };
            let after = after.map(translate::local_id);
            let views = memory.views(target.as_ref(), after, PAGE_VIEWS)?;
            let is_full = views.len() == PAGE_VIEWS;
            let last = views.last().map(|summary| translate::view_id(summary.view));
            Ok(Ok(MemoryAnswer::Views {
                views: views.into_iter().map(view).collect(),
                next: last.filter(|_| is_full),
            }))
        }
        MemoryQuery::History { from, max } => {
            let max = (max as usize).clamp(1, PAGE_ENTRIES);
            let last_sequence = memory.sequence();
            let from = from.unwrap_or((last_sequence + 1).saturating_sub(max as u64));
            let entries = memory.history(from, max)?;
            Ok(Ok(MemoryAnswer::History {
                entries: entries.iter().map(entry).collect(),
                last_sequence,
            }))
        }
        MemoryQuery::Documents => {
            let documents = memory.documents();
            let reports = documents.iter().filter_map(document).collect();
            Ok(Ok(MemoryAnswer::Documents(reports)))
        }
        MemoryQuery::Document(name) => {
            let key = match revision::key(name) {
                Ok(key) => key,
                Err(refusal) => return Ok(Err(refusal)),
            };
            let document = memory.document(&key)?;
            Ok(Ok(MemoryAnswer::Document {
                media_type: document.media_type,
                content: document.content,
            }))
        }
        other => {
            let sentence = format!("this memory does not know the question {other:?}");
            Ok(Err(Refusal::new(RefusalKind::Invalid, sentence)))
        }
    }
}

fn stats(stats: &Stats) -> MemoryStats {
    MemoryStats {
        store_id: stats.store_id.0,
        memory_id: stats.memory_id,
        schema: stats.schema,
        sequence: stats.sequence,
        n_lost_entries: stats.n_lost_entries,
        n_named: stats.n_named,
        n_unnamed: stats.n_unnamed,
        n_forgotten: stats.n_forgotten,
        n_categories: stats.n_categories,
        n_documents: stats.n_documents,
        n_tombstones: stats.n_tombstones,
        content_bytes: stats.n_content_bytes,
        disk_bytes: stats.n_disk_bytes,
        next_track_id: stats.next_track_id,
    }
}

fn view(summary: ViewSummary) -> ViewReport {
    let pose = summary.box_in_world.frame_from_box;
    let decided = summary.decided.unwrap_or_default();
    ViewReport {
        id: translate::view_id(summary.view),
        category: summary.standing.category().map(ToString::to_string),
        author: decided.author.to_string(),
        decided_ns: decided.stamp_ns,
        sequence: summary.sequence,
        identity: summary.identity.0,
        origin_memory: summary.origin.memory_id,
        origin: translate::view_id(summary.origin.view),
        captured_ns: summary.captured_ns,
        frame_sequence: summary.frame_sequence,
        source: summary.source,
        descriptor_kind: summary.descriptor_kind,
        position_m: pose.translation.vector.into(),
        orientation_xyzw: pose.rotation.coords.into(),
        size_m: (2.0 * summary.box_in_world.half_sides_m).into(),
        mean_rgb: summary.mean_rgb,
        descriptor_bytes: summary.n_descriptor_bytes,
        cloud_bytes: summary.n_cloud_bytes,
    }
}

fn entry(entry: &HistoryEntry) -> HistoryReport {
    let views: BTreeSet<_> = entry.effects.iter().filter_map(Effect::view).collect();
    let contradiction = entry.contradiction.as_ref().map(|said| {
        let (present, author) = (&said.present, &said.decided.author);
        format!("it stays {present}, as {author} taught it")
    });
    HistoryReport {
        sequence: entry.sequence,
        wall_ns: entry.wall_ns,
        author: entry.author.to_string(),
        what: words::operation(&entry.operation),
        n_views: views.len() as u64,
        contradiction,
        mutation: entry.mutation.map(|id| MutationId(id.0)),
        previous: entry.previous.0,
    }
}

fn document(summary: &DocumentSummary) -> Option<DocumentReport> {
    Some(DocumentReport {
        document: revision::name(&summary.key)?,
        media_type: summary.content.media_type.clone(),
        bytes: u64::from(summary.content.n_bytes),
        author: summary.decided.author.to_string(),
        decided_ns: summary.decided.stamp_ns,
        sequence: summary.sequence,
    })
}
