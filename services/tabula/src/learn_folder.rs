//! `tabula learn`: what a folder of labelled views shows becomes known.

use crate::arguments::{LearnArguments, Up};
use crate::evaluate::parallel;
use crate::learn::{author_or_user, mutation_id};
use crate::objects::{call, connect, unexpected};
use crate::output::Output;
use crate::simulate::progress;
use channel::control::SocketClient;
use dataset::object_views::{ObjectView, ObjectViews, ViewFile};
use description::{Appearance, AppearanceWeights, ObjectPoints};
use learning::CategoryName;
use message::control::{Command, Labelling, Reply, StoredView, ViewId};
use nalgebra::UnitVector3;
use pipeline::DESCRIPTOR_KIND;
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code, wall_clock_ns};
use std::process::ExitCode;

/// Views in one request; with their descriptors far below the longest request.
const VIEWS_A_REQUEST: usize = 100;

/// A view of the folder, ready to be stored.
struct Described {
    descriptor: Vec<f32>,
    size_m: [f64; 3],
    source: String,
}

/// The views of one object, which are taught together as those of a track.
struct Object {
    category: CategoryName,
    views: Vec<Described>,
}

/// What was learned.
#[derive(Debug, Default, Serialize)]
struct Report {
    n_categories: usize,
    n_objects: usize,
    n_views: usize,
    /// History sequence of the last change.
    sequence: u64,
    /// What was not learned, one sentence each.
    left_out: Vec<String>,
}

/// Describes the folder's views, then stores and teaches them object by object.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &LearnArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let views = ObjectViews::open(&arguments.folder)
        .map_err(|error| Failure::new(exit_code::USAGE, error))?;
    let told = arguments.up.and_then(Up::direction);
    if told.is_none() && (arguments.up.is_some() || !views.tell_up()) {
        return Err(Failure::new(
            exit_code::USAGE,
            format!(
                "objects are described upright, but the views in {} do not tell what is up: say it \
                 by --up, as in --up z",
                arguments.folder.display()
            ),
        ));
    }
    let mut client = connect(common)?;
    let mut report = Report::default();
    let objects = described(&views, told.as_ref(), output, &mut report)?;
    let bar = progress::bar(objects.len() as u64, "objects", output);
    for object in &objects {
        teach(&mut client, arguments, object, &mut report)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    output.answer(&report, || text(&report));
    Ok(ExitCode::SUCCESS)
}

fn text(report: &Report) -> String {
    let mut lines = report.left_out.clone();
    lines.push(format!(
        "learned {} view(s) of {} object(s) in {} categories, history {}, on disk",
        report.n_views, report.n_objects, report.n_categories, report.sequence
    ));
    lines.join("\n")
}

/// Describes all views on all cores. What can not be used is left out with its reason.
fn described(
    views: &ObjectViews,
    up: Option<&UnitVector3<f64>>,
    output: &Output,
    report: &mut Report,
) -> Result<Vec<Object>, Failure> {
    let appearance = Appearance::new(AppearanceWeights::default()).map_err(failed)?;
    let n_views = views.files().len();
    let bar = progress::bar(n_views as u64, "views", output);
    let work = |appearance: &mut Appearance, index| describe(appearance, views, index, up);
    let results = parallel::map(n_views, &bar, || appearance.clone(), work)?;
    bar.finish_and_clear();
    let mut all: Vec<(&ViewFile, Described)> = Vec::new();
    for (file, result) in views.files().iter().zip(results) {
        match result {
            Ok(described) => all.push((file, described)),
            Err(reason) => report.left_out.push(reason),
        }
    }
    let left_out = views.unusable().iter().map(ToString::to_string);
    report.left_out.extend(left_out);
    Ok(objects(all, report))
}

fn describe(
    appearance: &mut Appearance,
    views: &ObjectViews,
    index: usize,
    up: Option<&UnitVector3<f64>>,
) -> Result<Described, String> {
    let view = views.load(index).map_err(|error| error.to_string())?;
    let source = views.files()[index].path.display().to_string();
    let readings = appearance
        .describe(ObjectPoints::all(&view.points), up.or(view.up.as_ref()))
        .map_err(|error| format!("the view {source} can not be described: {error}"))?;
    Ok(Described {
        descriptor: readings[0].clone(),
        size_m: extent_m(&view),
        source,
    })
}

/// Sides of the box along the axes of the file, metres.
fn extent_m(view: &ObjectView) -> [f64; 3] {
    let along = |axis: usize| {
        let places = view.points.iter().map(|point| point.position()[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        high - low
    };
    [0, 1, 2].map(along)
}

/// The views by object; where objects are not known, by category.
fn objects(views: Vec<(&ViewFile, Described)>, report: &mut Report) -> Vec<Object> {
    let mut views = views.into_iter().peekable();
    let mut objects: Vec<Object> = Vec::new();
    while let Some((first, view)) = views.next() {
        let is_same = |file: &ViewFile| {
            (&file.category, &file.instance) == (&first.category, &first.instance)
        };
        let mut of_object = vec![view];
        while let Some((_, view)) = views.next_if(|(file, _)| is_same(file)) {
            of_object.push(view);
        }
        match CategoryName::new(&first.category) {
            Ok(category) => objects.push(Object {
                category,
                views: of_object,
            }),
            Err(error) => report.left_out.push(format!(
                "{} view(s) of {}: {error}",
                of_object.len(),
                first.category
            )),
        }
    }
    let mut names: Vec<&CategoryName> = objects.iter().map(|object| &object.category).collect();
    names.sort_unstable();
    names.dedup();
    report.n_categories = names.len();
    objects
}

/// Stores an object's views under a new track-id and teaches that track.
fn teach(
    client: &mut SocketClient,
    arguments: &LearnArguments,
    object: &Object,
    report: &mut Report,
) -> Result<(), Failure> {
    let track_id = match call(client, Command::LeaseTrackIds { count: 1 })? {
        Reply::TrackIds { first } => first,
        other => return Err(unexpected(&other)),
    };
    let stored: Vec<StoredView> = (0..)
        .zip(&object.views)
        .map(|(view_id, view)| stored_view(ViewId { track_id, view_id }, view))
        .collect();
    for views in stored.chunks(VIEWS_A_REQUEST) {
        let command = Command::StoreViews {
            id: mutation_id()?,
            views: views.to_vec(),
        };
        match call(client, command)? {
            Reply::Stored => {}
            other => return Err(unexpected(&other)),
        }
    }
    let label = Labelling {
        id: mutation_id()?,
        author: author_or_user(arguments.author.as_deref()),
        track_id,
        category: object.category.as_str().to_owned(),
    };
    match call(client, Command::Teach(label))? {
        Reply::Learned(learned) => count(report, object, learned.sequence),
        other => return Err(unexpected(&other)),
    }
    Ok(())
}

fn count(report: &mut Report, object: &Object, sequence: u64) {
    report.n_objects += 1;
    report.n_views += object.views.len();
    report.sequence = sequence;
}

/// A view without a place in the world: it was never on this table.
fn stored_view(id: ViewId, view: &Described) -> StoredView {
    let bytes = view.descriptor.iter().flat_map(|value| value.to_le_bytes());
    StoredView {
        id,
        descriptor_kind: DESCRIPTOR_KIND.into(),
        descriptor: bytes.collect(),
        position_m: [0.0; 3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: view.size_m,
        captured_ns: wall_clock_ns(),
        frame_sequence: 0,
        source_name: view.source.clone(),
    }
}

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}
