//! Read queries on the perceptual memory: statistics, views, history, documents.

use crate::document_pages::ContentCache;
use crate::job_context::wall_ns;
use crate::{document_pages, history_page, translate};
use control_protocol::{MemoryAnswer, MemoryQuery, MemoryStats, Refusal, ViewReport};
use perceptual_memory::{Error, PerceptualMemory, Stats, Target, ViewSummary};

/// Maximum number of views on a page.
const PAGE_VIEWS: usize = 500;

/// Answers a query or refuses it; an error is a failure of the store.
pub(crate) fn answer(
    memory: &mut PerceptualMemory,
    contents: &ContentCache,
    query: MemoryQuery,
) -> Result<Result<MemoryAnswer, Refusal>, Error> {
    match query {
        MemoryQuery::Stats => Ok(Ok(MemoryAnswer::Stats(stats(&memory.stats_at(wall_ns())?)))),
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
            let entries = history_page::page(memory, from, max)?;
            Ok(Ok(MemoryAnswer::History {
                entries,
                last_sequence: memory.sequence(),
            }))
        }
        MemoryQuery::Documents { after } => Ok(document_pages::list(memory, after)),
        MemoryQuery::DocumentVersions(name) => Ok(document_pages::versions(memory, name)),
        MemoryQuery::Document(request) => document_pages::page(memory, contents, request),
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
        n_archived_entries: stats.n_archived_entries,
        n_dropped_entries: stats.n_dropped_entries,
        archive_bytes: stats.n_archive_bytes,
        damaged_bytes: stats.n_damaged_bytes,
        bytes_in_a_year: stats.n_bytes_in_a_year,
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
