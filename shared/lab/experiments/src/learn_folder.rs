//! `tabula-lab learn`: batch teaching from a folder of labelled views.

mod folder_describer;

use crate::arguments::{LearnArguments, UpAxis};
use crate::metric_views::MetricViews;
use crate::parallel;
use command_line::{Output, progress_bar};
use control_client::{ImportError, ImportRequest, MemoryClient, author_or_user, connect, import};
use dataset::object_views::{ObjectViews, ViewFile};
use description::{AppearanceDescriptor, AppearanceWeights};
use folder_describer::FolderDescriber;
use learning::CategoryName;
use perceptual_memory::{DecisionStamp, PortableWriter};
use serde::Serialize;
use service::{CommonArguments, Failure, wall_clock_ns};
use simulated_world::ModelUnit;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufWriter, Seek};
use std::ops::Range;
use std::path::Path;
use std::process::ExitCode;

/// Number of reasons in the failure of a folder without a usable view.
const N_REASONS: usize = 10;

/// Object of the folder; its views are imported as one track.
struct LabelledObject {
    category: CategoryName,
    /// Instance name within the category, if known.
    instance: Option<String>,
    /// Indices of the object's views in the folder.
    views: Range<usize>,
}

/// Report of the learned folder.
#[derive(Debug, Default, Serialize)]
struct LearnReport {
    n_categories: usize,
    n_objects: usize,
    n_views: usize,
    /// Number of views that are new or changed their label.
    n_views_changed: u64,
    /// Sequence number of the last history entry.
    sequence: u64,
    /// Remarks about units that were guessed, one sentence each.
    notes: Vec<String>,
    /// Reasons of omitted views, one sentence each.
    left_out: Vec<String>,
}

/// Describes the views of a folder and imports them into the daemon's memory.
///
/// # Errors
/// When the folder cannot be read or has no usable view, no daemon runs, or the memory refuses the
/// views.
pub fn run(
    common: &CommonArguments,
    arguments: &LearnArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let views = ObjectViews::open(&arguments.folder).map_err(Failure::usage)?;
    let up = arguments.up.and_then(UpAxis::direction);
    if up.is_none() && (arguments.up.is_some() || !views.is_up_known()) {
        return Err(up_unknown(&arguments.folder));
    }
    // Fails before the work if no daemon runs. The daemon closes connections that are idle for a
    // minute, so the import opens another one.
    drop(connect(common)?);
    let author = author_or_user(arguments.author.as_deref());
    let metric = metric_views(&views, arguments, output);
    let folder = FolderDescriber {
        views: &metric,
        files: views.files(),
        up,
        decided: DecisionStamp {
            author: author.as_str().into(),
            stamp_ns: wall_clock_ns().max(0) as u64,
        },
    };
    let mut report = LearnReport {
        notes: metric.notes().to_vec(),
        ..LearnReport::default()
    };
    let mut file = write(&folder, &mut report, output)?;
    let unusable = views.unusable().iter().map(ToString::to_string);
    report.left_out.extend(unusable);
    if report.n_views == 0 {
        return Err(nothing_usable(&arguments.folder, &report.left_out));
    }
    let request = ImportRequest {
        author,
        source: source(&arguments.folder),
        renames: Vec::new(),
        prefix: String::new(),
        is_new: arguments.is_new,
        restamp: false,
    };
    let mut memory = MemoryClient::of_daemon(common, connect(common)?);
    let imported = import(&mut memory, &mut file, request, output);
    let imported = imported.map_err(|error| match error {
        ImportError::RefusedFile(reason) => Failure::general(reason),
        ImportError::Failure(failure) => failure,
    })?;
    report.n_views_changed = imported.n_views_changed;
    report.sequence = imported.sequence;
    output.answer(&report, || text(&report));
    Ok(ExitCode::SUCCESS)
}

/// Views in the unit of the arguments, or in that of the folder, for which all are read.
fn metric_views<'a>(
    views: &'a ObjectViews,
    arguments: &LearnArguments,
    output: &Output,
) -> MetricViews<'a> {
    let bar = progress_bar(views.files().len() as u64, "sizes", output);
    let metric = MetricViews::new(views, arguments.unit.map(ModelUnit::from), &bar);
    bar.finish_and_clear();
    metric
}

fn nothing_usable(folder: &Path, reasons: &[String]) -> Failure {
    let first: Vec<&str> = reasons.iter().take(N_REASONS).map(String::as_str).collect();
    let more = match reasons.len().saturating_sub(N_REASONS) {
        0 => String::new(),
        n => format!("\nand {n} more reason(s)"),
    };
    Failure::general(format!(
        "nothing was learned from {}, which has no usable view:\n{}{more}",
        folder.display(),
        first.join("\n")
    ))
}

fn up_unknown(folder: &Path) -> Failure {
    Failure::usage(format!(
        "objects are described upright, but the views in {} do not tell what is up: say it by \
             --up, as in --up z",
        folder.display()
    ))
}

/// Name of the folder in the history: the last component of its path.
fn source(folder: &Path) -> String {
    let whole = folder.canonicalize();
    let folder = whole.as_deref().unwrap_or(folder);
    let name = folder.file_name().unwrap_or(folder.as_os_str());
    name.to_string_lossy().into_owned()
}

fn text(report: &LearnReport) -> String {
    let mut lines = [&report.notes[..], &report.left_out].concat();
    lines.push(format!(
        "learned {} view(s) of {} object(s) in {} categories: {} view(s) are new or changed, \
         history {}, on disk",
        report.n_views,
        report.n_objects,
        report.n_categories,
        report.n_views_changed,
        report.sequence
    ));
    lines.join("\n")
}

/// Writes the described views to an unnamed temporary file, since all of them may exceed the main
/// memory. Returns the file, rewound.
fn write(
    folder: &FolderDescriber<'_>,
    report: &mut LearnReport,
    output: &Output,
) -> Result<File, Failure> {
    let unwritable = |error: std::io::Error| {
        let place = std::env::temp_dir();
        Failure::general(format!(
            "the described views could not be written to {}: {error}; name a folder with more \
             room by the variable TMPDIR",
            place.display()
        ))
    };
    let appearance =
        AppearanceDescriptor::new(AppearanceWeights::default()).map_err(Failure::general)?;
    let mut file = tempfile::tempfile().map_err(unwritable)?;
    let mut writer = PortableWriter::new(BufWriter::new(&file)).map_err(unwritable)?;
    let bar = progress_bar(folder.files.len() as u64, "views", output);
    let mut categories = BTreeSet::new();
    for object in objects(folder.files, report) {
        let work = |appearance: &mut AppearanceDescriptor, place| {
            folder.describe(appearance, &object, object.views.start + place)
        };
        let results = parallel::map(object.views.len(), &bar, || appearance.clone(), work);
        let described = usable(results, report);
        for view in &described {
            writer.view(view).map_err(unwritable)?;
        }
        if !described.is_empty() {
            report.n_objects += 1;
            report.n_views += described.len();
            categories.insert(object.category);
        }
    }
    bar.finish_and_clear();
    writer.end().map_err(unwritable)?;
    report.n_categories = categories.len();
    file.rewind().map_err(unwritable)?;
    Ok(file)
}

/// Objects in the order of their views; where instances are not known, each category is one object.
/// Invalid categories are omitted with a reason.
fn objects(files: &[ViewFile], report: &mut LearnReport) -> Vec<LabelledObject> {
    let is_same =
        |a: &ViewFile, b: &ViewFile| (&a.category, &a.instance) == (&b.category, &b.instance);
    let mut objects = Vec::new();
    let mut start = 0;
    for of_object in files.chunk_by(is_same) {
        let views = start..start + of_object.len();
        start = views.end;
        let ViewFile {
            category: name,
            instance,
            ..
        } = &of_object[0];
        match CategoryName::new(name) {
            Ok(category) => objects.push(LabelledObject {
                category,
                instance: instance.clone(),
                views,
            }),
            Err(error) => {
                let n_views = views.len();
                let reason = format!("{n_views} view(s) of {name}: {error}");
                report.left_out.push(reason);
            }
        }
    }
    objects
}

/// Views that could be described; adds the reasons of the others to the report.
fn usable<T>(results: Vec<Result<T, String>>, report: &mut LearnReport) -> Vec<T> {
    let mut described = Vec::with_capacity(results.len());
    for result in results {
        match result {
            Ok(view) => described.push(view),
            Err(reason) => report.left_out.push(reason),
        }
    }
    described
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adjacent_views_of_an_instance_form_one_object() {
        let file = |category: &str, instance: Option<&str>| ViewFile {
            path: "view.pcd".into(),
            category: category.into(),
            instance: instance.map(ToOwned::to_owned),
            frame: None,
        };
        let files = [
            file("mug", Some("1")),
            file("mug", Some("1")),
            file("mug", Some("2")),
            file("m\u{7}g", None),
            file("pan", None),
            file("pan", None),
        ];
        let mut report = LearnReport::default();
        let objects = objects(&files, &mut report);
        let found: Vec<_> = objects
            .iter()
            .map(|object| (object.category.as_str(), object.views.clone()))
            .collect();
        assert_eq!(found, [("mug", 0..2), ("mug", 2..3), ("pan", 4..6)]);
        assert_eq!(report.left_out.len(), 1, "{report:?}");
    }
}
