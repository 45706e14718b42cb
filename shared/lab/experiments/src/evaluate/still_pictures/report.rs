//! Report of the still-picture test.

use super::play::PlayResult;
use crate::arguments::StillPicturesArguments;
use crate::evaluate::tabular_report::{ReportTable, TabularReport};
use plot::figure_page::PageFigure;
use serde::Serialize;

/// Report of the still-picture test.
#[derive(Debug, Serialize)]
pub(super) struct StillPicturesReport {
    /// Number of times that each picture was played.
    pub(super) n_frames: u32,
    pub(super) seed: u64,
    /// Number of pictures.
    pub(super) n_pictures: usize,
    /// Number of pictures that are still when the same bytes are played.
    pub(super) n_still: usize,
    /// Number of pictures that are still when the noise is drawn anew.
    pub(super) n_still_with_noise: usize,
    /// Pictures in the order of the recording.
    pub(super) pictures: Vec<PictureResult>,
}

/// Results of one picture.
#[derive(Debug, Serialize)]
pub(super) struct PictureResult {
    pub(super) name: String,
    /// Colour, surfaces and candidates after the last frame with equal bytes, relative to the output
    /// folder.
    pub(super) picture: String,
    /// The same bytes played again and again.
    pub(super) equal: PlayResult,
    /// Noise drawn anew for each frame.
    pub(super) noise: PlayResult,
}

impl StillPicturesReport {
    pub(super) fn of(pictures: Vec<PictureResult>, arguments: &StillPicturesArguments) -> Self {
        let count = |play: fn(&PictureResult) -> &PlayResult| {
            pictures.iter().filter(|one| play(one).is_still()).count()
        };
        Self {
            n_frames: arguments.frames,
            seed: arguments.seed,
            n_pictures: pictures.len(),
            n_still: count(|one| &one.equal),
            n_still_with_noise: count(|one| &one.noise),
            pictures,
        }
    }
}

/// Tables and notes of the report.
pub(super) fn page(document: &StillPicturesReport) -> TabularReport<'static> {
    let all = document.pictures.iter().flat_map(|picture| {
        let PictureResult {
            name, equal, noise, ..
        } = picture;
        [(name, "equal", equal), (name, "noise", noise)]
    });
    let moved = all.filter(|(_, _, play)| !play.is_still());
    TabularReport {
        title: "Still pictures",
        tables: vec![ReportTable::of(
            "Pictures that are not still",
            moved,
            &[
                ("picture", &|(name, ..)| (*name).clone()),
                ("bytes", &|(_, bytes, _)| (*bytes).to_owned()),
                ("first tracks", &|(.., play)| {
                    play.first_tracks
                        .map_or("-".into(), |frame| frame.to_string())
                }),
                ("tracks", &|(.., play)| play.n_tracks.to_string()),
                ("track-ids", &|(.., play)| play.n_track_ids.to_string()),
                ("late changes", &|(.., play)| {
                    play.n_late_changes.to_string()
                }),
                ("late labels", &|(.., play)| play.n_late_labels.to_string()),
                ("table turns (°)", &|(.., play)| {
                    format!("{:.2}", play.table_turn_deg)
                }),
                ("table steps (mm)", &|(.., play)| {
                    format!("{:.1}", play.table_step_mm)
                }),
            ],
        )],
        notes: vec![format!(
            "{} pictures, each played {} times: {} are still with equal bytes, {} with noise drawn \
             anew; the first tracks come within ten frames, and after the twentieth no track \
             begins or ends and no label changes",
            document.n_pictures, document.n_frames, document.n_still, document.n_still_with_noise
        )],
        figures: document.pictures.iter().map(figure).collect(),
        ..TabularReport::default()
    }
}

/// Colour, surfaces and candidates of a picture.
fn figure(picture: &PictureResult) -> PageFigure {
    let PlayResult {
        n_tracks,
        n_track_ids,
        ..
    } = picture.equal;
    PageFigure {
        caption: format!(
            "{}: {n_tracks} tracks, {n_track_ids} track-ids",
            picture.name
        ),
        picture: picture.picture.clone(),
    }
}
