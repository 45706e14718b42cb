//! Report of the tracking evaluation.

use super::tracking_run::TrackingRun;
use crate::arguments::TrackingArguments;
use crate::evaluate::report_parts::ReportFiles;
use evaluation::tracking_score::{GATE_M, TrackingScore};
use serde::Serialize;
use statistics::spread::Spread;
use std::collections::BTreeMap;

/// Report of a tracking evaluation.
#[derive(Debug, Serialize)]
pub(super) struct TrackingReport {
    version: &'static str,
    dataset: String,
    #[serde(flatten)]
    pub(super) overall: Figures,
    pub(super) scenes: BTreeMap<String, SceneFigures>,
    settings: Settings,
    #[serde(flatten)]
    pub(super) files: ReportFiles,
}

/// Settings of the tracking evaluation.
#[derive(Debug, Serialize)]
struct Settings {
    seeds: u64,
    first_seed: u64,
    rate_hz: f64,
    gate_mm: f64,
}

/// Tracking metrics pooled over several runs.
#[derive(Debug, Serialize)]
pub(super) struct Figures {
    pub(super) n_runs: usize,
    pub(super) n_frames: usize,
    pub(super) n_objects: usize,
    pub(super) mota: Option<f64>,
    pub(super) idf1: Option<f64>,
    pub(super) id_switches: u64,
    pub(super) misses: u64,
    pub(super) false_positives: u64,
    pub(super) truths: u64,
    pub(super) centre_error_mm: Option<Spread>,
    pub(super) centre_error_at_1_m_mm: Option<Spread>,
    pub(super) centre_error_horizontal_mm: Option<Spread>,
    pub(super) centre_error_vertical_mm: Option<Spread>,
    pub(super) whole_box_centre_error_mm: Option<Spread>,
    pub(super) orientation_error_deg: Option<Spread>,
    pub(super) angular_orientation_error_deg: Option<Spread>,
    orientation_error_up_to_quarter_deg: Option<Spread>,
    pub(super) flips: u64,
    pub(super) lost: Option<f64>,
    pub(super) n_lost: usize,
    pub(super) ids_per_object: Option<f64>,
    pub(super) n_tracks: usize,
    pub(super) tracks_of_nothing: usize,
    pub(super) part_tracks: usize,
    longest_part_s: f64,
    pub(super) joined_pairs: usize,
    object_pairs: usize,
    pub(super) frames_with_person_track: u64,
    pub(super) removed: Option<Removed>,
}

/// Survival time of the tracks of removed objects.
#[derive(Debug, Serialize)]
pub(super) struct Removed {
    n: usize,
    n_never_ended: usize,
    pub(super) ended_after_s: Option<Spread>,
}

/// Tracking metrics of one scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneFigures {
    #[serde(flatten)]
    pub(super) figures: Figures,
    pub(super) per_seed: Vec<SeedFigures>,
}

/// Tracking metrics of one run (seed).
#[derive(Debug, Serialize)]
pub(super) struct SeedFigures {
    pub(super) seed: Option<u64>,
    #[serde(flatten)]
    pub(super) figures: Figures,
    pub(super) picture: String,
    notes: Vec<String>,
}

impl Figures {
    fn of<'r>(runs: impl IntoIterator<Item = &'r TrackingRun>) -> Self {
        let mut score = TrackingScore::default();
        let (mut n_runs, mut n_frames) = (0, 0);
        for run in runs {
            score.add(&run.score);
            n_runs += 1;
            n_frames += run.n_frames;
        }
        let errors = &score.errors;
        let vertical: Vec<f64> = errors.vertical_mm.iter().map(|error| error.abs()).collect();
        let n_objects = score.n_objects;
        Self {
            n_runs,
            n_frames,
            n_objects,
            mota: score.mot.mota(),
            idf1: score.identity.idf1(),
            id_switches: score.mot.n_switches,
            misses: score.mot.n_misses,
            false_positives: score.mot.n_false_positives,
            truths: score.mot.n_objects,
            centre_error_mm: Spread::of(&errors.centre_mm),
            centre_error_at_1_m_mm: Spread::of(&errors.centre_at_1_m_mm),
            centre_error_horizontal_mm: Spread::of(&errors.horizontal_mm),
            centre_error_vertical_mm: Spread::of(&vertical),
            whole_box_centre_error_mm: Spread::of(&errors.whole_mm),
            orientation_error_deg: Spread::of(&errors.orientation_deg),
            angular_orientation_error_deg: Spread::of(&errors.angular_deg),
            orientation_error_up_to_quarter_deg: Spread::of(&errors.up_to_quarter_deg),
            flips: score.n_flips,
            lost: score.lost(),
            n_lost: score.n_lost,
            ids_per_object: (n_objects > 0).then(|| score.n_ids as f64 / n_objects as f64),
            n_tracks: score.n_tracks,
            tracks_of_nothing: score.n_tracks_of_nothing,
            part_tracks: score.wholeness.n_part_tracks,
            longest_part_s: score.wholeness.longest_part_s,
            joined_pairs: score.wholeness.n_joined_pairs,
            object_pairs: score.wholeness.n_pairs,
            frames_with_person_track: score.n_frames_with_person_track,
            removed: Removed::of(&score.removed_after_s),
        }
    }
}

impl Removed {
    fn of(waits_s: &[Option<f64>]) -> Option<Self> {
        let ended: Vec<f64> = waits_s.iter().flatten().copied().collect();
        (!waits_s.is_empty()).then(|| Self {
            n: waits_s.len(),
            n_never_ended: waits_s.len() - ended.len(),
            ended_after_s: Spread::of(&ended),
        })
    }
}

impl TrackingReport {
    /// Report of runs ordered by scene and seed.
    pub(super) fn of(runs: &[TrackingRun], arguments: &TrackingArguments) -> Self {
        let mut scenes = BTreeMap::new();
        for run in runs {
            let of_scene = || runs.iter().filter(|other| other.scene == run.scene);
            scenes
                .entry(run.scene.clone())
                .or_insert_with(|| SceneFigures {
                    figures: Figures::of(of_scene()),
                    per_seed: of_scene().map(SeedFigures::of).collect(),
                });
        }
        let dataset = arguments.dataset.as_ref();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            dataset: dataset.map_or("built-in".into(), |path| path.display().to_string()),
            overall: Figures::of(runs),
            scenes,
            settings: Settings {
                seeds: arguments.seeds,
                first_seed: arguments.seed,
                rate_hz: super::RATE_HZ,
                gate_mm: 1e3 * GATE_M,
            },
            files: ReportFiles::in_folder(&arguments.out, "tracking.json"),
        }
    }
}

impl SeedFigures {
    fn of(run: &TrackingRun) -> Self {
        Self {
            seed: run.seed,
            figures: Figures::of([run]),
            picture: run.picture.clone(),
            notes: run.notes.clone(),
        }
    }
}
