//! Track drift in a recording without ground truth: spans, drift, and pictures for labelling by a
//! person.

use super::PICTURES;
use super::recorded_sequence::{ProcessedFrame, RecordedSequence};
use super::resting_truth::RestingReport;
use super::small_text_file;
use crate::arguments::TrackingArguments;
use crate::evaluate::report_parts::ReportFiles;
use crate::evaluate::tabular_report::{ReportTable, TabularReport, figure, number};
use crate::output_files::{create_folder, write, write_figure};
use command_line::{Output, progress_bar};
use evaluation::box_picture::{self, NumberedBox};
use evaluation::resting_objects::RestingObjects;
use evaluation::track_drift::{TrackSpan, track_spans};
use evaluation::track_figure;
use serde::Serialize;
use service::Failure;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

/// Folder of the frames with boxes, inside the output folder.
const FRAMES: &str = "frames";
/// Number of frames for each drawn one. Chosen.
const FRAMES_A_PICTURE: usize = 25;

#[derive(Debug, Serialize)]
struct DriftReport {
    version: &'static str,
    dataset: String,
    n_frames: usize,
    n_ids: usize,
    tracks: Vec<TrackDrift>,
    objects: Option<BTreeMap<String, ObjectDrift>>,
    ids_per_object: Option<f64>,
    truth: Option<RestingReport>,
    #[serde(flatten)]
    files: ReportFiles,
    frames: String,
}

#[derive(Debug, Serialize)]
struct TrackDrift {
    id: u64,
    label: Option<String>,
    first_frame: usize,
    last_frame: usize,
    n_frames_seen: usize,
    centre_m: [f64; 3],
    drift_mm: f64,
    sigma_mm: f64,
}

/// Tracks with the same object label.
#[derive(Debug, Default, Serialize)]
struct ObjectDrift {
    ids: Vec<u64>,
    n_frames_seen: usize,
    /// Maximum drift of the object's tracks, millimetres.
    drift_mm: f64,
}

/// Tracks the recording, and writes spans, drift and pictures.
pub(super) fn run(
    recording: &RecordedSequence,
    marks: Option<&RestingObjects>,
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let labels = arguments.labels.as_deref().map(read_labels).transpose()?;
    let frames_folder = arguments.out.join(FRAMES);
    create_folder(&frames_folder)?;
    let bar = progress_bar(recording.n_frames() as u64, "frames", output);
    let sequence = recording.play(|shown| {
        bar.inc(1);
        if !shown.index.is_multiple_of(FRAMES_A_PICTURE) {
            return Ok(());
        }
        let path = frames_folder.join(format!("{:06}.png", shown.index));
        write(&path, &picture(shown)?)
    })?;
    bar.finish_and_clear();
    let figure = track_figure::figure_without_ground_truth(
        &recording.name,
        &sequence.frames,
        &recording.up_in_world(),
    );
    let picture = format!("{PICTURES}/{}.svg", recording.name);
    write_figure(&arguments.out, &picture, figure.svg())?;
    let spans = track_spans(&sequence.frames);
    let mut document = document(&spans, sequence.frames.len(), labels.as_ref(), arguments);
    document.truth = marks.map(|marks| RestingReport::of(&sequence.frames, marks));
    let title = format!("Tracks in {}", recording.name);
    let page = page(&document, &title, &picture);
    page.publish(&arguments.out, "tracking.json", &document, output)
}

/// Picture of a frame with the boxes of its visible tracks.
fn picture(shown: &ProcessedFrame<'_>) -> Result<Vec<u8>, Failure> {
    let camera_from_world = shown.world_from_camera.inverse();
    let outputs = shown.tracks.iter().filter(|track| track.is_output);
    let boxes: Vec<NumberedBox> = outputs
        .map(|track| NumberedBox {
            number: track.id,
            box_in_camera: track.box_in_world.transformed(&camera_from_world),
        })
        .collect();
    box_picture::draw(shown.points, shown.camera, &boxes).map_err(Failure::general)
}

fn document(
    spans: &[TrackSpan],
    n_frames: usize,
    labels: Option<&BTreeMap<u64, String>>,
    arguments: &TrackingArguments,
) -> DriftReport {
    let label = |id: u64| labels.and_then(|labels| labels.get(&id).cloned());
    let tracks: Vec<TrackDrift> = spans
        .iter()
        .map(|span| TrackDrift {
            id: span.id,
            label: label(span.id),
            first_frame: span.first_frame,
            last_frame: span.last_frame,
            n_frames_seen: span.n_frames,
            centre_m: span.centre.into(),
            drift_mm: 1e3 * span.drift_m,
            sigma_mm: 1e3 * span.sigma_m,
        })
        .collect();
    let objects = labels.map(|_| objects(&tracks));
    let ids_per_object = objects.as_ref().and_then(|objects| {
        let n_ids: usize = objects.values().map(|object| object.ids.len()).sum();
        (!objects.is_empty()).then(|| n_ids as f64 / objects.len() as f64)
    });
    let dataset = arguments.dataset.as_ref();
    DriftReport {
        version: env!("CARGO_PKG_VERSION"),
        dataset: dataset.map_or(String::new(), |path| path.display().to_string()),
        n_frames,
        n_ids: tracks.len(),
        tracks,
        objects,
        ids_per_object,
        truth: None,
        files: ReportFiles::in_folder(&arguments.out, "tracking.json"),
        frames: arguments.out.join(FRAMES).display().to_string(),
    }
}

/// Track drifts grouped by object label.
fn objects(tracks: &[TrackDrift]) -> BTreeMap<String, ObjectDrift> {
    let mut objects: BTreeMap<String, ObjectDrift> = BTreeMap::new();
    for track in tracks {
        let Some(label) = &track.label else { continue };
        let object = objects.entry(label.clone()).or_default();
        object.ids.push(track.id);
        object.n_frames_seen += track.n_frames_seen;
        object.drift_mm = object.drift_mm.max(track.drift_mm);
    }
    objects
}

/// Reads lines of `track_id,object-name`; the first line may be a heading.
fn read_labels(path: &Path) -> Result<BTreeMap<u64, String>, Failure> {
    let wrong = |cause: String| {
        let sentence = format!("the labels in {} cannot be used: {cause}", path.display());
        Failure::usage(sentence)
    };
    small_text_file::read(path)
        .and_then(|text| parse_labels(&text))
        .map_err(wrong)
}

fn parse_labels(text: &str) -> Result<BTreeMap<u64, String>, String> {
    let mut labels = BTreeMap::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || (index == 0 && line.starts_with("track_id")) {
            continue;
        }
        let label = line.split_once(',').and_then(|(id, name)| {
            let id: u64 = id.trim().parse().ok()?;
            let name = name.trim();
            (!name.is_empty()).then(|| (id, name.to_owned()))
        });
        let (id, name) =
            label.ok_or_else(|| format!("line {} is not `track_id,object-name`", index + 1))?;
        if labels.insert(id, name).is_some() {
            return Err(format!("line {} labels track {id} again", index + 1));
        }
    }
    Ok(labels)
}

/// Tables, summaries and pictures of the report.
fn page<'t>(document: &DriftReport, title: &'t str, picture: &str) -> TabularReport<'t> {
    let truth = document.truth.iter();
    let summaries = truth.clone().map(RestingReport::summary);
    let drawn = (0..document.n_frames).step_by(FRAMES_A_PICTURE);
    let drawn = drawn.map(|index| {
        figure(
            &format!("{FRAMES}/{index:06}.png"),
            format!("frame {index}"),
        )
    });
    let overview = figure(picture, "The table from above, and the tracks over time");
    let mut files = document.files.paths();
    files.push(document.frames.clone());
    TabularReport {
        title,
        tables: truth
            .map(RestingReport::table)
            .chain([tracks(document)])
            .collect(),
        notes: std::iter::once(summary(document))
            .chain(summaries)
            .collect(),
        figures: std::iter::once(overview).chain(drawn).collect(),
        files,
        ..TabularReport::default()
    }
}

fn tracks(document: &DriftReport) -> ReportTable {
    ReportTable::of(
        "Tracks that were seen and believed",
        &document.tracks,
        &[
            ("track", &|track| track.id.to_string()),
            ("label", &|track| track.label.clone().unwrap_or_default()),
            ("first", &|track| track.first_frame.to_string()),
            ("last", &|track| track.last_frame.to_string()),
            ("frames", &|track| track.n_frames_seen.to_string()),
            ("drift mm", &|track| number(track.drift_mm, 1)),
            ("sigma mm", &|track| number(track.sigma_mm, 1)),
            ("centre m", &|track| {
                track.centre_m.map(|m| format!("{m:.3}")).join(" ")
            }),
        ],
    )
}

fn summary(document: &DriftReport) -> String {
    let ids = document.ids_per_object;
    let ids = ids.map_or(String::new(), |ids| format!(", {ids:.2} an object"));
    format!(
        "{} track-ids in {} frames{ids}",
        document.n_ids, document.n_frames
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_read_line_by_line() {
        let labels = parse_labels("track_id,object-name\n3, mug\n\n5,mug\n7,white bowl, small\n");
        let expected = [(3, "mug"), (5, "mug"), (7, "white bowl, small")];
        let expected = expected.map(|(id, name)| (id, name.to_owned()));
        assert_eq!(labels.unwrap(), BTreeMap::from(expected));
        for (text, place) in [
            ("3 mug", "line 1"),
            ("1,a\n1,b", "line 2"),
            ("1,a\n-2,b", "line 2"),
        ] {
            let error = parse_labels(text).unwrap_err();
            assert!(error.contains(place), "{error}");
        }
    }

    #[test]
    fn objects_collect_the_tracks_of_their_label() {
        let track = |id, label: Option<&str>, drift_mm| TrackDrift {
            id,
            label: label.map(str::to_owned),
            first_frame: 0,
            last_frame: 9,
            n_frames_seen: 10,
            centre_m: [0.0; 3],
            drift_mm,
            sigma_mm: 0.0,
        };
        let tracks = [
            track(1, Some("mug"), 3.0),
            track(2, None, 9.0),
            track(4, Some("mug"), 5.0),
        ];
        let objects = objects(&tracks);
        assert_eq!(objects["mug"].ids, [1, 4]);
        assert_eq!((objects["mug"].drift_mm, objects.len()), (5.0, 1));
    }
}
