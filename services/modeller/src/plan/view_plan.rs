//! Plan of the next best view: rating of the candidates and choice among them.

use super::planning_frame::PlanningFrame;
use super::virtual_camera;
use super::visible_shares::VisibleShares;
use crate::arguments::PlanArguments;
use crate::hypotheses::ObjectHypothesis;
use geometry::{PinholeCamera, RigidTransform};
use message::ViewState;
use nalgebra::{Unit, Vector3};
use next_best_view::{
    CandidateState, CandidateViews, ChoiceReason, Config, Hypothesis, OccupancyGrid, PlanningScene,
    ViewPlanner, ViewProjection, ViewScore, ViewSegmenter, VirtualView, choose_view, view_entropy,
};
use random::Random;
use service::Failure;

/// Height above the table below which a camera is in it, metres: the near clip of virtual views.
const TABLE_CLEARANCE_M: f64 = 0.05;

/// Rated camera pose, frame of planning.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RatedView {
    pub(crate) plan_from_camera: RigidTransform,
    pub(crate) score: ViewScore,
    pub(crate) state: ViewState,
    /// Rank by utility among the open ones, from 1.
    pub(crate) rank: Option<usize>,
    pub(crate) n_objects_seen: usize,
}

/// Plan of the next best view.
#[derive(Debug, Clone)]
pub(crate) struct ViewPlan {
    /// Candidates in their order.
    pub(crate) views: Vec<RatedView>,
    /// Index of the chosen candidate.
    pub(crate) chosen: usize,
    pub(crate) reason: ChoiceReason,
    /// View from the present pose.
    pub(crate) present: RatedView,
    /// Visible share of each object from the present pose and from the chosen one.
    pub(crate) shares: Vec<[f64; 2]>,
}

/// Content of a plan: hypotheses and background in the frame of planning.
pub(crate) struct PlanInput<'a> {
    pub(crate) frame: &'a PlanningFrame,
    pub(crate) camera: PinholeCamera,
    pub(crate) hypotheses: &'a [ObjectHypothesis],
    pub(crate) background: &'a [[f32; 3]],
    pub(crate) occupancy: Option<&'a OccupancyGrid>,
    pub(crate) candidates: &'a [RigidTransform],
    pub(crate) visited: &'a [RigidTransform],
    pub(crate) cell_m: f64,
}

/// Rates all candidates and chooses one.
///
/// # Errors
/// When no candidate is left, or a pose or setting is impossible.
pub(crate) fn plan(
    input: &PlanInput<'_>,
    arguments: &PlanArguments,
    random: &mut Random,
) -> Result<ViewPlan, Failure> {
    let scene = planning_scene(input)?;
    let config = config(input, arguments);
    // The present pose is rated among the candidates, so that the diameter of them all, of which
    // the weights are shares, includes the way to them.
    let mut poses = input.candidates.to_vec();
    poses.push(input.frame.plan_from_camera);
    let mut scores = scores(&scene, input, &poses, &config)?;
    if arguments.by_segmentation {
        rate_by_segments(&scene, &poses, &config, &mut scores)?;
    }
    let mut shares = VisibleShares::new(input.hypotheses)?;
    let mut views = Vec::with_capacity(poses.len());
    for (pose, score) in poses.iter().zip(&scores) {
        let n_seen = shares.seen_from(&scene, pose, &config.render)?;
        views.push(rated(pose, score, n_seen, input.frame));
    }
    let shares_now = shares.shares().to_vec();
    let Some(present) = views.pop().filter(|_| !views.is_empty()) else {
        return Err(Failure::general(next_best_view::Error::NoCandidates));
    };
    rank(&mut views);
    let (chosen, reason) = chosen(&views, arguments, random)?;
    shares.seen_from(&scene, &views[chosen].plan_from_camera, &config.render)?;
    let pairs = shares_now.iter().zip(shares.shares());
    Ok(ViewPlan {
        chosen,
        reason,
        present,
        shares: pairs.map(|(now, then)| [*now, *then]).collect(),
        views,
    })
}

/// Scene of the hypotheses, numbered by their order, and the background.
pub(crate) fn planning_scene(input: &PlanInput<'_>) -> Result<PlanningScene, Failure> {
    let numbered = input.hypotheses.iter().zip(0_u32..);
    let hypotheses: Vec<Hypothesis<'_>> = numbered
        .map(|(hypothesis, id)| Hypothesis {
            id,
            model: &hypothesis.surface,
            world_from_object: hypothesis.plan_from_object,
        })
        .collect();
    PlanningScene::new(&hypotheses, input.background).map_err(Failure::general)
}

fn config(input: &PlanInput<'_>, arguments: &PlanArguments) -> Config {
    let mut config = Config {
        sigma_share: arguments.sigma_share,
        gain_weight: arguments.gain_weight,
        ..Config::default()
    };
    config.render.projection = if arguments.wants_perspective() {
        let distance_m = input.frame.plan_from_camera.translation.vector.norm();
        let camera = virtual_camera::coarse(&input.camera, distance_m, input.cell_m);
        ViewProjection::Perspective(camera)
    } else {
        ViewProjection::Orthographic {
            cell_m: input.cell_m,
        }
    };
    config
}

fn scores(
    scene: &PlanningScene,
    input: &PlanInput<'_>,
    candidates: &[RigidTransform],
    config: &Config,
) -> Result<Vec<ViewScore>, Failure> {
    let views = CandidateViews {
        world_from_candidates: candidates,
        world_from_current: input.frame.plan_from_camera,
        world_from_visited: input.visited,
    };
    let mut planner = ViewPlanner::default();
    let scores = planner.score(scene, &views, config, input.occupancy);
    Ok(scores.map_err(Failure::general)?.to_vec())
}

/// Replaces entropies by those of the segments that detection finds in the virtual views.
fn rate_by_segments(
    scene: &PlanningScene,
    poses: &[RigidTransform],
    config: &Config,
    scores: &mut [ViewScore],
) -> Result<(), Failure> {
    let (mut view, mut segmenter) = (VirtualView::default(), ViewSegmenter::default());
    for (pose, score) in poses.iter().zip(scores) {
        view.render(scene, pose, &config.render)
            .map_err(Failure::general)?;
        let up_in_camera = Unit::new_normalize(pose.rotation.inverse() * Vector3::z());
        // A view that detection refuses, such as an empty one, has no segments.
        let entropy =
            segmenter
                .segment(&view, Some(up_in_camera), 1)
                .map_or(0.0, |(areas_m2, rest_m2)| {
                    view_entropy(areas_m2, rest_m2, config.total_area, config.log_base)
                });
        *score = score.with_entropy(entropy, config);
    }
    Ok(())
}

fn rated(
    pose: &RigidTransform,
    score: &ViewScore,
    n_objects_seen: usize,
    frame: &PlanningFrame,
) -> RatedView {
    let height_m = frame.height_m(&pose.translation.vector.into());
    let state = match score.state {
        CandidateState::Visited => ViewState::Visited,
        CandidateState::Blocked => ViewState::Blocked,
        CandidateState::Open if height_m.is_some_and(|height| height < TABLE_CLEARANCE_M) => {
            ViewState::BelowTable
        }
        CandidateState::Open => ViewState::Open,
    };
    RatedView {
        plan_from_camera: *pose,
        score: *score,
        state,
        rank: None,
        n_objects_seen,
    }
}

/// Numbers the open views by utility, then by gain.
fn rank(views: &mut [RatedView]) {
    let mut open: Vec<usize> = (0..views.len())
        .filter(|&index| views[index].state == ViewState::Open)
        .collect();
    open.sort_by(|&a, &b| {
        let (a, b) = (&views[a].score, &views[b].score);
        b.utility
            .total_cmp(&a.utility)
            .then(b.gain.total_cmp(&a.gain))
    });
    for (rank, index) in (1..).zip(open) {
        views[index].rank = Some(rank);
    }
}

fn chosen(
    views: &[RatedView],
    arguments: &PlanArguments,
    random: &mut Random,
) -> Result<(usize, ChoiceReason), Failure> {
    let score = |view: &RatedView| ViewScore {
        // The choice takes open candidates only.
        state: match view.state {
            ViewState::Open => CandidateState::Open,
            ViewState::Visited => CandidateState::Visited,
            ViewState::Blocked | ViewState::BelowTable => CandidateState::Blocked,
        },
        ..view.score
    };
    let scores: Vec<ViewScore> = views.iter().map(score).collect();
    if !views.iter().any(|view| view.state == ViewState::Open) {
        return Err(Failure::general(none_left(views)));
    }
    let choice = choose_view(&scores, arguments.selection(), random);
    let choice = choice.map_err(Failure::general)?;
    Ok((choice.candidate, choice.reason))
}

fn none_left(views: &[RatedView]) -> String {
    let count = |state| views.iter().filter(|view| view.state == state).count();
    format!(
        "none of the {} candidate views is left: {} were visited, {} are inside an object or at a \
         surface, and {} are below the table; give other poses by --views, or fewer by --visited",
        views.len(),
        count(ViewState::Visited),
        count(ViewState::Blocked),
        count(ViewState::BelowTable)
    )
}

#[cfg(test)]
mod tests;
