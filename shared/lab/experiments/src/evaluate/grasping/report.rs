//! Report of the evaluation of grasps.

use super::judges_agreement::JudgesAgreement;
use super::trial::{GraspOutcome, GraspTrial};
use crate::arguments::{GraspJudge, GraspingArguments};
use crate::evaluate::tabular_report::{ReportTable, TabularReport};
use plot::figure_page::PageFigure;
use serde::Serialize;
use statistics::percentiles::nearest_rank;

/// Number of pictures on the page at most: those of failed trials.
const N_PICTURES_MAX: usize = 60;

/// Report of the evaluation of grasps.
#[derive(Debug, Serialize)]
pub(super) struct GraspingReport {
    pub(super) models: String,
    pub(super) seed: u64,
    pub(super) n_trials: usize,
    /// Share of the trials in which the object was lifted at the first attempt.
    pub(super) success: f64,
    /// Share of the trials in which MuJoCo says that the object was lifted, shaken and held; `None`
    /// without it.
    pub(super) success_mujoco: Option<f64>,
    /// The same for the trivial rival: from above, across the shorter side of the upright bounding
    /// box.
    pub(super) success_rival: Option<f64>,
    /// Agreement of both judges about planned and spoiled grasps; `None` without MuJoCo.
    pub(super) judges_agreement: Option<JudgesAgreement>,
    /// Share of the trials in which a grasp was planned.
    pub(super) planned: f64,
    /// Time of the planning, milliseconds: median and 95th percentile.
    pub(super) planning_ms: [f64; 2],
    pub(super) trials: Vec<GraspTrial>,
}

impl GraspingReport {
    pub(super) fn of(trials: Vec<GraspTrial>, arguments: &GraspingArguments) -> Self {
        let n = trials.len().max(1) as f64;
        let share = |is: fn(&GraspTrial) -> bool| {
            trials.iter().filter(|trial| is(trial)).count() as f64 / n
        };
        let mut times_ms: Vec<f64> = trials.iter().map(|trial| trial.planning_ms).collect();
        times_ms.sort_unstable_by(f64::total_cmp);
        let has_mujoco = arguments.judge == GraspJudge::Mujoco;
        Self {
            success_mujoco: has_mujoco.then(|| share(|trial| trial.mujoco == Some(true))),
            success_rival: has_mujoco.then(|| share(|trial| trial.rival_mujoco == Some(true))),
            judges_agreement: JudgesAgreement::of(&trials),
            models: arguments.models.to_string(),
            seed: arguments.seed,
            n_trials: trials.len(),
            success: share(|trial| trial.outcome == GraspOutcome::Lifted),
            planned: share(|trial| trial.score.is_some()),
            planning_ms: [0.5, 0.95]
                .map(|share| nearest_rank(&times_ms, share).unwrap_or_default()),
            trials,
        }
    }
}

/// Tables, notes and pictures of the report.
pub(super) fn page(document: &GraspingReport) -> TabularReport<'static> {
    let failed = || {
        let trials = document.trials.iter();
        trials.filter(|trial| trial.outcome != GraspOutcome::Lifted)
    };
    TabularReport {
        title: "Grasps of single objects",
        tables: vec![ReportTable::of(
            "Failed trials",
            failed(),
            &[
                ("object", &|trial| trial.object.clone()),
                ("seed", &|trial| trial.seed.to_string()),
                ("outcome", &|trial| format!("{:?}", trial.outcome)),
                ("score", &|trial| {
                    trial.score.map_or("-".into(), |s| format!("{s:.2}"))
                }),
                ("approach", &|trial| trial.approach.unwrap_or("-").into()),
                ("reason", &|trial| trial.reason.clone()),
            ],
        )],
        notes: notes(document),
        figures: failed().take(N_PICTURES_MAX).map(figure).collect(),
        ..TabularReport::default()
    }
}

fn notes(document: &GraspingReport) -> Vec<String> {
    let mut notes = vec![format!(
        "{} trials, each from one view and at the first attempt: {:.1} % lifted and held for \
             a second by the rules of the simulation; a grasp was planned in {:.1} %; planning took \
             {:.1} ms in the median, {:.1} ms in the 95th percentile",
        document.n_trials,
        1e2 * document.success,
        1e2 * document.planned,
        document.planning_ms[0],
        document.planning_ms[1]
    )];
    if let (Some(success), Some(rival), Some(agreement)) = (
        document.success_mujoco,
        document.success_rival,
        document.judges_agreement,
    ) {
        notes.push(format!(
            "by MuJoCo {:.1} % were lifted, shaken and held; of the grasps from above across the \
             bounding box {:.1} %; with as many spoiled grasps, both judges agree on {:.1} % of its \
             successes and {:.1} % of its failures, kappa {:.2}",
            1e2 * success,
            1e2 * rival,
            1e2 * agreement.of_successes,
            1e2 * agreement.of_failures,
            agreement.kappa
        ));
    }
    notes
}

fn figure(trial: &GraspTrial) -> PageFigure {
    PageFigure {
        caption: format!("{}, seed {}: {:?}", trial.object, trial.seed, trial.outcome),
        picture: trial.picture.clone(),
    }
}
