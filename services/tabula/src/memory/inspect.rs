//! `tabula memory stats`, `inspect` and `history`.

use crate::arguments::{EntriesArguments, InspectArguments};
use crate::time::utc;
use command_line::{Output, format_table};
use control_client::{MemoryClient, TrackReference, TrackScope};
use control_protocol::{HistoryReport, MemoryStats, ViewReport, request};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;

/// Runs `tabula memory stats`.
pub(super) fn stats(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let mut memory = MemoryClient::open(common)?;
    let stats = memory.ask(&request::stats())?;
    output.answer(&stats, || stats_text(&stats));
    Ok(ExitCode::SUCCESS)
}

fn stats_text(stats: &MemoryStats) -> String {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        row("named views", stats.n_named.to_string()),
        row("categories", stats.n_categories.to_string()),
        row("views without a name", stats.n_unnamed.to_string()),
        row("forgotten views", stats.n_forgotten.to_string()),
        row("documents", stats.n_documents.to_string()),
        row("bytes of content", stats.content_bytes.to_string()),
        row("bytes on disk", stats.disk_bytes.to_string()),
        row("bytes of archived history", stats.archive_bytes.to_string()),
        row("bytes of damaged copies", stats.damaged_bytes.to_string()),
        row(
            "bytes on disk in a year",
            match stats.bytes_in_a_year {
                Some(bytes) => format!("{bytes} by the growth so far"),
                None => "known after a day".to_owned(),
            },
        ),
        row("history entries", stats.sequence.to_string()),
        row("of them archived", stats.n_archived_entries.to_string()),
        row("next track", stats.next_track_id.to_string()),
        row("schema", stats.schema.to_string()),
        row("memory", format!("{:032x}", stats.memory_id)),
        row("store", format!("{:032x}", stats.store_id)),
    ];
    if stats.n_lost_entries > 0 {
        rows.push(row("lost entries", stats.n_lost_entries.to_string()));
    }
    if stats.n_dropped_entries > 0 {
        let n_dropped = stats.n_dropped_entries.to_string();
        rows.push(row("dropped entries", n_dropped));
    }
    format_table(&["what", "how much"], &rows)
}

#[derive(Serialize)]
struct ViewsDocument {
    views: Vec<ViewReport>,
}

/// Runs `tabula memory inspect`.
pub(super) fn views(
    common: &CommonArguments,
    arguments: &InspectArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let track = arguments.track.as_ref();
    let track_id = track
        .map(|track| recalled_track(common, track))
        .transpose()?;
    let mut memory = MemoryClient::open(common)?;
    let mut all = Vec::new();
    let mut after = None;
    loop {
        let category = arguments.category.clone();
        let (views, next) = memory.ask(&request::views(category, track_id, after))?;
        all.extend(views);
        after = next;
        if after.is_none() {
            break;
        }
    }
    let document = ViewsDocument { views: all };
    output.answer(&document, || views_text(&document.views));
    Ok(ExitCode::SUCCESS)
}

/// Track-id of an object that may be gone.
fn recalled_track(common: &CommonArguments, track: &TrackReference) -> Result<u64, Failure> {
    let resolved = track.resolve(common, TrackScope::RECALL, None);
    resolved.map_err(|failure| match failure.code {
        exit_code::NO_DAEMON => Failure::new(
            failure.code,
            format!("{failure}; without a daemon, give a track-id in place of the words"),
        ),
        _ => failure,
    })
}

fn views_text(views: &[ViewReport]) -> String {
    if views.is_empty() {
        return "no such view is stored; see all of them with: tabula memory inspect".to_owned();
    }
    let row = |view: &ViewReport| {
        let [x, y, z] = view.size_m.map(|side| format!("{:.0}", 1e3 * side));
        let name = view.category.clone();
        vec![
            format!("{}/{}", view.id.track_id, view.id.view_id),
            name.unwrap_or_else(|| "-".to_owned()),
            if view.decided_ns == 0 {
                "-".to_owned()
            } else {
                view.author.clone()
            },
            utc(view.decided_ns),
            utc(view.captured_ns),
            format!("{} frame {}", view.source, view.frame_sequence),
            format!("{x} x {y} x {z}"),
            (view.descriptor_bytes + view.cloud_bytes).to_string(),
        ]
    };
    let heading = [
        "track/view",
        "category",
        "by",
        "taught",
        "captured",
        "source",
        "size mm",
        "bytes",
    ];
    format_table(&heading, &views.iter().map(row).collect::<Vec<_>>())
}

#[derive(Serialize)]
struct HistoryDocument {
    entries: Vec<HistoryReport>,
    last_sequence: u64,
}

/// Runs `tabula memory history`.
pub(super) fn history(
    common: &CommonArguments,
    arguments: &EntriesArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut memory = MemoryClient::open(common)?;
    let (entries, last_sequence) = memory.history(arguments.from, arguments.count.into())?;
    let document = HistoryDocument {
        entries,
        last_sequence,
    };
    output.answer(&document, || history_text(&document.entries));
    Ok(ExitCode::SUCCESS)
}

fn history_text(entries: &[HistoryReport]) -> String {
    if entries.is_empty() {
        return "there are no such entries; see the last ones with: tabula memory history"
            .to_owned();
    }
    let row = |entry: &HistoryReport| {
        let what = match &entry.contradiction {
            Some(why) => format!("{}: {why}", entry.what),
            None => entry.what.clone(),
        };
        vec![
            entry.sequence.to_string(),
            utc(entry.wall_ns),
            entry.author.clone(),
            entry.uid.map_or("-".to_owned(), |uid| uid.to_string()),
            what,
            entry.n_views.to_string(),
        ]
    };
    let heading = ["entry", "when", "by", "uid", "what", "views"];
    format_table(&heading, &entries.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_lists_say_which_command_shows_all() {
        assert!(views_text(&[]).ends_with("with: tabula memory inspect"));
        assert!(history_text(&[]).ends_with("with: tabula memory history"));
    }
}
