//! `tabula teach`, `correct`, `forget`, `rename`, `merge`, `undo`, `redo`, `categories`: changes of
//! labels and categories.

use crate::arguments::{ForgetArguments, LabelArguments};
use crate::track_or_name::{labelled_track, with_meant};
use command_line::{Output, format_table};
use control_client::{MemoryClient, TrackScope, ask, author_or_user, change, connect, mutation_id};
use control_protocol::{Labelling, LearningReport, Revision, RevisionChange, ViewId, request};
use scene_document::CategoryDocument;
use serde::Serialize;
use service::{CommonArguments, Failure};
use std::process::ExitCode;

/// Runs `tabula teach`.
pub(crate) fn teach(
    common: &CommonArguments,
    label: &LabelArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let track_id = labelled_track(common, "teach", label)?;
    let report = change(common, &request::teach(labelling(track_id, label)?))?;
    output.answer(&report, || learned_text(track_id, &report));
    Ok(ExitCode::SUCCESS)
}

/// Runs `tabula correct`.
pub(crate) fn correct(
    common: &CommonArguments,
    label: &LabelArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let track_id = labelled_track(common, "correct", label)?;
    let report = change(common, &request::correct(labelling(track_id, label)?))?;
    output.answer(&report, || learned_text(track_id, &report));
    Ok(ExitCode::SUCCESS)
}

/// Runs `tabula forget`.
pub(crate) fn forget(
    common: &CommonArguments,
    arguments: &ForgetArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let author = arguments.author.as_deref();
    let Some(category) = &arguments.category else {
        let track = arguments.track.as_ref();
        let track = track.map(|track| track.resolve(common, TrackScope::FORGET, author));
        let track_id = track.transpose()?.unwrap_or_default();
        let change = match arguments.view {
            Some(view_id) => RevisionChange::ForgetView {
                view: ViewId { track_id, view_id },
            },
            None => RevisionChange::ForgetTrack { track_id },
        };
        return revise(common, change, author, output);
    };
    let forget = request::forget(mutation_id()?, author_or_user(author), category.clone());
    let report = change(common, &forget)
        .map_err(|failure| with_meant(common, std::slice::from_ref(category), failure))?;
    output.answer(&report, || {
        format!(
            "forgot {}: {} view(s) are now unlabelled",
            report.category, report.n_views_changed
        )
    });
    Ok(ExitCode::SUCCESS)
}

/// `tabula rename`, `tabula merge`, and forgetting tracks and views; and `tabula undo` and `tabula
/// redo`, with or without a daemon.
pub(crate) fn revise(
    common: &CommonArguments,
    revision: RevisionChange,
    author: Option<&str>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let done = match &revision {
        RevisionChange::ForgetTrack { track_id } => format!("forgot track {track_id}"),
        RevisionChange::ForgetView { view } => {
            format!("forgot view {} of track {}", view.view_id, view.track_id)
        }
        RevisionChange::Rename { from, to, .. } => format!("{from} is now called {to}"),
        RevisionChange::Merge { from, into } => format!("{from} is merged into {into}"),
        RevisionChange::Redo => "redid".to_owned(),
        _ => "undid".to_owned(),
    };
    let names = match &revision {
        RevisionChange::Rename { from, .. } => vec![from.clone()],
        RevisionChange::Merge { from, into } => vec![from.clone(), into.clone()],
        _ => Vec::new(),
    };
    let is_reversal = matches!(revision, RevisionChange::Undo { .. } | RevisionChange::Redo);
    let request = request::revise(Revision {
        id: mutation_id()?,
        author: author_or_user(author),
        change: revision,
    });
    let report = if is_reversal {
        MemoryClient::open(common)?.change(&request)
    } else {
        change(common, &request)
    };
    let report = report.map_err(|failure| with_meant(common, &names, failure))?;
    output.answer(&report, || {
        let (n, sequence) = (report.n_views_changed, report.sequence);
        let done = if is_reversal {
            // The answer describes the change.
            format!("{done} \"{}\"", report.category)
        } else {
            done
        };
        format!("{done}: {n} view(s), history {sequence}, on disk")
    });
    Ok(ExitCode::SUCCESS)
}

#[derive(Serialize)]
struct CategoriesDocument {
    categories: Vec<CategoryDocument>,
}

/// Runs `tabula categories`.
pub(crate) fn categories(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let categories = ask(&mut connect(common)?, &request::categories())?;
    let document = CategoriesDocument { categories };
    output.answer(&document, || categories_text(&document.categories));
    Ok(ExitCode::SUCCESS)
}

fn categories_text(categories: &[CategoryDocument]) -> String {
    if categories.is_empty() {
        return "nothing has been taught yet; teach with: tabula teach TRACK NAME".into();
    }
    let row = |report: &CategoryDocument| {
        vec![
            report.category.clone(),
            report.n_views.to_string(),
            report.bytes.to_string(),
        ]
    };
    let rows: Vec<_> = categories.iter().map(row).collect();
    format_table(&["category", "views", "bytes"], &rows)
}

fn learned_text(track_id: u64, report: &LearningReport) -> String {
    let LearningReport {
        category,
        n_views_changed,
        sequence,
    } = report;
    match n_views_changed {
        0 => format!("track {track_id} already has the label {category}"),
        n => {
            format!("track {track_id} is {category} now: {n} view(s), history {sequence}, on disk")
        }
    }
}

fn labelling(track_id: u64, label: &LabelArguments) -> Result<Labelling, Failure> {
    Ok(Labelling {
        id: mutation_id()?,
        author: author_or_user(label.author.as_deref()),
        track_id,
        category: label.category.clone(),
        is_new: label.is_new,
    })
}
