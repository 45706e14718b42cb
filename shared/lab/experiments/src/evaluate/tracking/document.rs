//! The figures of `tabula evaluate tracking` as a document.

use crate::arguments::TrackingArguments;
use evaluation::tracking_score::{GATE_M, TrackingScore};
use serde::Serialize;
use statistics::spread::Spread;
use std::collections::BTreeMap;

/// What came out of one run.
pub(super) struct Run {
    pub(super) scene: String,
    /// `None` of a recording.
    pub(super) seed: Option<u64>,
    pub(super) n_frames: usize,
    pub(super) score: TrackingScore,
    pub(super) notes: Vec<String>,
    /// Relative to the folder of the results.
    pub(super) picture: String,
}

/// All figures.
#[derive(Debug, Serialize)]
pub(super) struct Document {
    version: &'static str,
    dataset: String,
    #[serde(flatten)]
    pub(super) overall: Figures,
    pub(super) scenes: BTreeMap<String, SceneFigures>,
    settings: Settings,
    pub(super) page: String,
    pub(super) file: String,
}

/// How the figures were made.
#[derive(Debug, Serialize)]
struct Settings {
    seeds: u64,
    first_seed: u64,
    rate_hz: f64,
    gate_mm: f64,
}

/// Figures of some runs.
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
    pub(super) centre_error_mm: Option<Percentiles>,
    pub(super) centre_error_at_1_m_mm: Option<Percentiles>,
    pub(super) centre_error_horizontal_mm: Option<Percentiles>,
    pub(super) centre_error_vertical_mm: Option<Percentiles>,
    pub(super) whole_box_centre_error_mm: Option<Percentiles>,
    pub(super) orientation_error_deg: Option<Percentiles>,
    pub(super) angular_orientation_error_deg: Option<Percentiles>,
    orientation_error_up_to_quarter_deg: Option<Percentiles>,
    pub(super) flips: u64,
    pub(super) lost: Option<f64>,
    pub(super) n_lost: usize,
    pub(super) ids_per_object: Option<f64>,
    pub(super) n_tracks: usize,
    pub(super) tracks_of_nothing: usize,
    pub(super) removed: Option<Removed>,
}

/// How long tracks of removed objects live on.
#[derive(Debug, Serialize)]
pub(super) struct Removed {
    n: usize,
    n_never_ended: usize,
    pub(super) ended_after_s: Option<Percentiles>,
}

/// One scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneFigures {
    #[serde(flatten)]
    pub(super) figures: Figures,
    pub(super) per_seed: Vec<SeedFigures>,
}

/// One run.
#[derive(Debug, Serialize)]
pub(super) struct SeedFigures {
    pub(super) seed: Option<u64>,
    #[serde(flatten)]
    pub(super) figures: Figures,
    pub(super) picture: String,
    notes: Vec<String>,
}

/// How values spread.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Percentiles {
    n: usize,
    pub(super) mean: f64,
    pub(super) median: f64,
    pub(super) p95: f64,
    pub(super) p99: f64,
    pub(super) max: f64,
}

impl Percentiles {
    fn of(values: &[f64]) -> Option<Self> {
        let Spread {
            n,
            mean,
            median,
            p95,
            p99,
            max,
        } = Spread::of(values)?;
        Some(Self {
            n,
            mean,
            median,
            p95,
            p99,
            max,
        })
    }
}

impl Figures {
    fn of<'r>(runs: impl IntoIterator<Item = &'r Run>) -> Self {
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
            centre_error_mm: Percentiles::of(&errors.centre_mm),
            centre_error_at_1_m_mm: Percentiles::of(&errors.centre_at_1_m_mm),
            centre_error_horizontal_mm: Percentiles::of(&errors.horizontal_mm),
            centre_error_vertical_mm: Percentiles::of(&vertical),
            whole_box_centre_error_mm: Percentiles::of(&errors.whole_mm),
            orientation_error_deg: Percentiles::of(&errors.orientation_deg),
            angular_orientation_error_deg: Percentiles::of(&errors.angular_deg),
            orientation_error_up_to_quarter_deg: Percentiles::of(&errors.up_to_quarter_deg),
            flips: score.n_flips,
            lost: score.lost(),
            n_lost: score.n_lost,
            ids_per_object: (n_objects > 0).then(|| score.n_ids as f64 / n_objects as f64),
            n_tracks: score.n_tracks,
            tracks_of_nothing: score.n_tracks_of_nothing,
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
            ended_after_s: Percentiles::of(&ended),
        })
    }
}

impl Document {
    /// Of runs in the order of scenes and seeds.
    pub(super) fn of(runs: &[Run], arguments: &TrackingArguments) -> Self {
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
                rate_hz: super::simulated::RATE_HZ,
                gate_mm: 1e3 * GATE_M,
            },
            page: arguments.out.join("index.html").display().to_string(),
            file: arguments.out.join("tracking.json").display().to_string(),
        }
    }
}

impl SeedFigures {
    fn of(run: &Run) -> Self {
        Self {
            seed: run.seed,
            figures: Figures::of([run]),
            picture: run.picture.clone(),
            notes: run.notes.clone(),
        }
    }
}
