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
use geometry::RigidTransform;
use learning::CategoryName;
use message::control::{Command, Labelling, Reply, StoredView, ViewId, pack_cloud};
use nalgebra::UnitVector3;
use pipeline::DESCRIPTOR_KIND;
use point_cloud::{Point, Rgba};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code, wall_clock_ns};
use std::collections::BTreeSet;
use std::ops::Range;
use std::process::ExitCode;

/// A view of the folder, ready to be stored.
struct Described {
    descriptor: Vec<f32>,
    size_m: [f64; 3],
    source: String,
    packed_cloud: Vec<u8>,
    mean_rgb: Option<[u8; 3]>,
}

/// One object of the folder: its views are taught together as those of a track.
struct Object {
    category: CategoryName,
    /// Places of its views among the folder's.
    views: Range<usize>,
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

/// Describes the folder's views, stores and teaches them, object by object.
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
    let appearance = Appearance::new(AppearanceWeights::default()).map_err(failed)?;
    let objects = objects(views.files(), &mut report);
    let bar = progress::bar(views.files().len() as u64, "views", output);
    let mut categories = BTreeSet::new();
    for object in &objects {
        // One by one, since the clouds of a whole folder may be more than memory holds.
        let work = |appearance: &mut Appearance, place| {
            describe(
                appearance,
                &views,
                object.views.start + place,
                told.as_ref(),
            )
        };
        let results = parallel::map(object.views.len(), &bar, || appearance.clone(), work)?;
        let described = usable(results, &mut report);
        if !described.is_empty() {
            teach(&mut client, arguments, object, &described, &mut report)?;
            categories.insert(&object.category);
        }
    }
    bar.finish_and_clear();
    report.n_categories = categories.len();
    let unusable = views.unusable().iter().map(ToString::to_string);
    report.left_out.extend(unusable);
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

/// The objects in the order of their views; where objects are not known, each
/// category is one. What can not be taught is left out with its reason.
fn objects(files: &[ViewFile], report: &mut Report) -> Vec<Object> {
    let is_same =
        |a: &ViewFile, b: &ViewFile| (&a.category, &a.instance) == (&b.category, &b.instance);
    let mut objects = Vec::new();
    let mut start = 0;
    for of_object in files.chunk_by(is_same) {
        let views = start..start + of_object.len();
        start = views.end;
        let name = &of_object[0].category;
        match CategoryName::new(name) {
            Ok(category) => objects.push(Object { category, views }),
            Err(error) => {
                let n_views = views.len();
                let reason = format!("{n_views} view(s) of {name}: {error}");
                report.left_out.push(reason);
            }
        }
    }
    objects
}

/// The views that could be described; of the others the reason is told.
fn usable(results: Vec<Result<Described, String>>, report: &mut Report) -> Vec<Described> {
    let mut described = Vec::with_capacity(results.len());
    for result in results {
        match result {
            Ok(view) => described.push(view),
            Err(reason) => report.left_out.push(reason),
        }
    }
    described
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
        packed_cloud: pack_cloud(view.points.iter(), &RigidTransform::identity()),
        mean_rgb: mean_rgb(&view.points),
    })
}

/// The mean colour; `None` where a file has no colours, which is read as zeros.
fn mean_rgb(points: &[Point]) -> Option<[u8; 3]> {
    let has_colors = points.iter().any(|point| point.color != Rgba::default());
    let mean = |channel: usize| {
        let values = points
            .iter()
            .map(|point| u64::from(point.color.rgb()[channel]));
        (values.sum::<u64>() / points.len() as u64) as u8
    };
    has_colors.then(|| [0, 1, 2].map(mean))
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

/// Stores an object's views under a new track-id and teaches that track.
fn teach(
    client: &mut SocketClient,
    arguments: &LearnArguments,
    object: &Object,
    views: &[Described],
    report: &mut Report,
) -> Result<(), Failure> {
    let track_id = match call(client, Command::LeaseTrackIds { count: 1 })? {
        Reply::TrackIds { first } => first,
        other => return Err(unexpected(&other)),
    };
    let stored = (0..)
        .zip(views)
        .map(|(view_id, view)| stored_view(ViewId { track_id, view_id }, view));
    for views in requests(stored) {
        let command = Command::StoreViews {
            id: mutation_id()?,
            views,
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
        Reply::Learned(learned) => {
            report.n_objects += 1;
            report.n_views += views.len();
            report.sequence = learned.sequence;
        }
        other => return Err(unexpected(&other)),
    }
    Ok(())
}

/// The views in order, as many together as one request holds.
fn requests(views: impl Iterator<Item = StoredView>) -> impl Iterator<Item = Vec<StoredView>> {
    let mut views = views.peekable();
    std::iter::from_fn(move || {
        let mut request = vec![views.next()?];
        let mut n_bytes = request[0].max_encoded_bytes();
        while let Some(view) = views.next_if(|view| {
            n_bytes += view.max_encoded_bytes();
            n_bytes <= StoredView::MAX_REQUEST_BYTES
        }) {
            request.push(view);
        }
        Some(request)
    })
}

/// A view without a place in the world: it was never on this table. Its cloud is in
/// the frame of its file.
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
        points: view.packed_cloud.clone(),
        mean_rgb: view.mean_rgb,
    }
}

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(n_points: usize) -> Described {
        let points = vec![Point::default(); n_points];
        Described {
            descriptor: vec![0.0; 309],
            size_m: [0.1; 3],
            source: "mug/mug_1/mug_1_1_1.pcd".into(),
            packed_cloud: pack_cloud(points.iter(), &RigidTransform::identity()),
            mean_rgb: mean_rgb(&points),
        }
    }

    #[test]
    fn requests_hold_all_views_in_order_and_are_not_too_long() {
        let sizes = (0..60).map(|i| [100, 30_000, 5000, 0][i % 4]);
        let views: Vec<StoredView> = (0..)
            .zip(sizes)
            .map(|(view_id, n_points)| {
                let track_id = 1;
                stored_view(ViewId { track_id, view_id }, &described(n_points))
            })
            .collect();
        let requests: Vec<_> = requests(views.clone().into_iter()).collect();
        for request in &requests {
            let n_bytes = request.iter().map(StoredView::max_encoded_bytes);
            assert!(n_bytes.sum::<usize>() <= StoredView::MAX_REQUEST_BYTES);
        }
        for two in requests.windows(2) {
            let n_bytes = two[0].iter().chain(&two[1][..1]);
            let n_bytes: usize = n_bytes.map(StoredView::max_encoded_bytes).sum();
            assert!(n_bytes > StoredView::MAX_REQUEST_BYTES);
        }
        assert!(requests.concat() == views);
    }

    #[test]
    fn without_colours_there_is_no_mean_of_them() {
        let point = |color| Point {
            color,
            ..Point::default()
        };
        let (dark, light) = (Rgba::opaque(0, 10, 20), Rgba::opaque(100, 20, 21));
        assert_eq!(mean_rgb(&[point(dark), point(light)]), Some([50, 15, 20]));
        assert_eq!(mean_rgb(&[Point::default(); 3]), None);
        assert_eq!(mean_rgb(&[]), None);
    }

    #[test]
    fn views_side_by_side_of_one_object_are_taught_together() {
        let file = |category: &str, instance: Option<&str>| ViewFile {
            path: "view.pcd".into(),
            category: category.into(),
            instance: instance.map(ToOwned::to_owned),
        };
        let files = [
            file("mug", Some("1")),
            file("mug", Some("1")),
            file("mug", Some("2")),
            file("m\u{7}g", None),
            file("pan", None),
            file("pan", None),
        ];
        let mut report = Report::default();
        let objects = objects(&files, &mut report);
        let found: Vec<_> = objects
            .iter()
            .map(|object| (object.category.as_str(), object.views.clone()))
            .collect();
        assert_eq!(found, [("mug", 0..2), ("mug", 2..3), ("pan", 4..6)]);
        assert_eq!(report.left_out.len(), 1, "{report:?}");
    }
}
