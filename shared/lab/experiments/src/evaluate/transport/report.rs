//! Report of the evaluation of transports.

use super::trial::{TransportOutcome, TransportTrial};
use super::trial_run::{RunOutcome, RunStage};
use crate::arguments::TransportArguments;
use crate::evaluate::tabular_report::{ReportTable, TabularReport};
use plot::figure_page::PageFigure;
use serde::Serialize;
use statistics::percentiles::nearest_rank;

/// Number of pictures on the page at most.
const N_PICTURES_MAX: usize = 40;

/// Figures of all runs of one way to move.
#[derive(Debug, Serialize)]
pub(super) struct RunFigures {
    pub(super) n_runs: usize,
    /// Runs in which another object was moved by more than a centimetre, or tipped.
    pub(super) n_disturbed: usize,
    /// Runs in which the arm did not come to the object.
    pub(super) n_on_the_way: usize,
    pub(super) n_held: usize,
    /// Runs in which the object stands at its place.
    pub(super) n_placed: usize,
    /// Share of the runs with the object in the hand after which it stands at its place.
    pub(super) placed_of_held: f64,
}

/// Report of the evaluation of transports.
#[derive(Debug, Serialize)]
pub(super) struct TransportReport {
    pub(super) models: String,
    pub(super) seed: u64,
    pub(super) n_trials: usize,
    pub(super) n_with_grasp: usize,
    pub(super) n_planned: usize,
    pub(super) ours: RunFigures,
    /// Straight motions of the joints in place of the transits, with the same grasps and places.
    pub(super) rival: RunFigures,
    /// Number of transits by kind.
    pub(super) n_over_safe_height: usize,
    pub(super) n_random_tree: usize,
    /// Time of the planning, milliseconds: median, 95th percentile, maximum.
    pub(super) obstacles_ms: [f64; 3],
    pub(super) transport_ms: [f64; 3],
    pub(super) transit_ms: [f64; 3],
    /// Median time that the arm needs for both transits, and for the rival's, seconds.
    pub(super) transit_s: f64,
    pub(super) straight_s: f64,
    pub(super) trials: Vec<TransportTrial>,
}

impl RunFigures {
    fn of<'a>(runs: impl Iterator<Item = &'a RunOutcome>) -> Self {
        let runs: Vec<&RunOutcome> = runs.collect();
        let count = |is: &dyn Fn(&RunOutcome) -> bool| runs.iter().filter(|run| is(run)).count();
        let n_held = count(&|run| run.stage > RunStage::NotHeld);
        let n_placed = count(&|run| run.stage == RunStage::Placed);
        Self {
            n_runs: runs.len(),
            n_disturbed: count(&|run| !run.disturbed.is_empty()),
            n_on_the_way: count(&|run| run.stage == RunStage::OnTheWay),
            n_held,
            n_placed,
            placed_of_held: n_placed as f64 / n_held.max(1) as f64,
        }
    }
}

impl TransportReport {
    pub(super) fn of(trials: Vec<TransportTrial>, arguments: &TransportArguments) -> Self {
        let is_planned = |t: &&TransportTrial| t.outcome == TransportOutcome::CarriedOut;
        let with_grasp = |t: &&TransportTrial| t.outcome != TransportOutcome::NoGrasp;
        let kinds = || trials.iter().flat_map(|trial| &trial.transits);
        let n_of = |word: &str| kinds().filter(|kind| **kind == word).count();
        let tried = || trials.iter().filter(with_grasp);
        Self {
            models: arguments.models.to_string(),
            seed: arguments.seed,
            n_trials: trials.len(),
            n_with_grasp: tried().count(),
            n_planned: trials.iter().filter(is_planned).count(),
            ours: RunFigures::of(trials.iter().filter_map(|trial| trial.run.as_ref())),
            rival: RunFigures::of(trials.iter().filter_map(|trial| trial.rival.as_ref())),
            n_over_safe_height: n_of("over_safe_height"),
            n_random_tree: n_of("random_tree"),
            obstacles_ms: ranks(tried().map(|trial| trial.obstacles_ms)),
            transport_ms: ranks(tried().map(|trial| trial.transport_ms)),
            transit_ms: ranks(
                trials
                    .iter()
                    .flat_map(|trial| trial.transit_ms.iter().copied()),
            ),
            transit_s: ranks(trials.iter().filter_map(|trial| trial.transit_s))[0],
            straight_s: ranks(trials.iter().filter_map(|trial| trial.straight_s))[0],
            trials,
        }
    }
}

/// Median, 95th percentile and maximum.
fn ranks(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    [0.5, 0.95, 1.0].map(|share| nearest_rank(&values, share).unwrap_or_default())
}

/// Tables, notes and pictures of the report.
pub(super) fn page(document: &TransportReport) -> TabularReport<'static> {
    let is_good = |trial: &TransportTrial| {
        let run = trial.run.as_ref();
        run.is_some_and(|run| run.stage == RunStage::Placed && run.disturbed.is_empty())
    };
    let failed = || document.trials.iter().filter(|trial| !is_good(trial));
    let both = [
        ("planned transits", &document.ours),
        ("straight motions", &document.rival),
    ];
    TabularReport {
        title: "Transports",
        tables: vec![
            ReportTable::of(
                "Runs",
                both,
                &[
                    ("motions", &|(name, _)| (*name).to_owned()),
                    ("runs", &|(_, runs)| runs.n_runs.to_string()),
                    ("others moved", &|(_, runs)| runs.n_disturbed.to_string()),
                    ("stopped on the way", &|(_, runs)| {
                        runs.n_on_the_way.to_string()
                    }),
                    ("held", &|(_, runs)| runs.n_held.to_string()),
                    ("placed", &|(_, runs)| runs.n_placed.to_string()),
                ],
            ),
            ReportTable::of(
                "Trials that did not end well",
                failed(),
                &[
                    ("scene", &|trial| format!("{} {}", trial.kind, trial.seed)),
                    ("object", &|trial| trial.model.clone()),
                    ("outcome", &outcome_words),
                ],
            ),
        ],
        notes: notes(document),
        figures: document
            .trials
            .iter()
            .take(N_PICTURES_MAX)
            .map(figure)
            .collect(),
        ..TabularReport::default()
    }
}

fn outcome_words(trial: &&TransportTrial) -> String {
    match &trial.run {
        None => trial.reason.clone(),
        Some(run) if run.disturbed.is_empty() => format!("{:?}: {}", run.stage, run.reason),
        Some(run) => format!("{:?}, moved {}", run.stage, run.disturbed.join(", ")),
    }
}

fn notes(document: &TransportReport) -> Vec<String> {
    let [median, p95, most] = document.transport_ms;
    let transit_ms = document.transit_ms;
    vec![
        format!(
            "{} objects, {} with a grasp, {} with a whole transport: {} transits over a safe height, \
             {} by the random tree",
            document.n_trials,
            document.n_with_grasp,
            document.n_planned,
            document.n_over_safe_height,
            document.n_random_tree
        ),
        format!(
            "planning of transits and place {median:.1} ms in the median, {p95:.1} ms in the 95th \
             percentile, {most:.1} ms at most; one transit {:.1}, {:.1} and {:.1} ms; obstacles of \
             the scene {:.1} ms",
            transit_ms[0], transit_ms[1], transit_ms[2], document.obstacles_ms[0]
        ),
        format!(
            "the arm needs {:.1} s for both transits in the median, {:.1} s by straight motions",
            document.transit_s, document.straight_s
        ),
    ]
}

fn figure(trial: &TransportTrial) -> PageFigure {
    PageFigure {
        caption: format!("{} {}: {}", trial.kind, trial.seed, trial.model),
        picture: trial.picture.clone(),
    }
}
