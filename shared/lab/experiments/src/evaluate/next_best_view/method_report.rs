//! Report of the closed loops of each method.

use super::closed_loop::{LoopCourse, N_VIEWS_MAX};
use super::entropy_prediction::PredictionScore;
use super::loop_method::Method;
use super::scene_result::SceneResult;
use serde::Serialize;
use statistics::bootstrap::Estimate;
use std::collections::BTreeMap;

/// Travel at which methods are compared, metres. Chosen.
const TRAVEL_M: f64 = 3.0;
/// Number of views at which methods are compared. Chosen.
const N_VIEWS: usize = 5;

/// Closed loops of one method.
#[derive(Debug, Clone, Serialize)]
pub(super) struct MethodReport {
    /// Mean number of views until 95 % of the objects were found; a loop that gave up counts with
    /// its last view.
    pub(super) views_to_95: f64,
    /// The same with its 95 % interval over the scenes.
    pub(super) views_to_95_interval: Option<Estimate>,
    /// Mean way travelled until then, metres.
    pub(super) travel_m: f64,
    /// Share of the loops that found them.
    pub(super) complete_share: f64,
    /// Mean share of the objects found after five views.
    pub(super) found_after_5_views: f64,
    /// Mean share of the objects found within 3 m of travel.
    pub(super) found_within_3_m: f64,
    /// Loss of entropy by the method's choice, bit; null where it does not predict entropy.
    pub(super) regret: Option<f64>,
    /// Mean share found after each number of views.
    pub(super) found_by_views: Vec<f64>,
}

/// Closed loops of all methods, by name, with the regret of predictions by registered models and
/// by the truth with noise.
pub(super) fn all(
    scenes: &[SceneResult],
    (own, noisy_truth): (&PredictionScore, &PredictionScore),
    seed: u64,
) -> BTreeMap<&'static str, MethodReport> {
    let report = |method: Method| {
        let of_scenes: Vec<Vec<&LoopCourse>> = scenes
            .iter()
            .map(|scene| {
                let of_method = scene.courses.iter().filter(|(of, _)| *of == method);
                of_method.flat_map(|(_, courses)| courses).collect()
            })
            .collect();
        let regret = match method {
            Method::Greedy => Some(own.regret),
            Method::GreedyTruth => Some(noisy_truth.regret),
            Method::Random => Some(own.random_regret),
            _ => None,
        };
        (method.word(), MethodReport::of(&of_scenes, regret, seed))
    };
    Method::ALL.into_iter().map(report).collect()
}

impl MethodReport {
    fn of(of_scenes: &[Vec<&LoopCourse>], regret: Option<f64>, seed: u64) -> Self {
        let courses: Vec<&LoopCourse> = of_scenes.iter().flatten().copied().collect();
        let n = courses.len().max(1) as f64;
        let mean = |value: &dyn Fn(&LoopCourse) -> f64| {
            courses.iter().map(|course| value(course)).sum::<f64>() / n
        };
        let n_views = |course: &LoopCourse| course.views.len() as f64;
        let of_scene = |courses: &Vec<&LoopCourse>| {
            let sum: f64 = courses.iter().map(|course| n_views(course)).sum();
            Some(sum / courses.len().max(1) as f64)
        };
        let of_scenes: Vec<Option<f64>> = of_scenes.iter().map(of_scene).collect();
        let by_views = |n: usize| mean(&|course| found_after(course, n));
        Self {
            views_to_95: mean(&n_views),
            views_to_95_interval: Estimate::mean(&of_scenes, seed),
            travel_m: mean(&|course| course.travel_m.last().copied().unwrap_or(0.0)),
            complete_share: mean(&|course| f64::from(u8::from(course.is_complete))),
            found_after_5_views: by_views(N_VIEWS),
            found_within_3_m: mean(&|course| found_within(course, TRAVEL_M)),
            regret,
            found_by_views: (1..=N_VIEWS_MAX).map(by_views).collect(),
        }
    }
}

/// Share found after a number of views; the last one where the loop ended before.
fn found_after(course: &LoopCourse, n_views: usize) -> f64 {
    let shares = &course.found_shares;
    shares
        .get(n_views - 1)
        .or(shares.last())
        .copied()
        .unwrap_or(0.0)
}

/// Share found within a way of travel.
pub(super) fn found_within(course: &LoopCourse, travel_m: f64) -> f64 {
    let steps = course.travel_m.iter().zip(&course.found_shares);
    let within = steps.take_while(|(way_m, _)| **way_m <= travel_m);
    within.last().map_or(0.0, |(_, share)| *share)
}
