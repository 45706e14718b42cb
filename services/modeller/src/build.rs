//! `tabula model build`: a model grows while the camera moves around the object.

use crate::arguments::BuildArguments;
use crate::growth::{Growth, Step};
use crate::model_document::object_model;
use crate::object_receiver::{ObjectReceiver, TrackedObject};
use crate::presence::{is_running, require_daemon};
use channel::{Domain, Role, RunFolder};
use command_line::{Output, StopSignal};
use control_client::{MemoryClient, NewDocument};
use message::control::{DocumentKind, DocumentName};
use object_model::{MEDIA_TYPE, ObjectModel};
use serde::Serialize;
use service::{CommonArguments, Failure};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Polling period of the topics.
const POLL_PERIOD: Duration = Duration::from_millis(5);
/// Period of the checks of the daemon, and of the lines that show the growth.
const CHECK_PERIOD: Duration = Duration::from_secs(1);
const LINE_PERIOD: Duration = Duration::from_secs(2);
/// Time for which a scene with the object is awaited.
const SCENE_PATIENCE: Duration = Duration::from_secs(5);
/// Time without a view of the object after which a person is told.
const UNSEEN_PERIOD: Duration = Duration::from_secs(3);

/// Built model as a JSON document.
#[derive(Debug, Serialize)]
struct BuiltDocument {
    name: String,
    track: u64,
    seconds: f64,
    views: usize,
    refused: usize,
    /// Reasons of the refused views with their numbers.
    reasons: Vec<(String, usize)>,
    is_closed_loop: bool,
    /// Share of all directions from which the object was seen, 0 to 1.
    completeness: f64,
    /// Parts that are still missing, in words.
    missing: Vec<String>,
    vertices: usize,
    triangles: usize,
    extents_mm: [f64; 3],
    /// Median time of a view, milliseconds.
    view_ms: f64,
    bytes: usize,
    end: &'static str,
}

/// Reason for the end of the construction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Stopped,
    Time,
    Closed,
    DaemonEnded,
}

impl End {
    fn word(self) -> &'static str {
        match self {
            Self::Stopped => "stopped",
            Self::Time => "the time is over",
            Self::Closed => "the views have led around the object",
            Self::DaemonEnded => "the daemon has ended",
        }
    }
}

/// Builds and stores the model of an object.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &BuildArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install()?;
    require_daemon(&common.domain)?;
    let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
    let mut receiver = ObjectReceiver::new(&domain)?;
    let object = chosen_object(&mut receiver, arguments.track, &stop)?;
    let name = arguments.name.clone().or_else(|| object.label.clone());
    let name = name.unwrap_or_else(|| format!("track-{}", object.track));
    output.print_status(&format!(
        "looking at object {}, which becomes the model {name:?}; move the camera slowly around \
         it, Ctrl-C ends",
        object.track
    ));
    let begun = Instant::now();
    let mut growth = Growth::new(arguments.config(), arguments.pose_sigma());
    let end = grow(
        &mut growth,
        &mut receiver,
        &object,
        (common, arguments),
        (&stop, output),
    )?;
    if growth.builder().views().is_empty() {
        let sentence = match growth.refused().first() {
            Some(refused) => format!("no view of the object could be used: {}", refused.reason),
            None => format!(
                "object {} was never seen, so that there is no model of it; show it to the camera \
                 whole",
                object.track
            ),
        };
        return Err(Failure::general(sentence));
    }
    // The views that closed the loop agree already.
    if end != End::Closed {
        growth.finish();
    }
    let model = object_model(&growth);
    let n_bytes = store(common, arguments.author.as_deref(), (&name, &model))?;
    let document = built_document(&growth, &model, (name, object.track), end, n_bytes);
    let document = BuiltDocument {
        seconds: begun.elapsed().as_secs_f64(),
        ..document
    };
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

/// Object of a track-id, or the one nearest to the middle of the image.
fn chosen_object(
    receiver: &mut ObjectReceiver,
    track: Option<u64>,
    stop: &StopSignal,
) -> Result<TrackedObject, Failure> {
    let begun = Instant::now();
    let mut known: Vec<u64> = Vec::new();
    while begun.elapsed() < SCENE_PATIENCE && !stop.is_raised() {
        if let Some(objects) = receiver.objects()? {
            let is_chosen = |object: &&TrackedObject| match track {
                Some(track) => object.track == track,
                None => object.is_seen,
            };
            if let Some(object) = objects.iter().find(is_chosen) {
                return Ok(object.clone());
            }
            known = objects.iter().map(|object| object.track).collect();
        }
        stop.sleep(POLL_PERIOD);
    }
    let known: Vec<String> = known.iter().map(u64::to_string).collect();
    let sentence = match track {
        Some(track) if known.is_empty() => {
            format!("there is no object {track}: the scene is empty; see `tabula objects`")
        }
        Some(track) => {
            format!("there is no object {track}; there are {}", known.join(", "))
        }
        None => "no object is seen whole; point the camera at one".to_owned(),
    };
    Err(Failure::general(sentence))
}

/// Adds views until an end.
fn grow(
    growth: &mut Growth,
    receiver: &mut ObjectReceiver,
    object: &TrackedObject,
    (common, arguments): (&CommonArguments, &BuildArguments),
    (stop, output): (&StopSignal, &Output),
) -> Result<End, Failure> {
    let begun = Instant::now();
    let (mut next_check, mut next_line) = (begun + CHECK_PERIOD, begun + LINE_PERIOD);
    let mut last_view = begun;
    loop {
        if let Some(view) = receiver.newest_view(object.track)? {
            last_view = Instant::now();
            if growth.add(&view) == Step::Closed {
                output.print_status("the views lead around the object; the loop is closed");
                if arguments.until_closed {
                    return Ok(End::Closed);
                }
            }
        }
        let now = Instant::now();
        if stop.is_raised() {
            return Ok(End::Stopped);
        }
        if arguments
            .seconds
            .is_some_and(|s| begun.elapsed().as_secs() >= s)
        {
            return Ok(End::Time);
        }
        if now >= next_check {
            next_check = now + CHECK_PERIOD;
            if !is_running(&common.domain) {
                return Ok(End::DaemonEnded);
            }
        }
        if now >= next_line {
            next_line = now + LINE_PERIOD;
            if now.duration_since(last_view) > UNSEEN_PERIOD {
                output.print_status(&format!("object {} is not seen", object.track));
            } else {
                output.print_status(&growth.line(begun.elapsed()));
            }
        }
        stop.sleep(POLL_PERIOD);
    }
}

/// Stores the model; returns the size of the document, bytes.
fn store(
    common: &CommonArguments,
    author: Option<&str>,
    (name, model): (&str, &ObjectModel),
) -> Result<usize, Failure> {
    let content = model.to_bytes().map_err(Failure::general)?;
    let document = DocumentName {
        kind: DocumentKind::ObjectModel,
        name: name.to_owned(),
    };
    let new = NewDocument {
        document: &document,
        media_type: MEDIA_TYPE,
        content: &content,
    };
    MemoryClient::open(common)?.put_document(new, author)?;
    Ok(content.len())
}

fn built_document(
    growth: &Growth,
    model: &ObjectModel,
    (name, track): (String, u64),
    end: End,
    bytes: usize,
) -> BuiltDocument {
    let mut reasons: Vec<(String, usize)> = Vec::new();
    for refused in growth.refused() {
        match reasons
            .iter_mut()
            .find(|(reason, _)| *reason == refused.reason)
        {
            Some((_, n)) => *n += 1,
            None => reasons.push((refused.reason.clone(), 1)),
        }
    }
    reasons.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let mut times = growth.view_ms().to_vec();
    times.sort_unstable_by(f64::total_cmp);
    BuiltDocument {
        name,
        track,
        seconds: 0.0,
        views: model.views.len(),
        refused: growth.n_refused(),
        reasons,
        is_closed_loop: model.is_closed_loop,
        completeness: model.unseen.completeness(),
        missing: model.unseen.in_words(),
        vertices: model.mesh.vertices.len(),
        triangles: model.mesh.triangles.len(),
        extents_mm: model.summary().extents_m.map(|side| 1e3 * side),
        view_ms: times.get(times.len() / 2).copied().unwrap_or(0.0),
        bytes,
        end: end.word(),
    }
}

fn text(document: &BuiltDocument) -> String {
    let [width, depth, height] = document.extents_mm;
    let mut lines = vec![format!(
        "the model {:?} is stored: {} views, {} triangles, {width:.0} x {depth:.0} x {height:.0} \
         mm, {:.0} % of all directions seen; {}",
        document.name,
        document.views,
        document.triangles,
        100.0 * document.completeness,
        document.end
    )];
    if !document.missing.is_empty() {
        lines.push(format!("missing: {}", document.missing.join(", ")));
    }
    if let Some((reason, _)) = document.reasons.first() {
        lines.push(format!(
            "{} views were refused, most of them: {reason}",
            document.refused
        ));
    }
    lines.push(format!(
        "export it with: tabula model export {:?}",
        document.name
    ));
    lines.join("\n")
}
