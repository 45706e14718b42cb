//! Plan of the next best view: rating of the candidates and choice among them.

use crate::plan_content::PlanContent;
use crate::plan_settings::PlanSettings;
use crate::visible_shares::VisibleShares;
use geometry::RigidTransform;
use message::ViewState;
use nalgebra::{Unit, Vector3};
use next_best_view::{
    CandidateState, CandidateViews, ChoiceReason, Config, PlanningScene, ViewPlanner,
    ViewProjection, ViewScore, ViewSegmenter, VirtualView, choose_view, view_entropy,
};
use random::Random;
use scene_client::PlanningFrame;
use service::Failure;

/// Height above the table below which a camera is in it, metres: the near clip of virtual views.
const TABLE_CLEARANCE_M: f64 = 0.05;

/// Rated camera pose, frame of planning.
#[derive(Debug, Clone, Copy)]
pub struct RatedView {
    /// Pose of the camera.
    pub plan_from_camera: RigidTransform,
    /// Entropy, gain, weight and utility.
    pub score: ViewScore,
    /// State as a candidate.
    pub state: ViewState,
    /// Rank by utility among the open ones, from 1.
    pub rank: Option<usize>,
    /// Number of hypotheses of which at least a tenth is visible.
    pub n_objects_seen: usize,
}

/// Plan of the next best view.
#[derive(Debug, Clone)]
pub struct ViewPlan {
    /// Candidates in their order.
    pub views: Vec<RatedView>,
    /// Index of the chosen candidate.
    pub chosen: usize,
    /// Reason of the choice.
    pub reason: ChoiceReason,
    /// View from the present pose.
    pub present: RatedView,
    /// Visible share of each object from the present pose and from the chosen one.
    pub shares: Vec<[f64; 2]>,
}

/// Rates all candidates and chooses one. Candidates and visited views are poses in the frame of
/// planning; the present pose counts as visited.
///
/// # Errors
/// When no candidate is left, or a pose or setting is impossible.
pub fn plan(
    content: &PlanContent,
    candidates: &[RigidTransform],
    visited: &[RigidTransform],
    settings: &PlanSettings,
    random: &mut Random,
) -> Result<ViewPlan, Failure> {
    let (scene, config) = (content.scene()?, config(content, settings));
    // The present pose is rated among the candidates, so that the diameter of them all, of which
    // the weights are shares, includes the way to them.
    let mut poses = candidates.to_vec();
    poses.push(content.frame.plan_from_camera);
    let scores = rate(content, &poses, visited, settings)?;
    let mut shares = VisibleShares::new(&content.hypotheses)?;
    let mut views = Vec::with_capacity(poses.len());
    for (pose, score) in poses.iter().zip(&scores) {
        let n_seen = shares.seen_from(&scene, pose, &config.render)?;
        views.push(rated(pose, score, n_seen, &content.frame));
    }
    let shares_now = shares.shares().to_vec();
    let Some(present) = views.pop().filter(|_| !views.is_empty()) else {
        return Err(Failure::general(next_best_view::Error::NoCandidates));
    };
    rank(&mut views);
    let (chosen, reason) = chosen(&views, settings, random)?;
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

/// Scores of poses in the frame of planning, in their order.
///
/// # Errors
/// When a pose or setting is impossible.
pub fn rate(
    content: &PlanContent,
    poses: &[RigidTransform],
    visited: &[RigidTransform],
    settings: &PlanSettings,
) -> Result<Vec<ViewScore>, Failure> {
    let (scene, config) = (content.scene()?, config(content, settings));
    let views = CandidateViews {
        world_from_candidates: poses,
        world_from_current: content.frame.plan_from_camera,
        world_from_visited: visited,
    };
    let occupancy = content.occupancy.as_ref();
    let occupancy = occupancy.filter(|_| settings.gain_weight > 0.0);
    let mut planner = ViewPlanner::default();
    let scores = planner.score(&scene, &views, &config, occupancy);
    let mut scores = scores.map_err(Failure::general)?.to_vec();
    if settings.is_segmented {
        rate_by_segments(&scene, poses, &config, &mut scores)?;
    }
    Ok(scores)
}

fn config(content: &PlanContent, settings: &PlanSettings) -> Config {
    let mut config = Config {
        sigma_share: settings.sigma_share,
        visited_share: settings.visited_share,
        gain_weight: settings.gain_weight,
        ..Config::default()
    };
    config.render.projection = if settings.is_perspective || settings.is_segmented {
        ViewProjection::Perspective(content.virtual_camera())
    } else {
        ViewProjection::Orthographic {
            cell_m: content.cell_m,
        }
    };
    config
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
                .segment(&view, Some(up_in_camera))
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
    settings: &PlanSettings,
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
    let choice = choose_view(&scores, settings.selection, random);
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
