//! Hand-made ground truth of a recording: marks of objects at rest, and the report of the score
//! against them.

use super::small_text_file;
use crate::arguments::TrackingArguments;
use crate::evaluate::tabular_report::{ReportTable, number};
use evaluation::resting_objects::{RestingObjects, RestingScore};
use evaluation::tracked_frame::TrackedFrame;
use serde::Serialize;
use service::Failure;
use std::path::{Path, PathBuf};

/// Name of a file of marks inside the folder of the recording, used without `--truth`.
const FILE_NAME: &str = "resting-objects.toml";

/// Score of a recording against marked objects at rest.
#[derive(Debug, Serialize)]
pub(super) struct RestingReport {
    pub(super) ids_per_object: Option<f64>,
    pub(super) id_switches: usize,
    pub(super) drift_max_mm: Option<f64>,
    pub(super) tracks_of_nothing: Vec<u64>,
    pub(super) objects: Vec<RestingObjectReport>,
}

/// Score of one marked object.
#[derive(Debug, Serialize)]
pub(super) struct RestingObjectReport {
    name: String,
    color: String,
    ids: Vec<u64>,
    n_frames_in_view: usize,
    n_frames_tracked: usize,
    id_switches: usize,
    drift_mm: Option<f64>,
    offset_mm: Option<f64>,
}

impl RestingReport {
    /// Score of the frames of a recording.
    pub(super) fn of(frames: &[TrackedFrame], marks: &RestingObjects) -> Self {
        let score = RestingScore::of(frames, marks);
        let to_mm = |metres: Option<f64>| metres.map(|metres| 1e3 * metres);
        let drifts_m = score.objects.iter().filter_map(|object| object.drift_m);
        Self {
            ids_per_object: score.ids_per_object(),
            id_switches: score.n_switches(),
            drift_max_mm: to_mm(drifts_m.reduce(f64::max)),
            tracks_of_nothing: score.tracks_of_nothing,
            objects: marks
                .objects
                .iter()
                .zip(score.objects)
                .map(|(mark, scored)| RestingObjectReport {
                    name: mark.name.clone(),
                    color: mark.color.clone(),
                    ids: scored.ids,
                    n_frames_in_view: scored.n_in_view,
                    n_frames_tracked: scored.n_tracked,
                    id_switches: scored.n_switches,
                    drift_mm: to_mm(scored.drift_m),
                    offset_mm: to_mm(scored.offset_m),
                })
                .collect(),
        }
    }

    /// Table of the marked objects.
    pub(super) fn table(&self) -> ReportTable {
        ReportTable::of(
            "Marked objects at rest",
            &self.objects,
            &[
                ("object", &|object| object.name.clone()),
                ("ids", &|object| object.ids.len().to_string()),
                ("in view", &|object| object.n_frames_in_view.to_string()),
                ("tracked", &|object| object.n_frames_tracked.to_string()),
                ("switches", &|object| object.id_switches.to_string()),
                ("drift mm", &|object| number(object.drift_mm, 1)),
                ("offset mm", &|object| number(object.offset_mm, 1)),
            ],
        )
    }

    /// One sentence on all objects.
    pub(super) fn summary(&self) -> String {
        let number = |value: Option<f64>, digits: usize| {
            value.map_or_else(|| "no".to_owned(), |value| format!("{value:.digits$}"))
        };
        format!(
            "{} track-ids an object, {} identity switches, drift up to {} mm, {} tracks of nothing",
            number(self.ids_per_object, 2),
            self.id_switches,
            number(self.drift_max_mm, 1),
            self.tracks_of_nothing.len()
        )
    }
}

/// Marks of a recording: those of `--truth`, else of the file in the recording's folder; `None`
/// without both.
///
/// # Errors
/// If the file cannot be read or marks something impossible.
pub(super) fn marks(
    recording: &Path,
    arguments: &TrackingArguments,
) -> Result<Option<RestingObjects>, Failure> {
    let beside = recording.join(FILE_NAME);
    let found = || beside.exists().then_some(beside);
    let path: Option<PathBuf> = arguments.truth.clone().or_else(found);
    path.as_deref().map(read).transpose()
}

fn read(path: &Path) -> Result<RestingObjects, Failure> {
    let wrong = |cause: String| {
        let sentence = format!("the truth in {} cannot be used: {cause}", path.display());
        Failure::usage(sentence)
    };
    small_text_file::read(path)
        .and_then(|text| parse(&text))
        .map_err(wrong)
}

fn parse(text: &str) -> Result<RestingObjects, String> {
    let marks: RestingObjects = toml::from_str(text).map_err(|error| error.to_string())?;
    marks.validated()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_truth_files_are_valid() {
        for text in [
            include_str!("../../../scenes/recordings/kitchen-sequence.toml"),
            include_str!("../../../scenes/recordings/kitchen-sequence-2.toml"),
        ] {
            assert!(parse(text).unwrap().objects.len() >= 5);
        }
    }

    #[test]
    fn unknown_keys_of_a_truth_file_are_refused() {
        let text = "[[object]]\nname = \"mug\"\ncolour = \"white\"\n";
        assert!(parse(text).is_err());
    }
}
