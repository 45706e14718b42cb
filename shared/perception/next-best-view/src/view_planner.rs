//! View planner: scores of candidate views by entropy, distance and information gain.

use crate::candidate_views::CandidateViews;
use crate::config::Config;
use crate::error::Error;
use crate::occupancy_grid::OccupancyGrid;
use crate::planning_scene::PlanningScene;
use crate::ray_casting::SeenVoxels;
use crate::view_distance::{ViewMetric, gaussian_weight, novelty_weight};
use crate::view_entropy::view_entropy;
use crate::virtual_view::VirtualView;

/// Distance up to which a candidate counts as a visited view, metres. Chosen: a robot does not
/// place its camera better.
const SAME_VIEW_M: f64 = 0.01;

/// State of a candidate view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CandidateState {
    /// Candidate that can be chosen.
    Open,
    /// Candidate at the pose of the current camera or of a visited one.
    Visited,
    /// Candidate within the bounding sphere of an object, or closer to the background than the
    /// near clip.
    Blocked,
}

/// Score of a candidate view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewScore {
    /// Viewpoint entropy of the virtual view, in units of the logarithm's base.
    pub entropy: f64,
    /// Information gain: share of the unknown voxels that the view would see, 0 to 1; 0 without an
    /// occupancy grid.
    pub gain: f64,
    /// Distance from the current camera, metres.
    pub distance_m: f64,
    /// Weight of the distance, 0 to 1, with the penalty near visited views.
    pub weight: f64,
    /// Weighted entropy with the weighted information gain.
    pub utility: f64,
    /// State of the candidate.
    pub state: CandidateState,
}

impl ViewScore {
    /// This score with another entropy, such as that of the segments of the view.
    #[must_use]
    pub fn with_entropy(self, entropy: f64, config: &Config) -> Self {
        Self {
            entropy,
            utility: utility(self.weight, entropy, self.gain, config),
            ..self
        }
    }
}

/// Weighted entropy with the weighted information gain.
fn utility(weight: f64, entropy: f64, gain: f64, config: &Config) -> f64 {
    weight * (entropy + config.gain_weight * gain)
}

/// View planner with its buffers, reused from decision to decision.
#[derive(Debug, Clone, Default)]
pub struct ViewPlanner {
    view: VirtualView,
    scores: Vec<ViewScore>,
    seen: SeenVoxels,
}

impl ViewPlanner {
    /// Scores all candidates, visited ones included, in their order.
    ///
    /// # Errors
    /// No candidates, a pose that is not finite, a setting outside its range, or a scene too large
    /// for the cells.
    pub fn score(
        &mut self,
        scene: &PlanningScene,
        views: &CandidateViews<'_>,
        config: &Config,
        occupancy: Option<&OccupancyGrid>,
    ) -> Result<&[ViewScore], Error> {
        config.check()?;
        views.check(&scene.middle_in_world)?;
        let candidates = views.world_from_candidates;
        let metric = ViewMetric::around(&scene.middle(), candidates);
        let diameter_m = metric.diameter_m(candidates);
        let sigma_m = config.sigma_share * diameter_m;
        let visited_sigma_m = config.visited_share * diameter_m;
        let n_unknown = occupancy.map_or(0, OccupancyGrid::n_unknown);
        self.scores.clear();
        for candidate in candidates {
            self.view.render(scene, candidate, &config.render)?;
            let entropy = view_entropy(
                self.view.object_areas_m2(),
                self.view.background_area_m2(),
                config.total_area,
                config.log_base,
            );
            let n_seen = occupancy.map_or(0, |grid| self.seen.count_unknown(grid, candidate));
            let gain = n_seen as f64 / n_unknown.max(1) as f64;
            let distance_m = metric.distance_m(candidate, &views.world_from_current);
            let visited = views.world_from_visited.iter();
            let visited_m = visited.map(|pose| metric.distance_m(candidate, pose));
            let visited_m = visited_m.fold(distance_m, f64::min);
            let weight =
                gaussian_weight(distance_m, sigma_m) * novelty_weight(visited_m, visited_sigma_m);
            let is_visited = visited_m <= SAME_VIEW_M;
            let camera = &candidate.translation.vector;
            let state = if is_visited {
                CandidateState::Visited
            } else if scene.is_blocked(camera, config.render.near_m) {
                CandidateState::Blocked
            } else {
                CandidateState::Open
            };
            self.scores.push(ViewScore {
                entropy,
                gain,
                distance_m,
                weight,
                utility: utility(weight, entropy, gain, config),
                state,
            });
        }
        Ok(&self.scores)
    }
}

#[cfg(test)]
mod tests;
